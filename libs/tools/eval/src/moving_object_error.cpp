// SPDX-License-Identifier: BSD-3-Clause
// Which moving objects are found, and how well their motion is known.
#include <headway/core/assignment.h>
#include <headway/core/box_overlap.h>
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/moving_object_error.h>

#include <algorithm>
#include <cmath>

#include "evaluation_inputs.h"

namespace headway::eval {
namespace {

/// Length over the ground of a vector in the camera's frame [m].
double groundRange(const Eigen::Vector3d& vector) { return std::hypot(vector.x(), vector.z()); }

/// Largest distance between a row and the label at this range that it is matched to [m].
double matchingDistance(const MovingObjectParams& params, double range_m) {
  return std::max(params.max_distance_m, params.max_distance_ratio * range_m);
}

/// A labelled object in one frame.
struct SpeedLabel {
  const LabelledBox* box = nullptr;
  std::optional<double> speed_mps;  ///< nullopt: labelled too briefly
  double range_m = 0.0;
};

/// A moving row and the labels near it.
struct RowEvaluation {
  const TrackRow* row = nullptr;
  bool right = false;
  bool right_as_class = false;
  std::string ignored;  ///< reason; empty: counted
};

bool sameClass(ObjectClass a, ObjectClass b) {
  const auto merged = [](ObjectClass c) { return c == ObjectClass::kVan ? ObjectClass::kCar : c; };
  return merged(a) == merged(b);
}

std::string rangeName(double range) {
  if (range < 10.0) return "00-10";
  if (range < 20.0) return "10-20";
  return range < 40.0 ? "20-40" : "40-";
}

/// Mean speed around a point of a path; nullopt if too little of it is labelled.
std::optional<double> speedAt(const TrueObject& object, Time time,
                              const MovingObjectParams& params) {
  const TrajectoryPoint* first = nullptr;
  const TrajectoryPoint* last = nullptr;
  for (const auto& point : object.path) {
    if (std::abs(point.time - time) > params.half_window_s + kTimeTolerance_s) continue;
    if (first == nullptr) first = &point;
    last = &point;
  }
  if (first == nullptr || last->time - first->time < params.min_window_s - kTimeTolerance_s)
    return {};
  return (last->position - first->position).head<2>().norm() / (last->time - first->time);
}

class MovingObjectEvaluation {
 public:
  MovingObjectEvaluation(const MovingObjectInput& input, const MovingObjectParams& params)
      : input_(input), params_(params) {
    auto labels = input.labels;
    labels.resize(std::min(labels.size(), std::max(input.end_frame, input.T_world_cam.size())));
    for (auto& object : trueObjects(labels, input.T_world_cam)) {
      objects_.emplace(object.id, std::move(object));
    }
    for (const auto& row : input.rows) {
      const bool counts = row.moving && (params.with_coasting || !row.coasting);
      if (counts) rows_[row.frame].push_back(&row);
    }
  }

  MovingObjectError evaluate() {
    for (std::size_t k = input_.first_frame; k < input_.end_frame; ++k) evaluateFrame(k);
    for (const auto& [id, track] : tracks_) {
      result_.tracks.push_back(track);
      if (track.isFalse()) ++result_.false_tracks;
    }
    return std::move(result_);
  }

 private:
  bool isNear(const TrackRow& row, const SpeedLabel& label) const {
    return groundRange(row.centre - label.box->box3d->centre) <=
           matchingDistance(params_, label.range_m);
  }

  std::vector<SpeedLabel> labelsOf(std::size_t frame) const {
    std::vector<SpeedLabel> labels;
    if (frame >= input_.labels.size()) return labels;
    for (const auto& box : input_.labels[frame].truth) {
      if (!box.box3d) continue;
      const Time time = input_.T_world_cam[frame].time;
      labels.push_back(
          {&box, speedAt(objects_.at(box.id), time, params_), groundRange(box.box3d->centre)});
    }
    return labels;
  }

  void evaluateFrame(std::size_t frame) {
    ++result_.frames;
    const auto labels = labelsOf(frame);
    std::vector<RowEvaluation> rows;
    for (const auto* row : rows_[frame]) rows.push_back(evaluated(*row, labels));
    for (const auto& label : labels) {
      if (label.speed_mps && *label.speed_mps > params_.moving_mps) countLabel(label, rows);
    }
    for (const auto& row : rows) countRow(row);
    match(frame, labels, rows);
  }

