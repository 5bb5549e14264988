// SPDX-License-Identifier: BSD-3-Clause
// The predefined rigs: car, robot, small and rgbd.
#include <headway/core/error.h>
#include <headway/sim/rigs.h>

#include <algorithm>

namespace headway::sim {
namespace {

struct Rig {
  std::string name;
  int width, height;  // [px]
  double focal_px;
  double baseline_m;
  double mount_height_m, mount_forward_m;
  double pitch_down_deg;
  double rate_hz;
  double ride_deg;    // of a car's suspension, of a robot's wheels
  double noise_grey;  // smaller sensors are noisier
  bool depth_camera = false;
};

const std::vector<Rig>& rigs() {
  static const std::vector<Rig> kRigs = {
      {"car", 1240, 376, 718.0, 0.54, 1.65, 0.0, 0.0, 10.0, 0.25, 2.0},
      {"robot", 1280, 720, 700.0, 0.12, 0.5, 0.15, 10.0, 15.0, 0.3, 2.0},
      {"small", 640, 480, 450.0, 0.05, 0.3, 0.1, 5.0, 15.0, 0.3, 2.5},
      {"rgbd", 848, 480, 425.0, 0.075, 0.5, 0.15, 10.0, 15.0, 0.3, 2.0, true}};
  return kRigs;
}

}  // namespace

const std::vector<std::string>& rigNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Rig& rig : rigs()) names.push_back(rig.name);
    return names;
  }();
  return kNames;
}

void applyRig(const std::string& name, CameraParams& camera) {
  const auto rig = std::find_if(rigs().begin(), rigs().end(),
                                [&](const Rig& candidate) { return candidate.name == name; });
  if (rig == rigs().end()) {
    std::string known;
    for (const std::string& other : rigNames()) known += (known.empty() ? "" : ", ") + other;
    throw InputError("rig '" + name + "' is unknown; known are " + known);
  }
  camera.width = rig->width;
  camera.height = rig->height;
  camera.focal_px = rig->focal_px;
  camera.baseline_m = rig->baseline_m;
  camera.mount_height_m = rig->mount_height_m;
  camera.mount_forward_m = rig->mount_forward_m;
  camera.pitch_down_deg = rig->pitch_down_deg;
  camera.rate_hz = rig->rate_hz;
  camera.ride_deg = rig->ride_deg;
  camera.noise_grey = rig->noise_grey;
  camera.depth_camera = rig->depth_camera;
}

}  // namespace headway::sim
