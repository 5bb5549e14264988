// SPDX-License-Identifier: BSD-3-Clause
// Measuring landmarks: a frame prepared for tracking, and where the map's landmarks are in it.
#include "landmark_tracker.h"

#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/stereo/patch.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <string>

namespace headway::slam {
namespace {

/// The pixels of a box that lie in the image; none for a box that is not finite.
cv::Rect pixelsOf(const Box2d& box, const cv::Size& image_size) {
  if (!std::isfinite(box.left + box.right + box.top + box.bottom)) return {};
  const auto column = [&](double u) { return std::clamp(u, -1.0, image_size.width + 0.0); };
  const auto row = [&](double v) { return std::clamp(v, -1.0, image_size.height + 0.0); };
  const cv::Point first(static_cast<int>(std::floor(column(box.left))),
                        static_cast<int>(std::floor(row(box.top))));
  const cv::Point last(static_cast<int>(std::ceil(column(box.right))),
                       static_cast<int>(std::ceil(row(box.bottom))));
  if (last.x < first.x || last.y < first.y) return {};
  return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect({0, 0}, image_size);
}

void draw(const std::vector<MovingBox>& boxes, cv::Mat& mask) {
  for (const Box2d& box : boxes) mask(pixelsOf(box, mask.size())).setTo(255);
}

}  // namespace

cv::Mat excludedMask(const MovingRegions& moving, DynamicRejection mode,
                     const cv::Size& image_size) {
  const bool wanted = mode == DynamicRejection::kBoxes || mode == DynamicRejection::kBoth;
  const bool unsure = mode == DynamicRejection::kBoxes && !moving.unsure.empty();
  if (!wanted || (moving.boxes.empty() && moving.mask.empty() && !unsure)) return {};
  if (!moving.mask.empty() && (moving.mask.type() != CV_8UC1 || moving.mask.size() != image_size)) {
    throw InputError("moving regions: the mask is " + std::to_string(moving.mask.cols) + "x" +
                     std::to_string(moving.mask.rows) + ", must be 8-bit and " +
                     std::to_string(image_size.width) + "x" + std::to_string(image_size.height) +
                     " as the image");
  }
  cv::Mat mask =
      moving.mask.empty() ? cv::Mat(image_size, CV_8UC1, cv::Scalar(0)) : moving.mask.clone();
  draw(moving.boxes, mask);
  if (unsure) draw(moving.unsure, mask);
  return mask;
}

cv::Mat suspectMask(const MovingRegions& moving, DynamicRejection mode,
                    const cv::Size& image_size) {
  if (mode != DynamicRejection::kBoth || moving.unsure.empty()) return {};
  cv::Mat mask(image_size, CV_8UC1, cv::Scalar(0));
  draw(moving.unsure, mask);
  return mask;
}

namespace {

/// Cells so small that those outside of the excluded regions are about `features`, in steps of two,
/// so that they stay the same from frame to frame; not smaller than a patch, because neighbouring
/// landmarks would measure the same pixels.
FeatureGrid gridOutside(const cv::Mat& excluded, const StereoCamera& camera, int features) {
  const double area = static_cast<double>(camera.width) * camera.height;
  const double usable = excluded.empty() ? area : area - cv::countNonZero(excluded);
  const double factor = std::exp2(std::round(std::log2(area / std::max(usable, 1.0))));
  const double most = std::max<double>(features, area / square(stereo::kPatchSize));
  return {camera.width, camera.height, static_cast<int>(std::min(factor * features, most))};
}

}  // namespace

TrackingFrame makeTrackingFrame(const stereo::FrameContext& context, const MovingRegions& moving,
                                const StereoCamera& camera, const SlamParams& params) {
  const StereoFrame& frame = context.frame();
  stereo::requireImages(frame, camera);
  TrackingFrame current;
  current.index = frame.index;
  current.time = frame.time;
  current.left = context.left();
  current.right = context.right();
  current.excluded = excludedMask(moving, params.dynamic_rejection, frame.left.size());
  current.suspect = suspectMask(moving, params.dynamic_rejection, frame.left.size());
  current.grid = gridOutside(current.excluded, camera, params.features);
  return current;
}

namespace {

constexpr int kTrackedLevel = 1;  ///< pyramid level whose noise tracked points have

/// The turn and stretch from one pixel of the view to pixels of the reference, both at level 0,
/// for a small plane that faces the reference camera.
Eigen::Matrix2d referenceFromView(const Eigen::Vector3d& point_ref, const Pose& T_view_ref,
                                  const StereoCamera& camera) {
  const Eigen::Vector3d p = T_view_ref * point_ref;
  const Eigen::Matrix<double, 2, 3> projection = stereo::projectionJacobian(p, camera).topRows<2>();
  Eigen::Matrix<double, 3, 2> plane = T_view_ref.linear().leftCols<2>() * point_ref.z();
  plane.col(0) /= camera.fx;
  plane.col(1) /= camera.fy;
  const Eigen::Matrix2d view_from_reference = projection * plane;
  return view_from_reference.inverse();
}

}  // namespace

bool isExcluded(const cv::Mat& excluded, const Eigen::Vector2d& uv) {
  if (excluded.empty()) return false;
  const int u = std::clamp(static_cast<int>(std::lround(uv.x())), 0, excluded.cols - 1);
  const int v = std::clamp(static_cast<int>(std::lround(uv.y())), 0, excluded.rows - 1);
  return excluded.at<std::uint8_t>(v, u) != 0;
}

std::optional<Eigen::Vector3d> visibleAt(const Eigen::Vector3d& point_cam,
                                         const TrackingFrame& frame, const StereoCamera& camera) {
  const auto uvd = project(point_cam, camera);
  const bool is_visible = uvd && uvd->x() >= 0.0 && uvd->y() >= 0.0 && uvd->x() < camera.width &&
                          uvd->y() < camera.height && !isExcluded(frame.excluded, uvd->head<2>());
  return is_visible ? uvd : std::nullopt;
}

/// The motion model predicts most positions well; starting at a coarse level could then lead to a
/// similar structure nearby, so that is left to points that are not found.
std::vector<stereo::TrackedPosition> followPoints(const stereo::ImagePyramid& from,
                                                  const TrackingFrame& frame,
                                                  const std::vector<Eigen::Vector2d>& points,
                                                  const std::vector<Eigen::Vector2d>& predicted) {
  stereo::PointTrackingOptions options{15, kTrackedLevel, 25.0, 0.0, 0.6};
  auto found = stereo::trackPoints(from, frame.left, points, predicted, options);
  options.coarsest_level = 3;
  stereo::trackMissing(from, frame.left, points, predicted, options, found);
  for (stereo::TrackedPosition& position : found) {
    if (position && isExcluded(frame.excluded, *position)) position.reset();
  }
  return found;
}

std::optional<double> medianDisparity(const std::vector<TrackedLandmark>& seen) {
  std::vector<double> disparities;
  for (const TrackedLandmark& landmark : seen) {
    if (landmark.measurement.stereo) disparities.push_back(landmark.measurement.disparity);
  }
  if (disparities.empty()) return std::nullopt;
  return median(disparities);
}

struct LandmarkTracker::Candidate {
  int cell = 0;
  const Landmark* landmark = nullptr;
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();  ///< where it should be
};

std::vector<TrackedLandmark> LandmarkTracker::follow(const TrackingFrame& previous,
                                                     const std::vector<TrackedLandmark>& tracked,
                                                     const TrackingFrame& current,
                                                     const Pose& T_map_cam,
                                                     const SparseMap& map) const {
  const Pose T_cam_map = T_map_cam.inverse(Eigen::Isometry);
  std::vector<LandmarkId> ids;
  std::vector<Eigen::Vector2d> before;
  std::vector<Eigen::Vector2d> predicted;
  for (const TrackedLandmark& seen : tracked) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr) continue;
    const auto uvd = project(T_cam_map * landmark->position, camera_);
    if (!uvd) continue;
    ids.push_back(landmark->id);
    before.push_back(seen.measurement.uv);
    predicted.emplace_back(uvd->head<2>());
  }
  const auto positions = followPoints(previous.left, current, before, predicted);
  std::vector<TrackedLandmark> followed;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!positions[i]) continue;
    TrackedLandmark result;
    result.id = ids[i];
    result.level = kTrackedLevel;
    result.measurement.uv = *positions[i];
    result.measurement.sigma_px = params_.sigma_px * (1 << kTrackedLevel);
    followed.push_back(result);
  }
  return followed;
}