  RowEvaluation evaluated(const TrackRow& row, const std::vector<SpeedLabel>& labels) const {
    RowEvaluation result{&row, false, false, ""};
    bool speed_unknown = false;
    for (const auto& label : labels) {
      if (!isNear(row, label)) continue;
      if (!label.speed_mps) speed_unknown = true;
      if (!label.speed_mps || *label.speed_mps <= params_.right_mps) continue;
      result.right = true;
      if (sameClass(row.object_class, label.box->object_class)) result.right_as_class = true;
    }
    if (result.right) return result;
    if (isOutsideImage(row)) result.ignored = "outside_image";
    if (isInDontCare(row)) result.ignored = "dont_care";
    if (speed_unknown) result.ignored = "unknown_speed";
    return result;
  }

  bool isOutsideImage(const TrackRow& row) const {
    if (!row.box2d) return true;
    const double u = 0.5 * (row.box2d->left + row.box2d->right);
    const double v = 0.5 * (row.box2d->top + row.box2d->bottom);
    return u < 0.0 || v < 0.0 || u > input_.image_width - 1 || v > input_.image_height - 1;
  }

  bool isInDontCare(const TrackRow& row) const {
    if (row.frame >= input_.labels.size() || !row.box2d) return false;
    const auto& regions = input_.labels[row.frame].dont_care;
    return std::any_of(regions.begin(), regions.end(), [&](const Box2d& region) {
      return ratioInside(*row.box2d, region) > params_.dont_care_ratio;
    });
  }

  void countLabel(const SpeedLabel& label, const std::vector<RowEvaluation>& rows) {
    bool found = false;
    bool found_as_class = false;
    for (const auto& row : rows) {
      if (!isNear(*row.row, label)) continue;
      found = true;
      if (sameClass(row.row->object_class, label.box->object_class)) found_as_class = true;
    }
    const auto add = [&](MovingCounts& counts) {
      ++counts.labels;
      if (found) ++counts.found;
      if (found_as_class) ++counts.found_as_class;
    };
    add(result_.all);
    if (label.range_m <= 40.0) add(result_.within_40m);
    add(result_.classes[std::string(toString(label.box->object_class))]);
    add(result_.ranges[rangeName(label.range_m)]);
    add(result_.occlusion[std::to_string(label.box->occlusion)]);
  }

  void countRow(const RowEvaluation& row) {
    auto& track = tracks_[row.row->id];
    if (track.id < 0) track.first_frame = row.row->frame;
    track.id = row.row->id;
    track.object_class = row.row->object_class;
    track.last_frame = row.row->frame;
    if (!row.ignored.empty()) {
      ++result_.ignored[row.ignored];
      return;
    }
    ++track.rows;
    if (!row.right) ++track.wrong;
    const auto add = [&](MovingCounts& counts) {
      ++counts.rows;
      if (row.right) ++counts.right;
      if (row.right_as_class) ++counts.right_as_class;
    };
    const double range = groundRange(row.row->centre);
    add(result_.all);
    if (range <= 40.0) add(result_.within_40m);
    add(result_.classes[std::string(toString(row.row->object_class))]);
    add(result_.ranges[rangeName(range)]);
  }

  /// Pairs moving labels with rows one to one, at minimum distance.
  void match(std::size_t frame, const std::vector<SpeedLabel>& labels,
             const std::vector<RowEvaluation>& rows) {
    std::vector<CandidatePair> candidates;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (!labels[i].speed_mps || *labels[i].speed_mps <= params_.right_mps) continue;
      for (std::size_t j = 0; j < rows.size(); ++j) {
        if (!isNear(*rows[j].row, labels[i])) continue;
        candidates.push_back(
            {i, j, groundRange(rows[j].row->centre - labels[i].box->box3d->centre)});
      }
    }
    const auto pairs = assignPairs(std::move(candidates));
    const auto right = static_cast<std::size_t>(
        std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.right; }));
    result_.duplicate_rows += right - pairs.size();
    for (const auto& pair : pairs) {
      if (*labels[pair.row].speed_mps <= params_.moving_mps) continue;
      result_.matches.push_back({frame, labels[pair.row].box->id, rows[pair.column].row->id});
    }
  }

  const MovingObjectInput& input_;
  const MovingObjectParams& params_;
  std::map<std::int64_t, TrueObject> objects_;
  std::map<std::size_t, std::vector<const TrackRow*>> rows_;
  std::map<std::int64_t, MovingTrack> tracks_;
  MovingObjectError result_;
};

}  // namespace

