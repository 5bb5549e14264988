// SPDX-License-Identifier: BSD-3-Clause
// Which moving objects are found, and how well their motion is known.
#pragma once

#include <headway/eval/labelled_frames.h>

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

/// One row of a tracker's output, in the camera frame of its frame.
struct TrackRow {
  std::size_t frame = 0;
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  bool moving = false;
  bool coasting = false;                               ///< predicted, not observed in this frame
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();    ///< box centre, optical frame [m]
  std::optional<Box2d> box2d;                          ///< of the box; nullopt behind the camera
  Pose T_map_object = Pose::Identity();                ///< pose in the tracker's map
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< tracker's map [m/s]
};

/// Truth and estimate of one recording.
struct MovingObjectInput {
  std::vector<LabelledFrame> labels;       ///< truth and DontCare regions by frame
  std::vector<Stamped<Pose>> T_world_cam;  ///< true pose of the labels' camera by frame
  std::vector<TrackRow> rows;
  std::map<std::size_t, Pose> T_map_cam;  ///< estimated camera by frame, at tracked frames
  std::size_t first_frame = 0;            ///< evaluated frames: first_frame .. end_frame - 1
  std::size_t end_frame = 0;
  int image_width = 0;   ///< [px]
  int image_height = 0;  ///< [px]
};

/// Which labels and tracks count as moving.
struct MovingObjectParams {
  double moving_mps = 1.0;          ///< labels faster than this move
  double right_mps = 0.5;           ///< a moving row is right near labels faster than this
  double half_window_s = 0.5;       ///< a label's speed is its mean over this time before and after
  double min_window_s = 0.25;       ///< labelled time below which a label's speed is unknown
  double max_distance_m = 2.0;      ///< of a row from its label on the ground
  double max_distance_ratio = 0.1;  ///< or this ratio of the label's range, if greater
  double dont_care_ratio = 0.5;     ///< rows with a greater area ratio in DontCare are ignored
  bool with_coasting = false;       ///< also count rows of tracks not observed in the frame
};

/// Recall of moving labels and precision of moving rows.
struct MovingCounts {
  std::size_t labels = 0;          ///< moving labels
  std::size_t found = 0;           ///< with a moving row near them
  std::size_t found_as_class = 0;  ///< with one of their class (Van counts as Car)
  std::size_t rows = 0;            ///< moving rows that are not ignored
  std::size_t right = 0;           ///< near a moving label
  std::size_t right_as_class = 0;  ///< near one of their class

  [[nodiscard]] std::optional<double> recall() const;
  [[nodiscard]] std::optional<double> recallAsClass() const;
  [[nodiscard]] std::optional<double> precision() const;
  [[nodiscard]] std::optional<double> precisionAsClass() const;
};

/// A track with rows that are classified as moving.
struct MovingTrack {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;  ///< of its latest moving row
  std::size_t first_frame = 0, last_frame = 0;
  std::size_t rows = 0;   ///< moving rows that are not ignored
  std::size_t wrong = 0;  ///< of these

  /// At least half of its rows are wrong.
  [[nodiscard]] bool isFalse() const { return rows > 0 && 2 * wrong >= rows; }
};

/// A moving label matched with a row of the tracker, one to one.
struct MovingMatch {
  std::size_t frame = 0;
  std::int64_t object = -1;
  std::int64_t track = -1;
};

/// Recall and precision of moving objects over all frames, and the false moving tracks.
struct MovingObjectError {
  std::size_t frames = 0;
  MovingCounts all;
  MovingCounts within_40m;
  std::map<std::string, MovingCounts> classes;    ///< labels by their class, rows by theirs
  std::map<std::string, MovingCounts> ranges;     ///< "00-10", "10-20", "20-40", "40-" [m]
  std::map<std::string, MovingCounts> occlusion;  ///< labels alone; KITTI's 0 to 3
  std::vector<MovingTrack> tracks;                ///< by id
  std::size_t false_tracks = 0;
  std::size_t duplicate_rows = 0;              ///< right, but another row is matched to the label
  std::map<std::string, std::size_t> ignored;  ///< moving rows by reason
  std::vector<MovingMatch> matches;            ///< by frame

  /// nullopt without frames.
  [[nodiscard]] std::optional<double> falseTracksPer100Frames() const;
};

