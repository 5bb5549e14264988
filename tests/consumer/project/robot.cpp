// SPDX-License-Identifier: BSD-3-Clause
// A robot's program: sensors push observations; poses, tracks and the map come out.
#include <headway/map/map_query.h>
#include <headway/run/session.h>

#include <cstdio>
#include <thread>

#include "sensors.h"  // stands for the robot's drivers: calls back with each CObservation

int main(int, char** argv) {
  headway::io::LiveSourceOptions options;
  options.observations.read_ahead = 1;  // this robot's boxes come after their images
  headway::io::LiveSource sensors(options);
  std::thread drivers([&] {
    runSensors(argv[1], [&](auto observation) { sensors.push(observation); });
    sensors.close();
  });
  headway::run::SensorFrames source(sensors);
  headway::pipeline::Perception perception(source.camera(),
                                           headway::pipeline::PerceptionParams::live());
  headway::map::SharedMap shared;  // for planners and viewers, in any thread
  headway::run::MapPublisher publisher(shared);
  headway::run::Session session(source, perception, {&publisher});
  while (const auto live = session.next()) {
    const auto& update = live->update;
    const auto place = update.camera.T_map_robot.translation();
    const auto map = shared.snapshot();
    const auto near = map->at(update.time).tracksNear(place.head<2>(), 20.0, update.time + 1.0);
    std::printf("frame %zu: robot at %.2f %.2f, %zu landmarks, %zu tracks, %zu near in 1 s\n",
                update.frame, place.x(), place.y(), map->landmarks().size(),
                update.objects.tracks.size(), near.items.size());
    std::printf("  %.0f ms after its images, %zu frames dropped so far\n", 1e3 * live->latency_s(),
                live->source.dropped);
  }
  session.complete();
  drivers.join();
}