std::optional<double> MovingCounts::recall() const { return ratioOf(found, labels); }
std::optional<double> MovingCounts::recallAsClass() const {
  return ratioOf(found_as_class, labels);
}
std::optional<double> MovingCounts::precision() const { return ratioOf(right, rows); }
std::optional<double> MovingCounts::precisionAsClass() const {
  return ratioOf(right_as_class, rows);
}

std::optional<double> MovingObjectError::falseTracksPer100Frames() const {
  if (frames == 0) return std::nullopt;
  return 100.0 * static_cast<double>(false_tracks) / static_cast<double>(frames);
}

MovingObjectError movingObjectError(const MovingObjectInput& input,
                                    const MovingObjectParams& params) {
  return MovingObjectEvaluation(input, params).evaluate();
}

namespace {

/// Pairs the labels of one frame with its rows.
std::vector<CandidatePair> pairsOf(const std::vector<LabelledBox>& labels,
                                   const std::vector<const TrackRow*>& rows,
                                   const MovingObjectParams& params) {
  std::vector<CandidatePair> candidates;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!labels[i].box3d) continue;
    const Eigen::Vector3d& centre = labels[i].box3d->centre;
    const double gate = matchingDistance(params, groundRange(centre));
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const double distance = groundRange(rows[j]->centre - centre);
      if (distance <= gate) candidates.push_back({i, j, distance});
    }
  }
  return assignPairs(std::move(candidates));
}

}  // namespace

std::optional<double> LabelledObjectCounts::recall() const { return ratioOf(found, labels); }

std::optional<double> LabelledObjectCounts::classRatio() const {
  return ratioOf(found_as_class, found);
}

LabelledObjectError labelledObjectError(const MovingObjectInput& input,
                                        const MovingObjectParams& params) {
  std::map<std::size_t, std::vector<const TrackRow*>> rows_by_frame;
  for (const auto& row : input.rows) {
    if (params.with_coasting || !row.coasting) rows_by_frame[row.frame].push_back(&row);
  }
  LabelledObjectError error;
  const std::size_t end = std::min(input.end_frame, input.labels.size());
  for (std::size_t k = input.first_frame; k < end; ++k) {
    const auto& labels = input.labels[k].truth;
    const auto& rows = rows_by_frame[k];
    std::vector<const TrackRow*> row_of(labels.size(), nullptr);
    for (const auto& pair : pairsOf(labels, rows, params)) row_of[pair.row] = rows[pair.column];
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const LabelledBox& label = labels[i];
      if (!label.box3d || label.occlusion > error.max_occlusion) continue;
      if (groundRange(label.box3d->centre) > error.max_range_m) continue;
      const TrackRow* row = row_of[i];
      const bool as_class = row != nullptr && sameClass(row->object_class, label.object_class);
      for (auto* counts : {&error.all, &error.classes[std::string(toString(label.object_class))]}) {
        ++counts->labels;
        counts->found += row != nullptr ? 1 : 0;
        counts->found_as_class += as_class ? 1 : 0;
      }
    }
  }
  return error;
}

namespace {

/// Sums over the frames of one object.
struct MotionSums {
  ObjectClass object_class = ObjectClass::kUnknown;
  std::size_t frames = 0;
  double translation = 0.0, translation_squared = 0.0;
  double rotation = 0.0, rotation_squared = 0.0;

  void add(const Pose& error) {
    const double distance = error.translation().norm();
    const double angle = logSo3(error.linear()).norm() * (180.0 / M_PI);
    ++frames;
    translation += distance;
    translation_squared += distance * distance;
    rotation += angle;
    rotation_squared += angle * angle;
  }
};

class MotionEvaluation {
 public:
  MotionEvaluation(const MovingObjectInput& input, ObjectMotion motion)
      : input_(input), motion_(motion) {
    for (const auto& row : input.rows) rows_[{row.id, row.frame}] = &row;
  }

