// SPDX-License-Identifier: BSD-3-Clause
// What one call of PredictiveObstacles::senseObstacles costs, without the robot's own sensing.

#include <benchmark/benchmark.h>
#include <headway/nav/predictive_obstacles.h>
#include <headway_test/walking_track.h>

#include <cmath>

#include "../../nav/scripted_robot.h"

namespace {

using headway::nav::ObstaclePolicy;

/// People all about the robot, 2 to 11 m away, each with two predicted paths.
std::vector<headway::Track> crowd(int count) {
  std::vector<headway::Track> tracks;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.4 * i;
    const double range = 2.0 + 9.0 * i / count;
    const Eigen::Vector2d place = range * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d velocity(std::cos(1.7 * i), std::sin(1.7 * i));
    auto track = headway::test::walkingTrack(i, place, 1.2 * velocity, 0.2);
    const Eigen::Vector2d turned(-velocity.y(), velocity.x());
    track.predictions.push_back(
        headway::test::walkingTrack(i, place, turned, 0.3).predictions.front());
    track.predictions[0].probability = 0.7;
    track.predictions[1].probability = 0.3;
    tracks.push_back(track);
  }
  return tracks;
}

void senseObstacles(benchmark::State& state, ObstaclePolicy policy) {
  mrpt::kinematics::CVehicleSimul_DiffDriven wheels;
  headway::nav::ScriptedRobot robot(wheels);
  for (int degree = 0; degree < 360; ++degree) {
    const double angle = degree * M_PI / 180.0;
    robot.sensed.emplace_back(5.0 * std::cos(angle), 5.0 * std::sin(angle));
  }
  headway::map::PerceptionMap map;
  map.update(1.0, crowd(static_cast<int>(state.range(0))));
  headway::nav::PredictiveObstaclesParams params;
  params.policy = policy;
  headway::nav::PredictiveObstacles obstacles(
      robot, [&] { return map; }, params, [] { return 1.05; });
  mrpt::maps::CSimplePointsMap points;
  mrpt::system::TTimeStamp timestamp;
  for (auto _ : state) {
    benchmark::DoNotOptimize(obstacles.senseObstacles(points, timestamp));
  }
  state.counters["points"] = static_cast<double>(points.size());
}

}  // namespace

BENCHMARK_CAPTURE(senseObstacles, points_of_now, ObstaclePolicy::kStatic)->Arg(50);
BENCHMARK_CAPTURE(senseObstacles, sweep, ObstaclePolicy::kSweep)->Arg(50);
BENCHMARK_CAPTURE(senseObstacles, time_gated, ObstaclePolicy::kTimeGated)->Arg(5)->Arg(50);

BENCHMARK_MAIN();
