// SPDX-License-Identifier: BSD-3-Clause
// A planner's question to the map: how fast may the robot drive straight ahead?
#include <headway/map/map_query.h>
#include <headway/run/session.h>

#include <cstdio>

/// The highest speed at which the next second is known to be free; 0 if none is, or nothing known.
double safeSpeed(const headway::map::PerceptionMap& map, const headway::Pose& T_map_robot,
                 headway::Time now) {
  const headway::map::FootprintShape robot{0.6, 0.5};  // length and width [m]
  for (const double speed : {1.0, 0.5, 0.25}) {
    std::vector<headway::map::TimedPose> path;
    for (double s = 0.0; s <= 1.0; s += 0.1) {
      const Eigen::Vector3d place = T_map_robot * Eigen::Vector3d(speed * s, 0.0, 0.0);
      path.push_back({now + s, place.head<2>(), headway::yawOf(T_map_robot)});
    }
    if (map.at(now).timeToCollision(robot, path).isFree()) return speed;
  }
  return 0.0;
}

int main(int, char** argv) {
  headway::run::RawlogFrames source(argv[1]);
  headway::pipeline::Perception perception(source.camera(), {});
  headway::map::SharedMap shared;  // snapshot() in any thread
  headway::run::MapPublisher publisher(shared);
  headway::run::Session session(source, perception, {&publisher});
  while (const auto result = session.next()) {
    const auto& update = result->update;
    const bool is_tracked = update.camera.status == headway::slam::TrackingStatus::kTracked;
    const auto& pose = update.camera.T_map_robot;
    const double speed = is_tracked ? safeSpeed(*shared.snapshot(), pose, update.time) : 0.0;
    std::printf("%.1f s: drive at %.2f m/s\n", update.time, speed);
  }
}
