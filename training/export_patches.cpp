// SPDX-License-Identifier: BSD-3-Clause
// Labelled patches of simulated recordings, from which people_by_shape.py trains its network.
//
//     export_patches OUT.patches RECORDING.rawlog...
//
// For each place at which something stands: three 32-bit floats (label; offset of the person's
// middle to the right and away from the camera [m]), then the values of its patch, 8-bit. The label
// is 1 within 0.4 m of a person of whom a fifth is visible, 0 farther than 0.7 m from everybody;
// places between, and those of cyclists, are left out.
#include <headway/core/error.h>
#include <headway/core/random.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shape_patch.h"

namespace {

namespace detect = headway::detect;
namespace io = headway::io;

constexpr int kPatchesOfAPlace = 4;  // of people; 2 of others: all but the first are displaced
constexpr double kJitter_m = 0.1;

/// People and cyclists of each frame, in the map.
using Truth = std::map<std::size_t, std::vector<io::ObjectSample>>;

struct Label {
  float is_person = 0.0F, right_m = 0.0F, away_m = 0.0F;
};

bool isPerson(headway::ObjectClass object_class) {
  return object_class == headway::ObjectClass::kPedestrian ||
         object_class == headway::ObjectClass::kPersonSitting;
}

/// nullopt where it is not clear what stands there.
std::optional<Label> labelOf(const Eigen::Vector3d& place,
                             const headway::stereo::GroundPlane& ground,
                             const std::vector<io::ObjectSample>& objects,
                             const headway::Pose& T_cam_map) {
  Label label;
  double nearest = 0.7;  // [m]
  for (const auto& [sample, visible] : objects) {
    const auto object_class = sample.track.object_class;
    const bool is_person = isPerson(object_class);
    const Eigen::Vector3d offset = T_cam_map * sample.track.position - place;
    const double distance = (offset - offset.dot(ground.up) * ground.up).norm();
    if (!is_person && object_class != headway::ObjectClass::kCyclist) continue;
    if (distance > (is_person ? nearest : 1.3)) continue;
    if (!is_person || visible < 0.2 || distance > 0.4) return std::nullopt;
    nearest = distance;
    const auto [across, away] = detect::axesAt(place, ground);
    label = {1.0F, static_cast<float>(offset.dot(across)), static_cast<float>(offset.dot(away))};
  }
  return label;
}

Eigen::Vector3d jittered(const Eigen::Vector3d& place, const headway::stereo::GroundPlane& ground,
                         headway::Random& random) {
  const auto [across, away] = detect::axesAt(place, ground);
  const double right_m = kJitter_m * random.normal();
  const double away_m = kJitter_m * random.normal();
  return place + right_m * across + away_m * away;
}

/// What one recording gave.
struct Exported {
  std::size_t patches = 0;
  std::size_t people = 0, found = 0;  ///< half visible within reach, and those with a place
};

/// Counts the people of a frame, and those at one of the places.
void countPeople(const std::vector<Eigen::Vector3d>& places, double range_m,
                 const headway::StereoCamera& camera, const std::vector<io::ObjectSample>& objects,
                 const headway::Pose& T_cam_map, Exported& exported) {
  for (const auto& [sample, visible] : objects) {
    const Eigen::Vector3d at = T_cam_map * sample.track.position;
    const auto uv = project(at, camera);
    if (!isPerson(sample.track.object_class) || visible < 0.5 || at.z() > range_m || !uv ||
        uv->x() < 0.0 || uv->x() > camera.width || uv->y() < 0.0 || uv->y() > camera.height) {
      continue;
    }
    ++exported.people;
    exported.found += std::any_of(places.begin(), places.end(), [&](const Eigen::Vector3d& place) {
      return std::hypot(place.x() - at.x(), place.z() - at.z()) < 0.4;
    });
  }
}

Exported exportRecording(const std::string& rawlog, std::ofstream& out) {
  const auto folder = std::filesystem::path(rawlog).replace_extension(".truth");
  Truth truth;
  for (const auto& sample : io::readObjectCsv((folder / "objects.csv").string())) {
    truth[sample.object.frame].push_back(sample);
  }
  const auto poses = io::readTum((folder / "trajectory.tum").string());
  io::RawlogSource source(rawlog, {});
  headway::stereo::FrontEnd front_end{headway::stereo::DisparityParams()};
  headway::Random random(1);
  Exported exported;
  while (auto frame = source.next()) {
    if (!frame->stereo || frame->index >= poses.size()) continue;
    const auto context = front_end.next(*frame->stereo, 0.0);
    const auto& ground = context.ground();
    if (!ground) continue;
    const auto& camera = context.camera();
    const headway::Pose T_cam_map = (poses[frame->index].value * camera.T_robot_cam).inverse();
    const double range_m = 1.3 * stereo::rigCapability(camera).standing_to_m;
    const auto places = detect::standingPlaces(context.disparity(), camera, *ground, range_m);
    countPeople(places, range_m, camera, truth[frame->index], T_cam_map, exported);
    for (const auto& found : places) {
      for (int i = 0; i < kPatchesOfAPlace; ++i) {
        const auto place = i == 0 ? found : jittered(found, *ground, random);
        const auto label = labelOf(place, *ground, truth[frame->index], T_cam_map);
        if (!label || (i > 1 && label->is_person == 0.0F)) continue;
        const cv::Mat patch = detect::shapePatch(place, context.disparity(), camera, *ground);
        out.write(reinterpret_cast<const char*>(&*label), sizeof(*label));
        out.write(patch.ptr<char>(), static_cast<std::streamsize>(patch.total()));
        ++exported.patches;
      }
    }
  }
  return exported;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::ofstream out(argc > 2 ? argv[1] : "", std::ios::binary);
    if (!out) throw headway::InputError("usage: export_patches OUT.patches RECORDING.rawlog...");
    for (int i = 2; i < argc; ++i) {
      const Exported exported = exportRecording(argv[i], out);
      std::printf("%s: %zu patches; a place at %zu of %zu people\n", argv[i], exported.patches,
                  exported.found, exported.people);
      std::fflush(stdout);
    }
    return 0;
  } catch (const headway::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
