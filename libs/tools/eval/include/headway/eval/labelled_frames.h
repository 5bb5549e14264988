// SPDX-License-Identifier: BSD-3-Clause
// Labels and tracks of recordings, and the files that contain them.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/pose.h>
#include <headway/core/track.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

/// One object in one frame: a label or a tracker's output.
struct LabelledBox {
  std::int64_t id = -1;  ///< of the object, within its sequence
  ObjectClass object_class = ObjectClass::kUnknown;
  std::optional<Box2d> box2d;  ///< [px]
  std::optional<Box3d> box3d;  ///< optical frame, identical for truth and estimates
  int occlusion = 0;           ///< truth: 0 visible .. 3 unknown, as KITTI
  double truncation = 0.0;     ///< truth: ratio outside the image, 0..1
  double score = 0.0;          ///< estimates: confidence, greater is better
};

/// Truth and estimates of one frame.
struct LabelledFrame {
  std::vector<LabelledBox> truth;
  std::vector<Box2d> dont_care;  ///< unlabelled image regions [px]
  std::vector<LabelledBox> estimates;
};

/// Pedestrian or Person_sitting.
[[nodiscard]] bool isPerson(ObjectClass object_class);

/// One recording.
struct LabelledSequence {
  std::string name;
  std::vector<LabelledFrame> frames;  ///< by frame index
};

/// Trajectory of one object in a recording.
struct TrueObject {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<TrajectoryPoint> path;  ///< map frame, ascending frames, gaps where not labelled

  /// Position at a time, linearly interpolated between labelled frames [m].
  ///
  /// @param max_gap_s  maximum interval to interpolate over [s]
  /// @return           nullopt outside the path and in longer gaps
  [[nodiscard]] std::optional<Eigen::Vector3d> positionAt(Time time, double max_gap_s) const;
};

/// Transforms labels to the map frame, grouped by object; boxes without a 3D box are ignored.
///
/// @param T_map_cam  pose of the labels' optical frame at each frame
/// @return           in ascending order of ids
/// @throws InputError if a labelled frame has no pose
[[nodiscard]] std::vector<TrueObject> trueObjects(const std::vector<LabelledFrame>& frames,
                                                  const std::vector<Stamped<Pose>>& T_map_cam);

/// The same for the estimates: one path per track.
[[nodiscard]] std::vector<TrueObject> estimatedObjects(const std::vector<LabelledFrame>& frames,
                                                       const std::vector<Stamped<Pose>>& T_map_cam);

/// Truth and estimate of the same recording.
struct FilePair {
  std::string name;  ///< of the recording: the file name without extension
  std::string truth;
  std::string estimate;
};

/// Recordings with truth and estimate, and those without an estimate.
struct PairedFiles {
  std::vector<FilePair> pairs;           ///< ascending names
  std::vector<std::string> truth_alone;  ///< recordings without an estimate
};

/// Pairs two files, or the files of two folders by their names without extensions.
///
/// @throws InputError if one is a file and the other a folder, an estimate has no truth of its
/// name,
///         or there are no files
[[nodiscard]] PairedFiles pairedFiles(const std::string& truth, const std::string& estimate);

/// The file of that name in a folder, with any extension; `path` itself if it is a file.
///
/// @throws InputError if there is no such file
[[nodiscard]] std::string fileNamed(const std::string& name, const std::string& path);

/// Requires that both files are in the map (objects.csv, tracks.csv) or both in the camera (KITTI).
///
/// @throws InputError naming both files
void requireSameFrame(const std::string& truth, const std::string& estimate);

/// Reads KITTI tracking labels by frame, whose DontCare rows become regions, or an objects.csv.
///
/// @throws InputError naming the file if it is empty or contains numbers that are not finite
[[nodiscard]] std::vector<LabelledFrame> readLabels(const std::string& path);

/// Reads tracking results, a tracks.csv (which has no scores), or detections (each box without an
/// id becomes a separate track), and adds them to their frames.
///
/// @param dropped  number of rows ignored, by reason
/// @throws InputError naming file and frame if an id occurs twice in a frame, or a number is not
///         finite
void addEstimates(const std::string& path, std::vector<LabelledFrame>& frames,
                  std::map<std::string, std::size_t>& dropped);

/// Reads detections from files as above, from a rawlog's `detections`, or from a folder with such
/// files, directly or in one subfolder per class. Every box becomes a separate track.
///
/// @throws InputError naming the file that cannot be read
[[nodiscard]] std::vector<LabelledFrame> readRaw(const std::string& name, const std::string& path);

enum class PoseFormat { kTum, kKitti };

/// Format of a trajectory file, by the number of columns in its first row.
///
/// @throws InputError naming the file if it is neither format or contains no poses
[[nodiscard]] PoseFormat poseFormatOf(const std::string& path);

/// Frame interval of files without times: KITTI's 10 Hz [s].
inline constexpr double kNominalFrameInterval_s = 0.1;

/// Camera pose in the map at each frame, from a file with one row per frame.
///
/// KITTI poses (camera in the first camera) have no times and are taken as 0.1 s apart. TUM poses
/// are those of the robot in the map.
///
/// @throws InputError naming the file if it cannot be read
[[nodiscard]] std::vector<Stamped<Pose>> readCameraPoses(const std::string& path,
                                                         const Pose& T_robot_cam);

}  // namespace headway::eval