/// Labelled objects, moving or not, and the confirmed tracks near them.
struct LabelledObjectCounts {
  std::size_t labels = 0;
  std::size_t found = 0;           ///< with a confirmed row of their own near them
  std::size_t found_as_class = 0;  ///< with one of their class (Van counts as Car)

  [[nodiscard]] std::optional<double> recall() const;
  /// Ratio of found labels whose row has their class.
  [[nodiscard]] std::optional<double> classRatio() const;
};

/// Labels that a detector should find: near and visible.
struct LabelledObjectError {
  double max_range_m = 30.0;
  int max_occlusion = 1;  ///< KITTI's 0 to 3
  LabelledObjectCounts all;
  std::map<std::string, LabelledObjectCounts> classes;  ///< of the labels
};

/// Evaluates which labelled objects have a confirmed track, whether they move or not.
///
/// Labels and rows are paired one to one at minimum distance; rows of unlabelled objects are not
/// counted, because data sets do not label every parked car.
[[nodiscard]] LabelledObjectError labelledObjectError(const MovingObjectInput& input,
                                                      const MovingObjectParams& params);

/// Evaluates which moving objects a tracker finds, and what it takes for one.
///
/// A label is found if a moving row is within the maximum distance of it, on the ground (x and z of
/// the camera). Moving rows that are near no label faster than `right_mps` are wrong, unless they
/// are ignored: in a DontCare region, with the centre outside the image, or near a label of unknown
/// speed. Labels of lost frames count as not found.
///
/// @throws InputError if a labelled frame has no true pose
[[nodiscard]] MovingObjectError movingObjectError(const MovingObjectInput& input,
                                                  const MovingObjectParams& params);

/// How the tracker's motion between two frames is taken from its rows.
enum class ObjectMotion {
  kPoses,     ///< from the poses of both rows
  kVelocity,  ///< translation from the later row's velocity, rotation from the poses
};

/// Motion error of one true object.
struct ObjectMotionError {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::size_t frames = 0;  ///< pairs of frames evaluated
  double translation_rmse_m = 0.0, translation_mean_m = 0.0;
  double rotation_rmse_deg = 0.0, rotation_mean_deg = 0.0;
};

/// Motion errors of all objects: means over the objects of their RMSE and of their means.
struct ObjectMotionErrors {
  std::vector<ObjectMotionError> objects;  ///< by id
  std::size_t frames = 0;
  std::optional<double> translation_rmse_m, translation_mean_m;
  std::optional<double> rotation_rmse_deg, rotation_mean_deg;
};

/// Error of the motions of matched objects from frame to frame.
///
/// For true poses L of the object in the world, and the estimated motion H that maps the object at
/// frame k-1 to that at frame k in the world, the error is E = L(k)^-1 H L(k-1): its translation
/// and its angle, in the object's true frame. The tracker's map is aligned to the world by the
/// camera pose at frame k-1, so that only the camera's error between both frames contributes. A
/// motion is evaluated if the object is matched at frame k, and its track has rows at both frames.
///
/// @see Morris et al., "DynoSAM: open-source smoothing and mapping framework for dynamic SLAM",
///      arXiv 2501.11893; its evaluation program reports the RMSE of each object
[[nodiscard]] ObjectMotionErrors objectMotionErrors(const MovingObjectInput& input,
                                                    const std::vector<MovingMatch>& matches,
                                                    ObjectMotion motion);

/// Which moving objects a replay found, and how well it knew their motion.
struct MoverEvaluation {
  MovingObjectInput input;  ///< what was compared
  MovingObjectError error;  ///< of confirmed rows
  MovingObjectError with_coasting;
  LabelledObjectError labelled;
  ObjectMotionErrors motion;           ///< by the poses in tracks.csv
  ObjectMotionErrors motion_velocity;  ///< by the velocities in tracks.csv
  ObjectMotionErrors motion_smoothed;  ///< by the poses in tracks_smoothed.csv
};

/// Evaluates a replay as `headway-eval movers` does.
///
/// @param labels  KITTI tracking labels
/// @param poses   true pose of every frame: KITTI (camera), TUM (robot), or a rawlog with
/// truth_pose
/// @param replay  output folder of headway-replay
/// @throws InputError naming the file that cannot be read or does not match the others
[[nodiscard]] MoverEvaluation evaluateMovers(const std::string& labels, const std::string& poses,
                                             const std::string& replay);

/// The figures of `headway-eval movers --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const MoverEvaluation& evaluation);

}  // namespace headway::eval
