#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/trajectory_error.h>
#include <headway/pipeline/perception.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway::app {

/// What the moving-object layer alone needs of a recording, and what is true of it.
struct ObjectRecording {
  std::string name;
  std::vector<RecordedFrame> frames;  ///< poses and detections, no images
  Pose T_robot_cam = robotFromOptical();
  std::optional<StereoCamera> camera;       ///< of the images; none where there are none
  std::vector<eval::LabelledFrame> labels;  ///< by frame index
};

/// A drawn world on disk.
struct World {
  std::string name;
  std::string rawlog;
  std::string truth_folder;
  std::size_t frames = 0;
  std::size_t frames_wanted = 0;  ///< more than `frames` if the path ended before
};

/// Called after each frame, by several threads at once if runs go side by side; false ends the
/// work.
using FrameDone = std::function<bool()>;

/// Draws the world of an .ini file as a rawlog with its truth.
///
/// @param most_frames  draw no more than these
/// @throws InputError naming file and key of what is wrong in the .ini
[[nodiscard]] World drawWorld(const std::string& ini, const std::string& folder,
                              std::optional<std::size_t> most_frames, const FrameDone& done);

/// The world of an .ini file as `folder` holds it already, drawn with the same parameters.
///
/// @return nullopt if there is none, or if it is of other parameters
[[nodiscard]] std::optional<World> drawnWorld(const std::string& ini, const std::string& folder,
                                              std::optional<std::size_t> most_frames);

/// Frames that a world's .ini asks for.
[[nodiscard]] std::size_t framesOf(const std::string& ini);

/// What a whole run over a world gave.
struct WorldRun {
  std::size_t lost = 0;                        ///< frames
  std::optional<eval::TrajectoryError> error;  ///< none if too little was tracked
  ObjectRecording objects;                     ///< frames with the poses as published
};

/// Runs the whole pipeline over a world's rawlog once with each of the parameters, as many runs
/// side by side as there are processors.
///
/// @return in the order of the parameters; the runs do not depend on each other
[[nodiscard]] std::vector<WorldRun> runWorld(const World& world,
                                             const std::vector<pipeline::PerceptionParams>& params,
                                             const FrameDone& done);

/// Sequences of KITTI's tracking benchmark with PointRCNN's boxes.
///
/// @param folder  holds `training/`
[[nodiscard]] std::vector<ObjectRecording> readKittiTracking(const std::string& folder);

}  // namespace headway::app
