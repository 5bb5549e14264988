// SPDX-License-Identifier: BSD-3-Clause
// What map queries call free by the images alone, against the truth of each frame of a simulated
// recording.
//   bench_free_now RECORDING.rawlog [LAYER [MAPPING]]
// LAYER: 0 without what is blocked now; MAPPING: 0 without a map. RECORDING.truth is written by
// headway-sim --depth
// --masks. Prints a JSON object:
//   people, people_free            people at 0.6 to 6 m of whom 30 % are visible; those whose place
//   is called free ground, ground_free            footprints of the robot within 3 m, all of whose
//   ground is visible and free; of blocked, blocked_free          them called free; footprints that
//   a visible surface is in; of them called free own, own_free                  places of the robot
//   itself 0.8 to 2 s later; called free local_ms                       median time of the scan a
//   frame
#include <headway/core/object_class.h>
#include <headway/core/text.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_query.h>
#include <headway/pipeline/perception.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "evaluation_inputs.h"

namespace {

using namespace headway;
using Eigen::Vector2d;

/// Cells around the robot in its frame, by the true depths.
struct SeenGround {
  static constexpr double kCell_m = 0.1, kReach_m = 4.0;
  static constexpr int kSide = static_cast<int>(2.0 * kReach_m / kCell_m);
  std::vector<int> ground = std::vector<int>(kSide * kSide), obstacle = ground;

  SeenGround(const cv::Mat& depth, const StereoCamera& camera, const Pose& T_map_robot) {
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        const auto z = static_cast<double>(depth.at<float>(v, u));
        // Both cameras see it.
        const bool is_seen =
            z > 0.0 && (camera.isDepthCamera() || u >= camera.fx * camera.baseline_m / z);
        if (!is_seen) continue;
        const Eigen::Vector3d point = camera.T_robot_cam * (z * ray(Eigen::Vector2d(u, v), camera));
        const double height = (T_map_robot.linear() * point).z();
        int* cell = at(ground, point.head<2>());
        if (cell == nullptr || height > 1.9) continue;
        if (std::abs(height) < 0.03) ++*cell;
        if (height > 0.15) ++*at(obstacle, point.head<2>());
      }
    }
  }

  static int* at(std::vector<int>& cells, const Vector2d& place) {
    const int x = static_cast<int>(std::floor((place.x() + kReach_m) / kCell_m));
    const int y = static_cast<int>(std::floor((place.y() + kReach_m) / kCell_m));
    if (x < 0 || y < 0 || x >= kSide || y >= kSide) return nullptr;
    return &cells[static_cast<std::size_t>(y * kSide + x)];
  }

  /// 1: all ground of a disc is seen and nothing stands within 0.1 m of it; -1: something stands in
  /// it; else 0.
  int stateOf(const Vector2d& centre, double radius) {
    bool is_seen = true;
    for (double x = -radius - 0.1; x <= radius + 0.1; x += 0.5 * kCell_m) {
      for (double y = -radius - 0.1; y <= radius + 0.1; y += 0.5 * kCell_m) {
        const double r = std::hypot(x, y);
        if (r > radius + 0.1) continue;
        const Vector2d place = centre + Vector2d(x, y);
        const int* stands = at(obstacle, place);
        if (stands == nullptr) return 0;
        if (*stands >= 2) return r < radius - 0.1 ? -1 : 0;
        if (r < radius) is_seen = is_seen && *at(ground, place) >= 1;
      }
    }
    return is_seen ? 1 : 0;
  }
};

struct Count {
  std::size_t asked = 0, free = 0;
  void add(bool is_free) {
    ++asked;
    free += is_free ? 1 : 0;
  }
};

