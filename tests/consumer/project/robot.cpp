// A robot's program: sensors push observations; poses, tracks and the map come out.
#include <headway/io/rawlog_source.h>
#include <headway/map/map_query.h>
#include <headway/map/shared_map.h>
#include <headway/pipeline/perception.h>

#include <cstdio>
#include <thread>

#include "sensors.h"  // stands for the robot's drivers: calls back with each CObservation

int main(int, char** argv) {
  headway::io::ObservationQueue queue;
  headway::map::SharedMap shared;  // for planners and viewers, in any thread
  std::thread drivers([&] {
    runSensors(argv[1], [&](auto observation) { queue.push(observation); });
    queue.close();
  });
  headway::io::RawlogSourceOptions options;
  options.read_ahead = 1;  // this robot's boxes come after their images
  headway::io::RawlogSource source(queue, options);
  headway::pipeline::Perception perception(source.camera(), {});
  while (auto frame = source.next()) {
    const auto update = perception.process(*frame);
    shared.publish(perception.map());
    const auto place = update.camera.T_map_robot.translation();
    const auto map = shared.snapshot();
    const auto near = map->at(frame->time).tracksNear(place.head<2>(), 20.0, frame->time + 1.0);
    std::printf("frame %zu: robot at %.2f %.2f, %zu landmarks, %zu tracks, %zu near in 1 s\n",
                frame->index, place.x(), place.y(), map->landmarks().size(),
                update.objects.tracks.size(), near.items.size());
  }
  drivers.join();
}
