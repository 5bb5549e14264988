// SPDX-License-Identifier: BSD-3-Clause
// Recordings of the suite: simulated worlds, runs of the pipeline over them, KITTI sequences.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/stereo_camera.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/trajectory_error.h>
#include <headway/pipeline/perception.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway::app {

/// Input of object tracking, with labels.
struct ObjectRecording {
  std::string name;
  std::vector<RecordedFrame> frames;  ///< poses and detections, no images
  Pose T_robot_cam = robotFromOptical();
  std::optional<StereoCamera> camera;       ///< none if the recording has no images
  std::vector<eval::LabelledFrame> labels;  ///< by frame index
};

/// A world to simulate, with the rig of its file or with another.
struct WorldSource {
  std::string ini;
  std::string rig;             ///< a name of sim::rigNames(); empty: the file's own
  bool all_rejections = true;  ///< false: only dynamic_rejection = both
  double rate_hz = 0.0;        ///< frames a second, for the same time; 0: the rig's
};

/// The worlds of some files. Streets have the file's own rig; hall, campus and warehouse come once
/// with `robot` and once with `small`.
///
/// @throws InputError naming file and key of an error in a file
[[nodiscard]] std::vector<WorldSource> worldSources(const std::vector<std::string>& files);

/// A simulated recording on disk.
struct World {
  std::string name;
  std::string rawlog;
  std::string truth_folder;
  std::size_t frames = 0;
  std::size_t frames_wanted = 0;  ///< greater than `frames` if the path ended early
};

/// Called after each frame, possibly by several threads at once; returning false stops the work.
using FrameDone = std::function<bool()>;

/// Simulates a world into a rawlog with truth.
///
/// @param max_frames  maximum number of frames at the rig's own rate
/// @throws InputError naming file and key of an error in the .ini
[[nodiscard]] World simulateWorld(const WorldSource& source, const std::string& folder,
                                  std::optional<std::size_t> max_frames, const FrameDone& done);

/// An earlier recording of the world in `folder`, simulated with the same parameters.
///
/// @return nullopt if there is none, or if its parameters differ
[[nodiscard]] std::optional<World> existingWorld(const WorldSource& source,
                                                 const std::string& folder,
                                                 std::optional<std::size_t> max_frames);

/// Number of frames requested by a world's .ini, at the source's rate.
///
/// @param max_frames  maximum number of frames at the rig's own rate
[[nodiscard]] std::size_t framesOf(const WorldSource& source,
                                   std::optional<std::size_t> max_frames);

/// Result of a run over a world.
struct WorldRun {
  std::size_t lost = 0;                        ///< frames
  std::vector<Stamped<Pose>> estimate;         ///< final poses of the tracked frames
  std::optional<eval::TrajectoryError> error;  ///< none with fewer than 3 tracked frames
  ObjectRecording objects;                     ///< frames with the online poses
};

/// Runs the pipeline over a world's rawlog once per parameter set, in parallel.
///
/// @param threads  at most so many runs at once
/// @return in the order of the parameters; independent of the number of threads
[[nodiscard]] std::vector<WorldRun> runWorld(const World& world,
                                             const std::vector<pipeline::PerceptionParams>& params,
                                             const FrameDone& done, std::size_t threads);

/// Sequences of the KITTI tracking benchmark with PointRCNN boxes.
///
/// @param folder  contains `training/`
[[nodiscard]] std::vector<ObjectRecording> readKittiTracking(const std::string& folder);

/// Stores the runs of a world as `NAME.runs` beside its rawlog, for an evaluation elsewhere: poses
/// only; frames and detections are in the rawlog.
///
/// @param parameters  those of the runs, as text
/// @throws InputError if the file cannot be written
void writeRuns(const World& world, const std::string& parameters,
               const std::vector<WorldRun>& runs);

/// The runs as they were stored, bit by bit; `objects` of the last one only.
///
/// @param parameters  those that the runs must have
/// @throws InputError if the file is missing or damaged, or of another version or parameters
[[nodiscard]] std::vector<WorldRun> readRuns(const World& world, const std::string& parameters);

}  // namespace headway::app
