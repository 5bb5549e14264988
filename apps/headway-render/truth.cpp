#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <cmath>
#include <filesystem>

#include "finished_replay.h"

namespace headway::render_program {
namespace {

namespace fs = std::filesystem;

constexpr double kSameFrameS = 0.03;

/// Transformation from the truth to the estimated map, from the first poses of equal time.
Pose alignment(const std::string& path, const std::vector<Stamped<Pose>>& truth,
               const std::vector<ReplayFrame>& frames) {
  for (const auto& frame : frames) {
    for (const auto& pose : truth) {
      if (std::abs(pose.time - frame.time) < kSameFrameS) {
        return frame.T_map_robot * pose.value.inverse();
      }
    }
  }
  throw InputError(path +
                   ": no time agrees with a time of the replay; it may belong to another rawlog");
}

}  // namespace

Truth readTruth(const std::string& folder_name, const std::vector<ReplayFrame>& frames,
                const Note& note) {
  const fs::path folder(folder_name);
  const fs::path trajectory = folder / "trajectory.tum";
  const fs::path objects = folder / "objects.csv";
  if (!fs::exists(trajectory)) {
    throw InputError(trajectory.string() +
                     ": no such file; --truth requires a folder with trajectory.tum");
  }
  Truth truth;
  truth.path = io::readTum(trajectory);
  const Pose T_map_truth = alignment(trajectory, truth.path, frames);
  for (auto& pose : truth.path) pose.value = T_map_truth * pose.value;
  if (!fs::exists(objects)) {
    note("no objects.csv in " + folder_name + ": drawn without true boxes");
    return truth;
  }
  for (auto& sample : io::readTrackCsv(objects)) {
    sample.track.position = T_map_truth * sample.track.position;
    sample.track.yaw = wrapAngle(sample.track.yaw + yawOf(T_map_truth));
    truth.objects[sample.frame].push_back(sample.track);
  }
  return truth;
}

}  // namespace headway::render_program
