// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/object_motion_error.h>

#include <cmath>

namespace headway::eval {
namespace {

constexpr double kDegreesPerRad = 180.0 / M_PI;

/// Sums over the frames of one object.
struct MotionSums {
  ObjectClass object_class = ObjectClass::kUnknown;
  std::size_t frames = 0;
  double translation = 0.0, translation_squared = 0.0;
  double rotation = 0.0, rotation_squared = 0.0;

  void add(const Pose& error) {
    const double distance = error.translation().norm();
    const double angle = logSo3(error.linear()).norm() * kDegreesPerRad;
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