/// Landmarks in view, by cell; those seen by most keyframes first in each.
std::vector<LandmarkTracker::Candidate> LandmarkTracker::candidatesByCell(
    const TrackingFrame& current, const Pose& T_map_cam, const std::vector<LandmarkId>& candidates,
    const SparseMap& map) const {
  const Pose T_cam_map = T_map_cam.inverse(Eigen::Isometry);
  std::vector<Candidate> in_view;
  in_view.reserve(candidates.size());
  for (const LandmarkId id : candidates) {
    const Landmark* landmark = map.find(id);
    if (landmark == nullptr) continue;
    const auto uvd = visibleAt(T_cam_map * landmark->position, current, camera_);
    if (uvd) in_view.push_back({current.grid.cellOf(uvd->head<2>()), landmark, *uvd});
  }
  std::sort(in_view.begin(), in_view.end(), [](const Candidate& a, const Candidate& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    const auto count = [](const Candidate& c) { return c.landmark->observations.size(); };
    if (count(a) != count(b)) return count(a) > count(b);
    return a.landmark->id < b.landmark->id;
  });
  return in_view;
}

/// A landmark's patch as it looks from a pose, at the level where it is about as large as when cut.
struct LandmarkTracker::SeenPatch {
  stereo::Patch patch;
  int level = 0;
  double scale = 1.0;  ///< pixels of the reference patch in one pixel of the level
};

