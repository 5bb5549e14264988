// SPDX-License-Identifier: BSD-3-Clause
// How fast a video is drawn and encoded: 1280 x 720, 100,000 landmarks, 50 moving tracks, and a
// dense map of a million points, unless it is left out.
//
// bench_video OUT.mp4 [SUPERSAMPLING [PICTURES [no-dense]]]

#include <headway/render/video_file.h>
#include <headway/scene/snapshot.h>
#include <mrpt/maps/CColouredPointsMap.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "example_world.h"

namespace {

using namespace headway;
using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A street of 300 m: two façades and the ground between.
slam::MapView street() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<slam::LandmarkView> landmarks;
  for (int i = 0; i < 100000; ++i) {
    const double x = 300.0 * share(random);
    const double side = share(random) < 0.5 ? -9.0 : 9.0;
    const Eigen::Vector3d place = i % 3 == 0 ? Eigen::Vector3d(x, 18.0 * (share(random) - 0.5), 0.0)
                                             : Eigen::Vector3d(x, side, 8.0 * share(random));
    landmarks.push_back(
        {LandmarkId{i}, place, 4, static_cast<std::uint8_t>(255.0 * share(random))});
  }
  return {landmarks, {}};
}

/// The same street as a dense map: a point in each voxel of 10 cm.
mrpt::maps::CColouredPointsMap::Ptr denseStreet() {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> within(0.F, 0.1F), share(0.F, 1.F);
  auto points = mrpt::maps::CColouredPointsMap::Create();
  points->reserve(1100000);
  const auto add = [&](float x, float y, float z, float red, float green, float blue) {
    const float grain = 0.7F + 0.3F * share(random);
    points->insertPointRGB(x + within(random), y + 0.2F * within(random), z + within(random),
                           grain * red, grain * green, grain * blue);
  };
  for (int i = 0; i < 3000; ++i) {
    const float x = 0.1F * static_cast<float>(i);
    for (int j = 0; j < 180; ++j) add(x, 0.1F * static_cast<float>(j) - 9.F, 0.F, .4F, .4F, .42F);
    for (int j = 0; j < 80; ++j) {
      add(x, -9.F, 0.1F * static_cast<float>(j), .7F, .5F, .4F);
      add(x, 9.F, 0.1F * static_cast<float>(j), .6F, .6F, .5F);
    }
  }
  return points;
}

std::vector<Track> traffic(double time) {
  std::vector<Track> tracks;
  for (int i = 0; i < 50; ++i) {
    const bool person = i % 2 == 0;
    const double speed = person ? 1.3 : 6.0;
    const double x = 5.0 + 1.6 * i + speed * time;
    auto track = map::exampleTrack(i, person ? ObjectClass::kPedestrian : ObjectClass::kCar,
                                   {x, -8.0 + 0.32 * i, person ? 0.85 : 0.75}, 0.0);
    if (person) track.size = {0.5, 0.5, 1.7};
    tracks.push_back(track);
  }
  return tracks;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    return std::fprintf(stderr, "bench_video OUT.mp4 [SUPERSAMPLING [PICTURES [no-dense]]]\n"), 2;
  }
  scene::SnapshotOptions options;
  options.supersampling = argc > 2 ? std::atoi(argv[2]) : 1;  // as headway-render does
  const int pictures = argc > 3 ? std::atoi(argv[3]) : 60;
  scene::SnapshotRenderer renderer(options);
  render::VideoFile video(argv[1], 20.0, {options.width, options.height});
  map::PerceptionMap map;
  map.update(street());
  const bool dense = argc <= 4 || std::string(argv[4]) != "no-dense";
  if (dense) map.update(denseStreet());
  std::vector<Stamped<Pose>> path;
  double draw_ms = 0.0, encode_ms = 0.0;
  const auto start = Clock::now();
  for (int i = 0; i < pictures; ++i) {
    const double time = 0.05 * i;
    map.update(time, traffic(time));
    const Pose T_map_robot(Eigen::Translation3d(8.0 * time, 0.0, 0.0));
    path.push_back({time, T_map_robot});
    scene::SnapshotInput input{map, static_cast<std::size_t>(i), time, T_map_robot};
    input.path = path;
    const auto draw_start = Clock::now();
    const cv::Mat picture = renderer.draw(input);
    draw_ms += millisecondsSince(draw_start);
    const auto encode_start = Clock::now();
    video.add(picture);
    encode_ms += millisecondsSince(encode_start);
  }
  video.finish();
  const double total_ms = millisecondsSince(start);
  std::printf(
      "%d pictures, supersampling %d, %s: draw %.1f ms, encode %.1f ms, %.1f pictures/s "
      "(bar: 20)\n",
      pictures, options.supersampling, dense ? "dense map" : "landmarks only", draw_ms / pictures,
      encode_ms / pictures, 1000.0 * pictures / total_ms);
}
