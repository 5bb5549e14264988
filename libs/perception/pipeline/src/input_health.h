// SPDX-License-Identifier: BSD-3-Clause
// Checks of the input: mounting, scale, clock, wheels and inertial sensor.
#pragma once

#include <headway/core/log.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/stereo_frame.h>
#include <headway/pipeline/perception_update.h>
#include <headway/stereo/frame_context.h>

#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "camera_check.h"
#include "frame_state.h"
#include "stereo_check.h"

namespace headway::pipeline {

/// Recognises a wrong pose of the camera on the robot from the first images.
///
/// The ground decides: it is searched as the camera is said to be mounted. Found once, at the
/// mounted height, it confirms the mounting, and nothing more is computed. Otherwise it is searched
/// as it would appear if the pose lacked the optical turn (x right, y down, z forward), or if the
/// camera were upside-down. Where the mounted height is known, planes at another height, such as a
/// ceiling, are not taken for the ground. Where no ground is seen, as from a drone, the gyroscope's
/// turns tell a missing optical turn: it permutes the axes of the camera's turns.
class MountCheck {
 public:
  explicit MountCheck(const StereoCamera& camera) : camera_(camera) {}

  /// Takes the ground and the disparities of one frame.
  ///
  /// @return fatal: "camera_pose", with the error and the pose to write, once
  [[nodiscard]] std::optional<Finding> addImage(const stereo::FrameContext& context);

  /// Takes the robot's turn since the previous frame, in the robot frame. Ignored once the ground
  /// confirmed the mounting.
  ///
  /// @return as addImage()
  [[nodiscard]] std::optional<Finding> addTurn(const Eigen::Matrix3d& by_camera,
                                               const Eigen::Matrix3d& by_gyroscope,
                                               std::size_t frame);

 private:
  [[nodiscard]] bool showsGround(const stereo::DisparityImage& disparity,
                                 const StereoCamera& camera) const;
  [[nodiscard]] bool isAtMountedHeight(const stereo::GroundPlane& ground) const;
  /// What is wrong, as text; empty unless it is certain.
  [[nodiscard]] std::string testOpticalTurn(const stereo::DisparityImage& disparity);
  [[nodiscard]] std::string testUpsideDown(const stereo::DisparityImage& disparity);
  [[nodiscard]] std::string textWithoutTurn(const std::string& evidence) const;
  [[nodiscard]] std::optional<Finding> decide(const std::string& text, std::size_t frame);

  StereoCamera camera_;
  bool decided_ = false;
  bool decided_by_turns_ = false;
  int images_ = 0;                      ///< in which the ground was not found
  int without_turn_ = 0;                ///< with ground if the pose lacks the optical turn
  int upside_down_ = 0;                 ///< with ground if the camera is upside-down
  double turned_rad_ = 0.0;             ///< by the gyroscope; sum of the angles
  double difference_rad_ = 0.0;         ///< of the camera's turns from it, by the pose as written
  double difference_turned_rad_ = 0.0;  ///< by the pose with the optical turn
};

/// Measures how the camera is mounted by the floor in view, and compares it with what is stated.
///
/// A plane is a floor where nothing is seen below it and the camera moves parallel to it: for 2 s,
/// over at least its height, the plane keeps its place in the camera frame. A camera in a hand, or
/// over a table that it does not stand on, does not keep it. Distances are relative to the height,
/// so that a wrong unit of depths changes nothing but the result.
class FloorCheck {
 public:
  /// The mounting as far as a floor shows it.
  struct Mounting {
    double height_m = 0.0;  ///< of the camera above the floor [m]
    double down_rad = 0.0;  ///< of the optical axis below the horizon [rad]
    double roll_rad = 0.0;  ///< about the optical axis [rad]
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of these three, in this order
  };

  explicit FloorCheck(const StereoCamera& camera) : camera_(camera) {}

  /// Takes one frame.
  ///
  /// @param floor       by stereo::findFloor()
  /// @param T_odom_cam  nullopt if the camera was not tracked
  /// @return "camera_mounting" once, if the mounting stated differs by 3 sigma, or none is stated
  [[nodiscard]] std::optional<Finding> add(Time time, std::size_t frame,
                                           const std::optional<stereo::GroundPlane>& floor,
                                           const std::optional<Pose>& T_odom_cam);
  /// nullopt before a floor was seen.
  [[nodiscard]] const std::optional<Mounting>& mounting() const { return mounting_; }
  /// T_robot_cam by the floor, with the place and the heading that are assumed, where no mounting
  /// is stated and the assumed one, of a camera on a car, is wrong by 3 sigma; else nullopt.
  [[nodiscard]] std::optional<Pose> replacement() const;
  /// The camera is mounted as replacement() says.
  void remount(const StereoCamera& camera) { camera_ = camera; }
  /// The same with its errors, in words.
  [[nodiscard]] std::optional<std::string> text() const;

 private:
  struct Sample {
    Time time;
    std::optional<Mounting> seen;
    Eigen::Vector3d position;  ///< of the camera, odometry frame [m]
  };
  [[nodiscard]] std::optional<Mounting> measured() const;
  [[nodiscard]] std::optional<Finding> compare(std::size_t frame) const;
  [[nodiscard]] bool agreesWith(const Mounting& other, double sigma_height_m,
                                double sigma_tilt_rad) const;

