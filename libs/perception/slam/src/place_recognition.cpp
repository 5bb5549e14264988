// SPDX-License-Identifier: BSD-3-Clause
// Place recognition: keyframes with similar descriptors, and the pose that their landmarks give.
#include "place_recognition.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "rigid_motions.h"

namespace headway::slam {
namespace {

constexpr int kNear = 50;  ///< bits in which two views of one corner differ, at most

}  // namespace

PlaceIndex::PlaceIndex() : heads_(static_cast<std::size_t>(kTables) << kBits, -1) {
  std::mt19937 random(20180731);
  for (auto& table : bits_) {
    for (int& bit : table) bit = static_cast<int>(random() % 256U);
  }
}

std::array<std::size_t, PlaceIndex::kTables> PlaceIndex::wordsOf(
    const Descriptor& descriptor) const {
  std::array<std::size_t, kTables> words{};
  for (std::size_t table = 0; table < kTables; ++table) {
    std::size_t word = table;
    for (const int bit : bits_[table]) {
      const unsigned byte = descriptor[static_cast<std::size_t>(bit / 8)];
      word = (word << 1U) | ((byte >> static_cast<unsigned>(bit % 8)) & 1U);
    }
    words[table] = word;
  }
  return words;
}

void PlaceIndex::add(KeyframeId keyframe, const std::vector<Descriptor>& descriptors) {
  remove(keyframe);
  auto& own = entries_of_[keyframe];
  for (const Descriptor& descriptor : descriptors) {
    if (descriptor == Descriptor{}) continue;
    const std::int32_t entry = entryOf(descriptor);
    entries_[static_cast<std::size_t>(entry)].keyframes.push_back(keyframe);
    own.push_back(entry);
  }
}

std::int32_t PlaceIndex::entryOf(const Descriptor& descriptor) {
  const auto words = wordsOf(descriptor);
  for (std::int32_t index = heads_[words[0]]; index >= 0;) {
    const Entry& entry = entries_[static_cast<std::size_t>(index)];
    if (entry.descriptor == descriptor) return index;
    index = entry.next[0];
  }
  if (free_.empty()) {
    free_.push_back(static_cast<std::int32_t>(entries_.size()));
    entries_.emplace_back();
  }
  const std::int32_t index = free_.back();
  free_.pop_back();
  Entry& entry = entries_[static_cast<std::size_t>(index)];
  entry.descriptor = descriptor;
  for (std::size_t table = 0; table < kTables; ++table) {
    entry.next[table] = std::exchange(heads_[words[table]], index);
  }
  return index;
}

void PlaceIndex::remove(KeyframeId keyframe) {
  const auto known = entries_of_.find(keyframe);
  if (known == entries_of_.end()) return;
  for (const std::int32_t index : known->second) {
    auto& keyframes = entries_[static_cast<std::size_t>(index)].keyframes;
    keyframes.erase(std::find(keyframes.begin(), keyframes.end(), keyframe));
    if (keyframes.empty()) remove(index);
  }
  entries_of_.erase(known);
}

void PlaceIndex::remove(std::int32_t index) {
  const Entry& entry = entries_[static_cast<std::size_t>(index)];
  const auto words = wordsOf(entry.descriptor);
  for (std::size_t table = 0; table < kTables; ++table) {
    std::int32_t* link = &heads_[words[table]];
    while (*link != index) link = &entries_[static_cast<std::size_t>(*link)].next[table];
    *link = entry.next[table];
  }
  free_.push_back(index);
}

std::vector<KeyframeId> PlaceIndex::keyframesWith(const Descriptor& descriptor) const {
  std::vector<KeyframeId> keyframes;
  const auto words = wordsOf(descriptor);
  for (std::size_t table = 0; table < kTables; ++table) {
    for (std::int32_t index = heads_[words[table]]; index >= 0;) {
      const Entry& entry = entries_[static_cast<std::size_t>(index)];
      if (distance(descriptor, entry.descriptor) <= kNear) {
        keyframes.insert(keyframes.end(), entry.keyframes.begin(), entry.keyframes.end());
      }
      index = entry.next[table];
    }
  }
  std::sort(keyframes.begin(), keyframes.end());
  keyframes.erase(std::unique(keyframes.begin(), keyframes.end()), keyframes.end());
  return keyframes;
}

std::vector<PlaceMatch> PlaceIndex::query(const std::vector<Descriptor>& descriptors, int count,
                                          const std::function<bool(KeyframeId)>& wanted) const {
  std::map<KeyframeId, double> scores;
  for (const Descriptor& descriptor : descriptors) {
    if (descriptor == Descriptor{}) continue;
    const auto keyframes = keyframesWith(descriptor);
    const double weight = std::log1p(static_cast<double>(entries_of_.size()) /
                                     static_cast<double>(keyframes.size() + 1));
    for (const KeyframeId keyframe : keyframes) scores[keyframe] += weight;
  }
  std::vector<PlaceMatch> matches;
  for (const auto& [keyframe, score] : scores) {
    if (wanted(keyframe)) matches.push_back({keyframe, score});
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const PlaceMatch& a, const PlaceMatch& b) { return a.score > b.score; });
  if (static_cast<int>(matches.size()) > count) matches.resize(static_cast<std::size_t>(count));
  return matches;
}

Recognition relocalise(const std::vector<DescribedPoint>& points,
                       const std::vector<LandmarkId>& among, const SparseMap& map,
                       const StereoCamera& camera, int min_inliers) {
  constexpr int kFewest = 6;    ///< that are called a consensus at all
  constexpr int kTries = 1000;  ///< seen from elsewhere, few descriptors are matched rightly
  constexpr double kOneCorner_px = 4.0;
  constexpr double kOneCorner_m = 0.1;
  std::vector<Descriptor> known;
  std::vector<const Landmark*> landmarks;
  for (const LandmarkId id : among) {
    const Landmark* landmark = map.find(id);
    if (landmark == nullptr || landmark->descriptor == Descriptor{}) continue;
    known.push_back(landmark->descriptor);
    landmarks.push_back(landmark);
  }
  SameCorner are_one;
  are_one.in_a = [&](int i, int j) {
    return (points[static_cast<std::size_t>(i)].uv - points[static_cast<std::size_t>(j)].uv)
               .norm() < kOneCorner_px;
  };
  are_one.in_b = [&](int i, int j) {
    return (landmarks[static_cast<std::size_t>(i)]->position -
            landmarks[static_cast<std::size_t>(j)]->position)
               .norm() < kOneCorner_m;
  };
  std::vector<stereo::PoseConstraint> constraints;
  for (const auto& [at, landmark] : matchDescriptors(descriptorsOf(points), known, are_one)) {
    stereo::PoseConstraint constraint;
    constraint.point_map = landmarks[static_cast<std::size_t>(landmark)]->position;
    constraint.measurement.uv = points[static_cast<std::size_t>(at)].uv;
    constraint.measurement.sigma_px = 2.0;
    constraints.push_back(constraint);
  }
  Recognition recognition;
  const auto initial = poseByConsensus(constraints, camera, kFewest, 3.0, kTries);
  if (!initial) return recognition;
  recognition.inliers = initial->inliers;
  if (initial->inliers < min_inliers) return recognition;
  const auto refined = stereo::refinePose(initial->T_map_cam, constraints, camera, {2.0, 2, 6});
  recognition.inliers = refined ? refined->inliers : 0;
  if (refined && refined->inliers >= min_inliers) recognition.T_map_cam = refined->T_map_cam;
  return recognition;
}

}  // namespace headway::slam