map::TimedPose timedPose(Time time, const Vector2d& place, double yaw) {
  map::TimedPose pose;
  pose.time = time;
  pose.position = place;
  pose.yaw = yaw;
  return pose;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const std::string rawlog = argv[1];
  const auto truth = std::filesystem::path(rawlog).replace_extension(".truth");
  pipeline::PerceptionParams params;
  params.detection.detector = "stereo_motion";
  params.grid.local = argc < 3 || std::string(argv[2]) != "0";
  params.slam.mapping = argc < 4 || std::string(argv[3]) != "0";
  io::RawlogSource source(rawlog, {});
  pipeline::Perception perception(source.camera(), params);
  std::multimap<std::size_t, io::ObjectSample> people;
  for (auto& object : io::readObjectCsv((truth / "objects.csv").string())) {
    const ObjectClass kind = object.object.track.object_class;
    if (kind == ObjectClass::kPedestrian || kind == ObjectClass::kPersonSitting)
      people.emplace(object.object.frame, object);
  }
  const auto path = io::readTum((truth / "trajectory.tum").string());
  const map::FootprintShape person{0.4, 0.4, true}, robot{0.5, 0.4, false};
  Count persons, ground, blocked, own, own_near;
  while (auto frame = source.next()) {
    const auto update = perception.process(*frame);
    const Pose T_map_true =
        update.camera.T_map_robot * path.at(frame->index).value.inverse(Eigen::Isometry);
    const map::MapQuery query = perception.map().at(update.time);
    const auto isFree = [&](const map::FootprintShape& shape, const Vector2d& place, double yaw) {
      return query.timeToCollision(shape, {timedPose(update.time, place, yaw)}).isFree();
    };
    const Pose T_robot_true = path[frame->index].value.inverse(Eigen::Isometry);
    const auto [first, end] = people.equal_range(frame->index);
    for (auto at = first; at != end; ++at) {
      const Eigen::Vector3d& in_true = at->second.object.track.position;
      const Vector2d in_robot = (T_robot_true * in_true).head<2>();
      if (at->second.visible < 0.3 || in_robot.norm() < 0.6 || in_robot.norm() > 6.0) continue;
      const bool is_free = isFree(person, (T_map_true * in_true).head<2>(), 0.0);
      persons.add(is_free);
      if (is_free)
        std::fprintf(stderr, "frame %zu: person at %.2f %.2f, visible %.2f\n", frame->index,
                     in_robot.x(), in_robot.y(), at->second.visible);
    }
    for (std::size_t later = frame->index; later < path.size(); ++later) {
      const double ahead_s = path[later].time - path[frame->index].time;
      if (ahead_s < 0.8 || ahead_s > 2.0) continue;
      const Pose at = T_map_true * path[later].value;
      const bool is_free = isFree(robot, at.translation().head<2>(), yawOf(at));
      const bool is_near = std::any_of(first, end, [&](const auto& item) {
        const Eigen::Vector3d& place = item.second.object.track.position;
        return (path[later].value.translation() - place).head<2>().norm() < 1.5;
      });
      (is_near ? own_near : own).add(is_free);
    }
    if (frame->index % 5 != 0) continue;
    SeenGround seen(eval::readTrueDepth(truth, frame->index, *source.camera()), *source.camera(),
                    path[frame->index].value);
    const double yaw = yawOf(update.camera.T_map_robot);
    for (double x = 0.4; x < 3.0; x += 0.2) {
      for (double y = -2.0; y <= 2.0; y += 0.2) {
        const int state = std::hypot(x, y) > 3.0 ? 0 : seen.stateOf({x, y}, 0.32);
        if (state == 0) continue;
        const Vector2d place = (update.camera.T_map_robot * Eigen::Vector3d(x, y, 0.0)).head<2>();
        (state > 0 ? ground : blocked).add(isFree(robot, place, yaw));
      }
    }
  }
  const auto times = perception.times().summary();
  const auto local = times.find("local");
  std::string line;
  const auto add = [&line](const char* name, const Count& count) {
    line += formatted("\"%s\": %zu, \"%s_free\": %zu, ", name, count.asked, name, count.free);
  };
  add("people", persons);
  add("ground", ground);
  add("blocked", blocked);
  add("own", own);
  add("own_near", own_near);
  std::printf("{%s\"local_ms\": %.2f}\n", line.c_str(),
              local == times.end() ? 0.0 : local->second.median_ms);
  return 0;
}
