// SPDX-License-Identifier: BSD-3-Clause
#include "map_links.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "descriptor.h"
#include "place_index.h"
#include "relocaliser.h"

namespace headway::slam {
namespace {

constexpr int kCandidates = 3;        ///< places of other maps that are compared with a keyframe
constexpr int kMaxDistance = 64;      ///< of the descriptors of one landmark [bits of 256]
constexpr double kMinSigma = 2.0;     ///< of a measurement against a pose by descriptors alone [px]
constexpr double kPointGate = 11.34;  ///< chi-square, 3 degrees of freedom, 99 %

/// Landmarks that a keyframe sees, as it sees them.
struct SeenLandmarks {
  std::vector<const Landmark*> landmarks;
  std::vector<DescribedPoint> points;
  std::vector<stereo::StereoMeasurement> measurements;
};

SeenLandmarks seenIn(const Keyframe& keyframe, const SparseMap& map) {
  SeenLandmarks seen;
  for (const LandmarkId id : keyframe.landmarks) {
    const Landmark* landmark = map.find(id);
    if (landmark->descriptor == Descriptor{}) continue;
    for (const auto& [observer, measurement] : landmark->observations) {
      if (observer != keyframe.id) continue;
      seen.landmarks.push_back(landmark);
      seen.points.push_back({measurement.uv, landmark->descriptor});
      seen.measurements.push_back(map.corrected(measurement));
    }
  }
  return seen;
}

std::vector<Descriptor> descriptorsOf(const SeenLandmarks& seen) {
  std::vector<Descriptor> descriptors;
  for (const DescribedPoint& point : seen.points) descriptors.push_back(point.descriptor);
  return descriptors;
}

/// Pairs of landmarks (of another map, index of the seen one) that are measured at one place from a
/// pose, most similar ones first; each landmark occurs once.
std::vector<std::pair<const Landmark*, std::size_t>> sameLandmarks(
    const Pose& T_map_cam, const std::vector<LandmarkId>& among, const SeenLandmarks& seen,
    const SparseMap& map, const StereoCamera& camera) {
  using Candidate = std::tuple<int, const Landmark*, std::size_t>;
  const Pose T_cam_map = T_map_cam.inverse(Eigen::Isometry);
  std::vector<Candidate> candidates;
  for (const LandmarkId id : among) {
    const Landmark* landmark = map.find(id);
    const Eigen::Vector3d point = T_cam_map * landmark->position;
    if (landmark->descriptor == Descriptor{} || point.z() <= 0.0) continue;
    for (std::size_t i = 0; i < seen.points.size(); ++i) {
      auto measurement = seen.measurements[i];
      measurement.sigma_px = std::max(measurement.sigma_px, kMinSigma);
      measurement.sigma_disparity_px = std::max(measurement.sigma_disparity_px, kMinSigma);
      const auto residual = stereo::stereoResidual(point, measurement, camera, nullptr);
      if (residual.squaredNorm() > kPointGate) continue;
      const int bits = distance(landmark->descriptor, seen.points[i].descriptor);
      if (bits <= kMaxDistance) candidates.emplace_back(bits, landmark, i);
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    const auto key = [](const Candidate& of) {
      return std::tuple(std::get<0>(of), std::get<1>(of)->id, std::get<2>(of));
    };
    return key(a) < key(b);
  });
  std::set<LandmarkId> used;
  std::vector<bool> taken(seen.points.size(), false);
  std::vector<std::pair<const Landmark*, std::size_t>> pairs;
  for (const auto& [bits, landmark, i] : candidates) {
    if (taken[i] || !used.insert(landmark->id).second) continue;
    taken[i] = true;
    pairs.emplace_back(landmark, i);
  }
  return pairs;
}

/// The keyframe in the surroundings of a place, if enough of their landmarks are the same.
std::optional<MapLink> linkTo(KeyframeId place, const Keyframe& keyframe, const SeenLandmarks& seen,
                              const SparseMap& map, const StereoCamera& camera,
                              const SlamParams& params) {
  const auto among = map.seenBy(map.neighbourhood(place, params.window));
  const auto initial =
      relocalise(seen.points, among, map, camera, params.min_inliers / 2).T_map_cam;
  if (!initial) return std::nullopt;
  const auto pairs = sameLandmarks(*initial, among, seen, map, camera);
  std::vector<stereo::PoseConstraint> constraints;
  for (const auto& [landmark, i] : pairs) {
    constraints.push_back({landmark->position, seen.measurements[i], true, true});
  }
  const auto refined = stereo::refinePose(*initial, constraints, camera, {4.0, 3, 6});
  if (!refined || refined->inliers < params.min_inliers) return std::nullopt;
  MapLink link{keyframe.id,
               place,
               map.keyframe(place).T_map_cam.inverse(Eigen::Isometry) * refined->T_map_cam,
               {}};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!constraints[k].inlier || !constraints[k].stereo_inlier) continue;
    link.landmarks.emplace_back(pairs[k].first->id, seen.landmarks[pairs[k].second]->id);
  }
  return link;
}

