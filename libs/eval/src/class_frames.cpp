#include "class_frames.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace headway::eval {
namespace {

/// Class that is too like another to be called wrong.
std::optional<ObjectClass> neighbourOf(ObjectClass object_class) {
  if (object_class == ObjectClass::kCar) return ObjectClass::kVan;
  if (object_class == ObjectClass::kPedestrian) return ObjectClass::kPersonSitting;
  return std::nullopt;
}

bool isIgnored(const LabelledBox& truth, ObjectClass object_class, const TrackErrorParams& params) {
  return truth.object_class != object_class || truth.occlusion > params.max_occlusion ||
         truth.truncation > params.max_truncation;
}

bool isHarmless(const LabelledBox& estimate, const std::vector<Box2d>& dont_care,
                const TrackErrorParams& params) {
  if (!estimate.box2d) return false;
  if (estimate.box2d->height() <= params.min_height_px) return true;
  return std::any_of(dont_care.begin(), dont_care.end(), [&](const Box2d& region) {
    return shareInside(*estimate.box2d, region) > params.dont_care_share;
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

/// Numbers ids in ascending order, so that numbers do not depend on the order of rows.
class TrackNumbers {
 public:
  void add(std::int64_t id) { number_.emplace(id, 0); }
  void close() {
    int next = 0;
    for (auto& [id, number] : number_) number = next++;
  }
  [[nodiscard]] int of(std::int64_t id) const { return number_.at(id); }
  [[nodiscard]] int count() const { return static_cast<int>(number_.size()); }

 private:
  std::map<std::int64_t, int> number_;
};

void addPairs(ClassFrame& frame, const std::vector<const LabelledBox*>& truth,
              const std::vector<const LabelledBox*>& estimates, const TrackErrorParams& params) {
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < estimates.size(); ++j) {
      const double overlap = overlapOf(*truth[i], *estimates[j], params.metric);
      if (overlap > 0.0) frame.overlaps.push_back({i, j, 1.0 - overlap});
      const auto distance = groundDistance(*truth[i], *estimates[j]);
      const bool is_3d = params.metric == BoxMetric::k3d;
      const bool is_right =
          is_3d ? distance && *distance <= params.max_distance_m : overlap >= params.min_overlap;
      if (!is_right) continue;
      frame.positions.push_back({i, j, is_3d ? *distance : 1.0 - overlap});
      frame.position_errors_m.push_back(distance);
    }
  }
}

struct Numbering {
  TrackNumbers truth;
  TrackNumbers estimates;
  std::vector<double> mean_score;  ///< of each estimated track
};

Numbering numberedTracks(const LabelledSequence& sequence, ObjectClass object_class) {
  Numbering result;
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
  result.truth.close();
  result.estimates.close();
  for (const auto& [id, score] : scores) result.mean_score.push_back(score.first / score.second);
  return result;
}

}  // namespace

ClassSequence classSequence(const LabelledSequence& sequence, ObjectClass object_class,
                            const TrackErrorParams& params) {
  const auto tracks = numberedTracks(sequence, object_class);
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
                                 isHarmless(box, labelled.dont_care, params)});
    }
    addPairs(frame, truth, estimates, params);
    result.frames.push_back(std::move(frame));
  }
  return result;
}

}  // namespace headway::eval
