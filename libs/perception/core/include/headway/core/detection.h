// SPDX-License-Identifier: BSD-3-Clause
// Detections: boxes of objects as a detector reports them in one frame.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/object_class.h>
#include <headway/core/pose.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway {

/// Axis-aligned box in an image, edges in pixels as recorded (right and bottom included).
struct Box2d {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;

  [[nodiscard]] double width() const { return right - left; }
  [[nodiscard]] double height() const { return bottom - top; }
  [[nodiscard]] bool contains(double u, double v) const {
    return u >= left && u <= right && v >= top && v <= bottom;
  }
};

/// Upright box in a sensor's optical frame (x right, y down, z forward).
///
/// Yaw is KITTI's rotation_y: about the frame's y axis, 0 where the front points along +x and
/// -pi/2 where it points along +z, so the front's direction is (cos yaw, 0, -sin yaw).
struct Box3d {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centre of the volume [m]
  double length = 0.0;                               ///< along the front's direction [m]
  double width = 0.0;                                ///< across it [m]
  double height = 0.0;                               ///< along y [m]
  double yaw = 0.0;                                  ///< [rad], in (-pi, pi]
};

/// Velocity of an object over the ground, as measured by a detector.
///
/// Successive measurements are treated as independent: a detector that uses several frames must
/// enlarge the covariance accordingly.
struct MeasuredVelocity {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< of the object, not of the camera [m/s]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< [m^2/s^2]
  /// It is a mean over some time, whose middle was so long before the frame [s].
  double age_s = 0.0;
};

/// Kinds of evidence for an object in one frame; after fusion it may have several.
struct DetectionEvidence {
  bool classifier = false;  ///< an image classifier or a recorded box: the class is known
  bool motion = false;      ///< measurements over several frames are explained by motion only
  bool change = false;      ///< it stands where space was seen to be empty
  bool appearance = false;  ///< it matches the template of an expected object
  bool classifier_tested = false;  ///< an image classifier evaluated this frame
  bool motion_tested = false;      ///< motion of an object at this position would be measurable
  bool periodic = false;           ///< only of detectors that do not run on each frame
};

struct AppearanceTemplate;  // see <headway/core/appearance.h>
struct ObjectMask;

/// One object as a detector reports it in one frame: a 2D box, a 3D box, or both.
struct Detection {
  ObjectClass object_class = ObjectClass::kUnknown;
  double score = 1.0;                       ///< the detector's own scale, higher is better
  std::optional<std::int64_t> detector_id;  ///< of the detector's own tracking, not binding
  std::optional<Box2d> box2d;               ///< [px], image as recorded
  std::optional<Box3d> box3d;               ///< sensor's optical frame
  std::optional<Eigen::Matrix3d> centre_covariance;  ///< of box3d->centre, optical frame [m^2]
  std::optional<MeasuredVelocity> velocity;          ///< along the optical frame's axes
  DetectionEvidence evidence;
  std::optional<TrackId> searched_track;   ///< for which the detector searched, not binding
  std::shared_ptr<const ObjectMask> mask;  ///< null: no mask
  std::shared_ptr<const AppearanceTemplate> appearance;  ///< null: no template
};

/// All detections of one detector in one frame; `items` is empty if nothing was detected.
struct Detections {
  Time time = 0.0;                           ///< of the image [s]
  Pose T_robot_sensor = robotFromOptical();  ///< the optical frame of the 3D boxes
  int image_width = 0;                       ///< of the image of the 2D boxes [px], 0 unknown
  int image_height = 0;                      ///< [px], 0 unknown
  bool all_detectors_ran = true;  ///< false: what is detected periodically may be there, too
  std::vector<Detection> items;
};

/// The box of an upright object in an optical frame.
///
/// @param centre           of its volume, in a frame whose z axis points up [m]
/// @param size             (length, width, height) [m]
/// @param yaw              of its front about that frame's z axis [rad]
/// @param T_optical_frame  maps points of that frame into the optical one
[[nodiscard]] Box3d opticalBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size,
                               double yaw, const Pose& T_optical_frame);

/// The same velocity along the axes of another frame.
[[nodiscard]] MeasuredVelocity rotated(const MeasuredVelocity& velocity,
                                       const Eigen::Matrix3d& R_new_old);

/// Whether every number is finite.
[[nodiscard]] bool isFinite(const Box2d& box);
[[nodiscard]] bool isFinite(const Box3d& box);
[[nodiscard]] bool isFinite(const MeasuredVelocity& velocity);

/// The same detections with their 3D boxes and velocities in the frame of another sensor on the
/// same robot.
[[nodiscard]] Detections inSensorFrame(const Detections& detections, const Pose& T_robot_sensor);

/// Direction of the box's front in the optical frame, unit length.
[[nodiscard]] Eigen::Vector3d frontOf(const Box3d& box);

/// KITTI's rotation_y of a direction in the optical frame: inverse of frontOf.
[[nodiscard]] double opticalYaw(const Eigen::Vector3d& direction);

/// Whether a matrix can be the covariance of a place: positive semi-definite up to rounding, and
/// nowhere above 1 km^2 (finite).
[[nodiscard]] bool isCovariance(const Eigen::Matrix3d& matrix);

/// Number of excluded detections by reason ("nan_box", "behind_camera", ...).
using DropCounts = std::map<std::string, std::size_t>;

/// Removes the covariance of a box if it cannot be one, and counts it as `bad_covariance`. The box
/// then has the noise that is assumed of boxes without a covariance.
void removeBadCovariance(Detection& detection, DropCounts& dropped);

/// Whether its score and each number of its boxes and its velocity are finite.
[[nodiscard]] bool isFinite(const Detection& detection);

/// Whether no number of its boxes and no score is beyond 10^6, which no image and no sensor
/// reaches [px, m]. Numbers that are not finite are not judged.
[[nodiscard]] bool isPlausible(const Detection& detection);

/// Time after the last evidence of motion until an object is static and is no longer searched [s].
inline constexpr double kMotionMemory_s = 1.0;

/// An object that the tracker expects to be visible, as a plain value for detectors to search for.
///
/// A detector that finds it names `track` in Detection::searched_track; whether the detection
/// continues that track is up to the tracker.
struct ExpectedObject {
  TrackId track;
  ObjectClass object_class = ObjectClass::kUnknown;
  Time time = 0.0;                                     ///< of `position` [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< box centre, map frame [m]
  MeasuredVelocity velocity;                ///< map frame, as a detector measured it last
  int observations = 0;                     ///< frames in which it was detected
  std::optional<std::int64_t> detector_id;  ///< of its last detection that had one
  Time last_observed = 0.0;                 ///< [s]
  Time last_motion = 0.0;  ///< when a detector last had evidence of motion over several frames [s]
  std::shared_ptr<const AppearanceTemplate> appearance;  ///< null: no template

  /// Where it will be if it keeps its velocity, map frame [m].
  [[nodiscard]] Eigen::Vector3d positionAt(Time then) const {
    return position + (then - time) * velocity.value;
  }
};

}  // namespace headway