/// Whether two links of the same maps agree, as far as drift between them allows.
bool agree(const MapLink& a, const MapLink& b, const SparseMap& map) {
  constexpr double kFloorM = 0.5;
  constexpr double kLinkDrift = 0.05;  ///< of the distance [-]
  constexpr double kMaxTurn = 0.05;    ///< [rad]
  const auto between = [&map](KeyframeId from, KeyframeId to) {
    return Pose(map.keyframe(from).T_map_cam.inverse(Eigen::Isometry) * map.keyframe(to).T_map_cam);
  };
  const Pose T_keyframes = between(a.keyframe, b.keyframe);
  const Pose T_places = between(a.place, b.place);
  const Pose by_b = T_places * b.T_place_keyframe * T_keyframes.inverse(Eigen::Isometry);
  const Pose difference = a.T_place_keyframe.inverse(Eigen::Isometry) * by_b;
  const double apart = T_keyframes.translation().norm() + T_places.translation().norm();
  return difference.translation().norm() < kFloorM + kLinkDrift * apart &&
         logSo3(difference.linear()).norm() < kMaxTurn * (1.0 + 0.1 * apart);
}

}  // namespace

std::size_t SeparateMaps::mapOf(KeyframeId keyframe) const {
  const auto next = std::upper_bound(first.begin(), first.end(), keyframe);
  return static_cast<std::size_t>(next - first.begin()) - 1;
}

std::vector<MapLink> findMapLinks(const SeparateMaps& maps, const StereoCamera& camera,
                                  const SlamParams& params) {
  PlaceIndex index;
  for (const auto& [id, keyframe] : maps.all.keyframes()) {
    if (keyframe.submap != 0) continue;  // its place in its own map is not known
    index.add(id, descriptorsOf(seenIn(keyframe, maps.all)));
  }
  std::vector<MapLink> links;
  for (const auto& [id, keyframe] : maps.all.keyframes()) {
    const std::size_t own = maps.mapOf(id);
    if (own == 0 || keyframe.submap != 0) continue;
    const SeenLandmarks seen = seenIn(keyframe, maps.all);
    const auto is_other = [&](KeyframeId other) { return maps.mapOf(other) < own; };
    for (const auto& match : index.query(descriptorsOf(seen), kCandidates, is_other)) {
      auto link = linkTo(match.keyframe, keyframe, seen, maps.all, camera, params);
      if (link) links.push_back(std::move(*link));
    }
  }
  return consistentLinks(std::move(links), maps);
}

std::vector<MapLink> consistentLinks(std::vector<MapLink> links, const SeparateMaps& maps) {
  constexpr std::size_t kMinConfirmations = 2;
  const auto sameMaps = [&](const MapLink& a, const MapLink& b) {
    return maps.mapOf(a.keyframe) == maps.mapOf(b.keyframe) &&
           maps.mapOf(a.place) == maps.mapOf(b.place);
  };
  std::vector<std::pair<std::size_t, std::size_t>> confirmed;  // confirmations, index
  for (std::size_t i = 0; i < links.size(); ++i) {
    std::set<KeyframeId> by;
    for (const MapLink& other : links) {
      if (other.keyframe == links[i].keyframe || !sameMaps(links[i], other)) continue;
      if (agree(links[i], other, maps.all)) by.insert(other.keyframe);
    }
    if (by.size() >= kMinConfirmations) confirmed.emplace_back(by.size(), i);
  }
  std::stable_sort(confirmed.begin(), confirmed.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::size_t> kept;
  for (const auto& confirmation : confirmed) {
    const std::size_t i = confirmation.second;
    const bool contradicts = std::any_of(kept.begin(), kept.end(), [&](std::size_t k) {
      return sameMaps(links[i], links[k]) && !agree(links[i], links[k], maps.all);
    });
    if (!contradicts) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<MapLink> consistent;
  for (const std::size_t i : kept) consistent.push_back(std::move(links[i]));
  return consistent;
}

}  // namespace headway::slam
