// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/replay_frames.h>

#include <cmath>

namespace headway::report {
namespace {

namespace fs = std::filesystem;

constexpr double kSamePoseS = 0.03;

/// Transformation from the truth to the estimated map, from the first poses of equal time.
Pose alignment(const fs::path& path, const std::vector<Stamped<Pose>>& truth,
               const std::vector<ReplayFrame>& frames) {
  for (const auto& frame : frames) {
    for (const auto& pose : truth) {
      if (std::abs(pose.time - frame.time) < kSamePoseS) {
        return frame.T_map_robot * pose.value.inverse();
      }
    }
  }
  throw InputError(path.string() +
                   ": no time agrees with a time of the replay; it may belong to another rawlog");
}

}  // namespace

ReplayTruth readReplayTruth(const fs::path& folder, const std::vector<ReplayFrame>& frames,
                            const Note& note) {
  const fs::path trajectory = folder / "trajectory.tum";
  const fs::path objects = folder / "objects.csv";
  if (!fs::exists(trajectory)) {
    throw InputError(trajectory.string() +
                     ": no such file; --truth requires a folder with trajectory.tum");
  }
  ReplayTruth truth;
  truth.path = io::readTum(trajectory);
  const Pose T_map_truth = alignment(trajectory, truth.path, frames);
  for (auto& pose : truth.path) pose.value = T_map_truth * pose.value;
  if (!fs::exists(objects)) {
    note("no objects.csv in " + folder.string() + ": drawn without true boxes");
    return truth;
  }
  for (auto& sample : io::readTrackCsv(objects)) {
    sample.track.position = T_map_truth * sample.track.position;
    sample.track.yaw = wrapAngle(sample.track.yaw + yawOf(T_map_truth));
    truth.objects[sample.frame].push_back(sample.track);
  }
  return truth;
}

}  // namespace headway::report