  /// E = L(k)^-1 H L(k-1); nullopt if a label, a row or a camera pose is missing.
  std::optional<Pose> errorOf(const MovingMatch& match, ObjectClass& object_class) const {
    if (match.frame == 0) return std::nullopt;
    const auto* label = labelAt(match.object, match.frame);
    const auto* previous_label = labelAt(match.object, match.frame - 1);
    const auto row = rows_.find({match.track, match.frame});
    const auto previous = rows_.find({match.track, match.frame - 1});
    const auto camera = input_.T_map_cam.find(match.frame - 1);
    if (label == nullptr || previous_label == nullptr || row == rows_.end() ||
        previous == rows_.end() || camera == input_.T_map_cam.end()) {
      return std::nullopt;
    }
    object_class = label->object_class;
    const Pose T_world_map = input_.T_world_cam[match.frame - 1].value * camera->second.inverse();
    const Pose H = T_world_map * motionOf(*previous->second, *row->second) * T_world_map.inverse();
    const Pose L = truePose(*label, match.frame);
    return L.inverse() * H * truePose(*previous_label, match.frame - 1);
  }

 private:
  const LabelledBox* labelAt(std::int64_t id, std::size_t frame) const {
    for (const auto& box : input_.labels[frame].truth) {
      if (box.id == id && box.box3d) return &box;
    }
    return nullptr;
  }

  /// Pose of a labelled box in the world: x along its front, y along the camera's y axis.
  Pose truePose(const LabelledBox& box, std::size_t frame) const {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(box.box3d->yaw, Eigen::Vector3d::UnitY()).toRotationMatrix();
    pose.translation() = box.box3d->centre;
    return input_.T_world_cam[frame].value * pose;
  }

  Pose motionOf(const TrackRow& previous, const TrackRow& row) const {
    Pose start = previous.T_map_object;
    if (motion_ == ObjectMotion::kVelocity) {
      const double interval =
          input_.T_world_cam[row.frame].time - input_.T_world_cam[previous.frame].time;
      start.translation() = row.T_map_object.translation() - interval * row.velocity;
    }
    return row.T_map_object * start.inverse();
  }

  const MovingObjectInput& input_;
  ObjectMotion motion_;
  std::map<std::pair<std::int64_t, std::size_t>, const TrackRow*> rows_;
};

ObjectMotionError errorOfSums(std::int64_t id, const MotionSums& sums) {
  const auto n = static_cast<double>(sums.frames);
  return {id,
          sums.object_class,
          sums.frames,
          std::sqrt(sums.translation_squared / n),
          sums.translation / n,
          std::sqrt(sums.rotation_squared / n),
          sums.rotation / n};
}

std::optional<double> meanOver(const std::vector<ObjectMotionError>& objects,
                               double ObjectMotionError::*figure) {
  if (objects.empty()) return std::nullopt;
  double sum = 0.0;
  for (const auto& object : objects) sum += object.*figure;
  return sum / static_cast<double>(objects.size());
}

}  // namespace

ObjectMotionErrors objectMotionErrors(const MovingObjectInput& input,
                                      const std::vector<MovingMatch>& matches,
                                      ObjectMotion motion) {
  const MotionEvaluation evaluation(input, motion);
  std::map<std::int64_t, MotionSums> sums;
  for (const auto& match : matches) {
    ObjectClass object_class = ObjectClass::kUnknown;
    const auto error = evaluation.errorOf(match, object_class);
    if (!error) continue;
    auto& object = sums[match.object];
    object.object_class = object_class;
    object.add(*error);
  }
  ObjectMotionErrors result;
  for (const auto& [id, object] : sums) {
    result.objects.push_back(errorOfSums(id, object));
    result.frames += object.frames;
  }
  result.translation_rmse_m = meanOver(result.objects, &ObjectMotionError::translation_rmse_m);
  result.translation_mean_m = meanOver(result.objects, &ObjectMotionError::translation_mean_m);
  result.rotation_rmse_deg = meanOver(result.objects, &ObjectMotionError::rotation_rmse_deg);
  result.rotation_mean_deg = meanOver(result.objects, &ObjectMotionError::rotation_mean_deg);
  return result;
}

}  // namespace headway::eval