std::optional<LandmarkTracker::SeenPatch> LandmarkTracker::patchSeenFrom(
    const Pose& T_map_cam, const Landmark& landmark, int levels, const SparseMap& map) const {
  const Pose T_map_ref =
      map.keyframe(landmark.reference).T_map_cam * landmark.T_reference_cut.cast<double>();
  const Eigen::Vector3d point_ref = T_map_ref.inverse(Eigen::Isometry) * landmark.position;
  if (point_ref.z() <= 0.0) return std::nullopt;
  const Eigen::Matrix2d warp =
      referenceFromView(point_ref, T_map_cam.inverse(Eigen::Isometry) * T_map_ref, camera_);
  const double stretch = std::sqrt(std::abs(warp.determinant()));
  if (!std::isfinite(stretch) || stretch <= 0.0) return std::nullopt;
  const int level = std::clamp(
      static_cast<int>(std::lround(landmark.reference_level - std::log2(stretch))), 0, levels - 1);
  const double to_reference = static_cast<double>(1 << level) / (1 << landmark.reference_level);
  const auto patch = stereo::warpPatch(*landmark.patch, warp * to_reference);
  if (!patch) return std::nullopt;
  return SeenPatch{*patch, level, stretch * to_reference};
}

/// Where a patch is in a frame, in pixels of its level, no farther off than that.
std::optional<Eigen::Vector2d> LandmarkTracker::findNear(const Eigen::Vector3d& uvd,
                                                         double max_shift_px, const SeenPatch& seen,
                                                         const TrackingFrame& current) const {
  const Eigen::Vector2d expected = uvd.head<2>() / (1 << seen.level);
  const auto found = stereo::align(seen.patch, current.left.levels[seen.level], expected,
                                   stereo::AlignmentAxes::kBoth);
  if (!found || !found->converged || found->zncc < params_.min_zncc ||
      (found->uv - expected).norm() > max_shift_px) {
    return std::nullopt;
  }
  return found->uv;
}

std::optional<TrackedLandmark> LandmarkTracker::measureOne(const TrackingFrame& current,
                                                           const Pose& T_map_cam,
                                                           const Candidate& candidate,
                                                           const SparseMap& map) const {
  constexpr double kMaxShift = 8.0;  ///< from where it should be, at the level searched [px]
  const auto seen = patchSeenFrom(T_map_cam, *candidate.landmark, current.left.count(), map);
  if (!seen) return std::nullopt;
  const auto found = findNear(candidate.uvd, kMaxShift, *seen, current);
  if (!found) return std::nullopt;
  TrackedLandmark result;
  result.id = candidate.landmark->id;
  result.level = seen->level;
  result.patch_scale = seen->scale;
  result.measurement =
      stereoMeasurement(current, (1 << seen->level) * *found, candidate.uvd.z(), seen->level);
  return result;
}

std::optional<bool> LandmarkTracker::isFoundAt(const Eigen::Vector3d& uvd, const Landmark& landmark,
                                               const TrackingFrame& current, const Pose& T_map_cam,
                                               const SparseMap& map) const {
  const auto seen = patchSeenFrom(T_map_cam, landmark, current.left.count(), map);
  if (!seen) return std::nullopt;
  return findNear(uvd, 2.0, *seen, current).has_value();
}

/// The measurement of a landmark found in the left image, with its disparity where it matches.
stereo::StereoMeasurement LandmarkTracker::stereoMeasurement(const TrackingFrame& current,
                                                             const Eigen::Vector2d& uv,
                                                             double expected_disparity,
                                                             int level) const {
  const double scale = 1 << level;
  const auto disparity =
      matcher_.refine(current.left, current.right, uv, expected_disparity, level);
  const double disparity_scale = current.right.isDepth() ? 1.0 : scale;
  return {uv, disparity.value_or(0.0), disparity.has_value(), params_.sigma_px * scale,
          params_.sigma_disparity_px * disparity_scale};
}

std::vector<TrackedLandmark> LandmarkTracker::measure(const TrackingFrame& current,
                                                      const Pose& T_map_cam,
                                                      const std::vector<LandmarkId>& candidates,
                                                      SparseMap& map) const {
  constexpr int kTriesPerCell = 5;
  constexpr int kFoundPerCell = 2;
  std::vector<TrackedLandmark> measured;
  int cell = -1;
  int tries = 0;
  int found_here = 0;
  for (const Candidate& candidate : candidatesByCell(current, T_map_cam, candidates, map)) {
    if (candidate.cell != cell) tries = found_here = 0;
    cell = candidate.cell;
    if (++tries > kTriesPerCell || found_here == kFoundPerCell) continue;
    Landmark& landmark = *map.findToChange(candidate.landmark->id);
    ++landmark.tried;
    const auto found = measureOne(current, T_map_cam, candidate, map);
    if (!found || isExcluded(current.excluded, found->measurement.uv)) continue;
    ++landmark.found;
    ++found_here;
    measured.push_back(*found);
  }
  return measured;
}

}  // namespace headway::slam