  StereoCamera camera_;
  std::deque<Sample> samples_;
  std::optional<Mounting> mounting_;
};

/// Compares the camera's distances with those of wheel odometry, over pieces of 2 m.
///
/// A wrong baseline or focal length scales all depths and with them the map, which nothing in the
/// images shows. Wheels have errors of their own (pressure, slip), so that a difference is said and
/// not applied. The median over the pieces is robust against slip in less than half of them.
/// Compared are the chords of pieces that are about straight: the noise of many small steps adds up
/// to a path, but not to a chord.
class ScaleCheck {
 public:
  explicit ScaleCheck(const StereoCamera& camera) : camera_(camera) {}

  /// Takes the robot's motion since the previous frame; where one is unknown, a new piece begins.
  ///
  /// @return "odometry_scale" if the first piece differs by a factor of 3, and for each piece at
  ///         whose end the scales differ, surely, by more than 1 %. Fatal: "distance_unit" if the
  ///         first one differs so much that the unit of baseline or depths is wrong
  [[nodiscard]] Findings add(const std::optional<Pose>& by_camera,
                             const std::optional<Pose>& by_odometry, std::size_t frame);

  /// Distances were measured by another calibration until now.
  void restart() {
    piece_ = {};
    ratios_.clear();
  }

  /// Distance by the camera to distance by the wheels.
  struct Ratio {
    double value = 1.0;
    double sigma = 0.0;
  };
  /// Of the newest 400 m; nullopt before 10 m.
  [[nodiscard]] std::optional<Ratio> ratio() const;

 private:
  struct Piece {
    Pose by_camera = Pose::Identity();
    Pose by_odometry = Pose::Identity();
    double path_m = 0.0;  ///< by odometry
  };
  [[nodiscard]] std::optional<Finding> checkUnit(std::size_t frame);

  StereoCamera camera_;
  bool is_unit_checked_ = false;
  Piece piece_;
  std::deque<double> ratios_;  ///< of the newest pieces
};

/// The right camera's rotation against its calibration, as it is undone in images [rad].
struct RightCamera {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  bool has_moved = false;  ///< it was another one before
};

/// Says what is wrong with the input: compares each frame with the frame before, left with right
/// images, and mounting, scale, wheels, inertial sensor and clock with the motion that results.
///
///     state.findings = health.checkFrame(state);  // before it is used
///     ...
///     state.add(health.checkResults(state));
///     state.add(health.checkPair(state));         // for the next frame
class InputHealth {
 public:
  /// @param camera         null without images
  /// @param max_speed_mps  of the robot [m/s]
  /// @param matching       of obstacles and ground
  InputHealth(std::shared_ptr<const StereoCamera> camera, double max_speed_mps,
              const stereo::DisparityParams& matching = {});

  /// A map is loaded in which the right camera is turned like this: until it is recognised, the
  /// camera is lost.
  void resume(const Eigen::Vector3d& right_turn);

  /// Clock, motion prior and images of a frame that has no results yet.
  [[nodiscard]] Findings checkFrame(const FrameState& state);
  /// Whether left and right image agree: the first ones in checkFrame(), since they may refuse the
  /// camera, and as long as none can be compared; later ones here, after all that uses what is
  /// undone of the right camera's rotation in this frame.
  [[nodiscard]] Findings checkPair(const FrameState& state);
  /// Of the newest frame.
  [[nodiscard]] slam::ImageEvidence imageEvidence() const { return images_; }
  [[nodiscard]] RightCamera rightCamera() const;

  /// What pose and detections of the frame say about the input.
  [[nodiscard]] Findings checkResults(const FrameState& state);

  /// Whether no finding so far was fatal.
  [[nodiscard]] bool isTrusted() const { return is_trusted_; }
  /// All findings that were not fatal.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }
  /// As FloorCheck::replacement(); nullopt without camera.
  [[nodiscard]] std::optional<Pose> replacedMounting() const {
    return floor_check_ ? floor_check_->replacement() : std::nullopt;
  }
  /// The camera is mounted as that says.
  void remount(std::shared_ptr<const StereoCamera> camera);

  /// The camera's mounting by the floor; nullopt before one was seen.
  [[nodiscard]] std::optional<std::string> mounting() const {
    return floor_check_ ? floor_check_->text() : std::nullopt;
  }
  /// The right camera's rotation by the images so far; nullopt with too few matches.
  [[nodiscard]] std::optional<stereo::RectificationError> rectification() const {
    return stereo_check_.rectification();
  }

 private:
  void checkImages(const StereoFrame& frame, Findings& findings);
  void comparePair(const StereoFrame& frame, Findings& findings);
  void checkLoss(const FrameState& state, Findings& findings);
  void checkMotion(const FrameState& state, Findings& findings);
  /// Counts findings, and marks those that are the first of their name.
  [[nodiscard]] Findings counted(Findings findings);

  std::shared_ptr<const StereoCamera> camera_;
  double max_speed_mps_;
  CameraCheck camera_check_;
  StereoCheck stereo_check_;
  std::optional<MountCheck> mount_check_;  ///< with a camera, as the next one
  std::optional<FloorCheck> floor_check_;
  std::optional<ScaleCheck> scale_check_;
  slam::ImageEvidence images_ = slam::ImageEvidence::kNone;
  std::optional<Time> disagreed_;  ///< of the last frame whose images contradict each other
  Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();  ///< as the latest comparison left it
  bool was_localised_ = false;                      ///< in some frame, or in a stored map
  bool is_pair_compared_ = false;                   ///< of the newest frame
  bool is_trusted_ = true;
  Warnings warnings_;
};

}  // namespace headway::pipeline
