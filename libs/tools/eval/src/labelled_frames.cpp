// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/labelled_frames.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace headway::eval {
namespace {

constexpr double kSameTime_s = 1e-4;

std::vector<TrueObject> objectsOf(const std::vector<LabelledFrame>& frames,
                                  std::vector<LabelledBox> LabelledFrame::*which,
                                  const std::vector<Stamped<Pose>>& T_map_cam) {
  std::map<std::int64_t, TrueObject> objects;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (k >= T_map_cam.size() && !(frames[k].*which).empty()) {
      throw InputError("only " + std::to_string(T_map_cam.size()) + " poses are given, but frame " +
                       std::to_string(k) + " has labels too");
    }
    for (const auto& box : frames[k].*which) {
      if (!box.box3d) continue;
      const auto& [time, pose] = T_map_cam[k];
      const Eigen::Vector3d front = pose.linear() * frontOf(*box.box3d);
      auto& object = objects[box.id];
      object.id = box.id;
      object.object_class = box.object_class;
      object.path.push_back({k, time, pose * box.box3d->centre, std::atan2(front.y(), front.x())});
    }
  }
  std::vector<TrueObject> result;
  for (auto& [id, object] : objects) result.push_back(std::move(object));
  return result;
}

}  // namespace

std::optional<Eigen::Vector3d> TrueObject::positionAt(Time time, double max_gap_s) const {
  const auto after =
      std::lower_bound(path.begin(), path.end(), time - kSameTime_s,
                       [](const TrajectoryPoint& point, Time t) { return point.time < t; });
  if (after == path.end()) return std::nullopt;
  if (after->time <= time + kSameTime_s) return after->position;
  if (after == path.begin()) return std::nullopt;
  const auto before = after - 1;
  const double gap = after->time - before->time;
  if (gap > max_gap_s) return std::nullopt;
  const double ratio = (time - before->time) / gap;
  return (1.0 - ratio) * before->position + ratio * after->position;
}

std::vector<TrueObject> trueObjects(const std::vector<LabelledFrame>& frames,
                                    const std::vector<Stamped<Pose>>& T_map_cam) {
  return objectsOf(frames, &LabelledFrame::truth, T_map_cam);
}

std::vector<TrueObject> estimatedObjects(const std::vector<LabelledFrame>& frames,
                                         const std::vector<Stamped<Pose>>& T_map_cam) {
  return objectsOf(frames, &LabelledFrame::estimates, T_map_cam);
}

}  // namespace headway::eval
