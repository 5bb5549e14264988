// SPDX-License-Identifier: BSD-3-Clause
#include "class_frames.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace headway::eval {
namespace {

/// Class whose confusion with the given one is not an error.
std::optional<ObjectClass> neighbourOf(ObjectClass object_class) {
  if (object_class == ObjectClass::kCar) return ObjectClass::kVan;
  if (object_class == ObjectClass::kPedestrian) return ObjectClass::kPersonSitting;
  return std::nullopt;
}

bool isIgnored(const LabelledBox& truth, ObjectClass object_class, const TrackErrorParams& params) {
  return truth.object_class != object_class || truth.occlusion > params.max_occlusion ||
         truth.truncation > params.max_truncation;
}

bool isIgnoredIfUnmatched(const LabelledBox& estimate, const std::vector<Box2d>& dont_care,
                          const TrackErrorParams& params) {
  if (!estimate.box2d) return false;
  if (estimate.box2d->height() <= params.min_height_px) return true;
  return std::any_of(dont_care.begin(), dont_care.end(), [&](const Box2d& region) {
    return ratioInside(*estimate.box2d, region) > params.dont_care_ratio;
  });
}

double overlapOf(const LabelledBox& a, const LabelledBox& b, BoxMetric metric) {
  if (metric == BoxMetric::k2d) return a.box2d && b.box2d ? overlap2d(*a.box2d, *b.box2d) : 0.0;
  return a.box3d && b.box3d ? overlap3d(*a.box3d, *b.box3d) : 0.0;
}

std::optional<double> groundDistance(const LabelledBox& a, const LabelledBox& b) {
  if (!a.box3d || !b.box3d) return std::nullopt;
  const Eigen::Vector3d offset = a.box3d->centre - b.box3d->centre;
  return std::hypot(offset.x(), offset.z());
}

/// Indexes ids in ascending order, so that indices do not depend on the order of rows.
class TrackIndices {
 public:
  void add(std::int64_t id) { index_.emplace(id, 0); }
  void assign() {
    int next = 0;
    for (auto& [id, index] : index_) index = next++;
  }
  [[nodiscard]] int of(std::int64_t id) const { return index_.at(id); }
  [[nodiscard]] int count() const { return static_cast<int>(index_.size()); }

 private:
  std::map<std::int64_t, int> index_;
};

void addPairs(ClassFrame& frame, const std::vector<const LabelledBox*>& truth,
              const std::vector<const LabelledBox*>& estimates, const TrackErrorParams& params) {
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < estimates.size(); ++j) {
      const double overlap = overlapOf(*truth[i], *estimates[j], params.metric);
      if (overlap > 0.0) frame.overlaps.push_back({i, j, 1.0 - overlap});
      const auto distance = groundDistance(*truth[i], *estimates[j]);
      const bool is_3d = params.metric == BoxMetric::k3d;
      const bool is_correct =
          is_3d ? distance && *distance <= params.max_distance_m : overlap >= params.min_overlap;
      if (!is_correct) continue;
      frame.positions.push_back({i, j, is_3d ? *distance : 1.0 - overlap});
      frame.position_errors_m.push_back(distance);
    }
  }
}

struct IndexedTracks {
  TrackIndices truth;
  TrackIndices estimates;
  std::vector<double> mean_score;  ///< of each estimated track
};

IndexedTracks indexedTracks(const LabelledSequence& sequence, ObjectClass object_class) {
  IndexedTracks result;
  std::map<std::int64_t, std::pair<double, double>> scores;  // id -> sum, count
  for (const auto& frame : sequence.frames) {
    for (const auto& box : frame.truth) result.truth.add(box.id);
    for (const auto& box : frame.estimates) {
      if (box.object_class != object_class) continue;
      result.estimates.add(box.id);
      scores[box.id].first += box.score;
      scores[box.id].second += 1.0;
    }
  }
  result.truth.assign();
  result.estimates.assign();
  for (const auto& [id, score] : scores) result.mean_score.push_back(score.first / score.second);
  return result;
}

void addMatch(FrameMatches& matches, const CandidatePair& pair) {
  matches.estimate_of[pair.row] = static_cast<int>(pair.column);
  matches.truth_of[pair.column] = static_cast<int>(pair.row);
}

}  // namespace

ClassSequence classSequence(const LabelledSequence& sequence, ObjectClass object_class,
                            const TrackErrorParams& params) {
  const auto tracks = indexedTracks(sequence, object_class);
  ClassSequence result;
  result.true_tracks = tracks.truth.count();
  result.estimated_tracks = tracks.estimates.count();
  for (const auto& labelled : sequence.frames) {
    ClassFrame frame;
    std::vector<const LabelledBox*> truth;
    std::vector<const LabelledBox*> estimates;
    for (const auto& box : labelled.truth) {
      if (box.object_class != object_class && box.object_class != neighbourOf(object_class)) {
        continue;
      }
      truth.push_back(&box);
      frame.truth.push_back({tracks.truth.of(box.id), isIgnored(box, object_class, params)});
    }
    for (const auto& box : labelled.estimates) {
      if (box.object_class != object_class) continue;
      const int track = tracks.estimates.of(box.id);
      estimates.push_back(&box);
      frame.estimates.push_back({track, tracks.mean_score[static_cast<std::size_t>(track)],
                                 isIgnoredIfUnmatched(box, labelled.dont_care, params)});
    }
    addPairs(frame, truth, estimates, params);
    result.frames.push_back(std::move(frame));
  }
  return result;
}

FrameMatches FrameMatcher::match(const ClassFrame& frame) {
  FrameMatches matches;
  matches.estimate_of.assign(frame.truth.size(), FrameMatches::kNone);
  for (const auto& estimate : frame.estimates) {
    const bool counts = estimate.score >= score_threshold_;
    matches.truth_of.push_back(counts ? FrameMatches::kNone : FrameMatches::kExcluded);
  }
  std::vector<CandidatePair> candidates;
  for (const auto& pair : frame.overlaps) {
    if (1.0 - pair.cost < min_overlap_) continue;
    if (matches.truth_of[pair.column] == FrameMatches::kExcluded) continue;
    candidates.push_back(pair);
  }
  for (const auto& pair : candidates) {
    const bool is_free = matches.estimate_of[pair.row] == FrameMatches::kNone &&
                         matches.truth_of[pair.column] == FrameMatches::kNone;
    const int previous = previous_[static_cast<std::size_t>(frame.truth[pair.row].track)];
    if (is_free && previous == frame.estimates[pair.column].track) addMatch(matches, pair);
  }
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const CandidatePair& pair) {
                                    return matches.estimate_of[pair.row] != FrameMatches::kNone ||
                                           matches.truth_of[pair.column] != FrameMatches::kNone;
                                  }),
                   candidates.end());
  for (const auto& pair : assignPairs(std::move(candidates))) addMatch(matches, pair);
  std::fill(previous_.begin(), previous_.end(), FrameMatches::kNone);
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const int j = matches.estimate_of[i];
    if (j == FrameMatches::kNone) continue;
    previous_[static_cast<std::size_t>(frame.truth[i].track)] =
        frame.estimates[static_cast<std::size_t>(j)].track;
  }
  return matches;
}

}  // namespace headway::eval
