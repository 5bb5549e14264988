// SPDX-License-Identifier: BSD-3-Clause
#include "mount_check.h"

#include <headway/core/text.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/rig_capability.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>

namespace headway::pipeline {
namespace {

constexpr int kMaxImages = 8;              // without ground, after which the check ends
constexpr int kMinWithoutTurn = 3;         // of them that show the error
constexpr int kMinUpsideDown = 7;          // more, because a ceiling may look like ground
constexpr double kMinTurnRad = 0.01;       // between two frames; less is noise and bias
constexpr double kMinTurnsRad = 0.5;       // sum of the compared turns
constexpr double kContrary = 0.6;          // difference to turn where the axes are wrong
constexpr double kEqual = 0.25;            // where they are right
constexpr double kVertical = 0.7;          // component of the optical axis along the robot's z
constexpr double kUprightComponent = 0.7;  // of "up" along the image's columns
constexpr double kMaxHeightError = 0.35;   // of the camera's height, relative
constexpr double kDegrees = 180.0 / M_PI;

/// A pose as MRPT writes it: x y z [m], yaw pitch roll [deg].
std::string poseText(const Pose& pose) {
  const Eigen::Matrix3d R = pose.linear();
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double roll = std::atan2(R(2, 1), R(2, 2));
  std::string text = "[";
  for (int i = 0; i < 3; ++i) text += formatted("%.3f ", pose.translation()[i]);
  text += formatted("%.1f ", yaw * kDegrees) + formatted("%.1f ", pitch * kDegrees);
  return text + formatted("%.1f]", roll * kDegrees) + " (x y z [m] yaw pitch roll [deg])";
}

Pose turned(const Pose& T_robot_cam, const Eigen::Matrix3d& R_cam_other) {
  Pose result = T_robot_cam;
  result.linear() = T_robot_cam.linear() * R_cam_other;
  return result;
}

Pose upsideDown(const Pose& T_robot_cam) {
  return turned(T_robot_cam, Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix());
}

/// The disparity image of the camera turned by 180 degrees about its optical axis.
stereo::DisparityImage flipped(const stereo::DisparityImage& disparity, StereoCamera& camera) {
  stereo::DisparityImage result;
  result.reduce = disparity.reduce;
  cv::flip(disparity.values, result.values, -1);
  camera.cx = disparity.pixelOf(0) + disparity.pixelOf(disparity.values.cols - 1) - camera.cx;
  camera.cy = disparity.pixelOf(0) + disparity.pixelOf(disparity.values.rows - 1) - camera.cy;
  return result;
}

}  // namespace

bool MountCheck::isAtMountedHeight(const stereo::GroundPlane& ground) const {
  const auto rig = stereo::rigCapability(camera_);
  return !rig.camera_height_known || std::abs(ground.camera_height - rig.camera_height_m) <
                                         kMaxHeightError * rig.camera_height_m;
}

bool MountCheck::showsGround(const stereo::DisparityImage& disparity,
                             const StereoCamera& camera) const {
  const auto ground = stereo::findGround(disparity, camera, std::nullopt);
  return ground && isAtMountedHeight(*ground);
}

std::optional<Finding> MountCheck::addImage(const stereo::FrameContext& context) {
  if (decided_) return std::nullopt;
  if (context.ground() && isAtMountedHeight(*context.ground())) {
    decided_ = decided_by_turns_ = true;
    return std::nullopt;
  }
  ++images_;
  const bool is_vertical = std::abs(camera_.T_robot_cam.linear()(2, 2)) > kVertical;
  const auto text =
      is_vertical ? testOpticalTurn(context.disparity()) : testUpsideDown(context.disparity());
  decided_ = decided_ || images_ == kMaxImages;
  return decide(text, context.frame().index);
}

std::optional<Finding> MountCheck::decide(const std::string& text, std::size_t frame) {
  if (text.empty()) return std::nullopt;
  decided_ = decided_by_turns_ = true;
  return Finding{"camera_pose", frame, text, Severity::kFatal};
}

std::string MountCheck::testOpticalTurn(const stereo::DisparityImage& disparity) {
  StereoCamera with_turn = camera_;
  with_turn.T_robot_cam = turned(camera_.T_robot_cam, robotFromOptical().linear());
  if (showsGround(disparity, with_turn)) ++without_turn_;
  if (without_turn_ < kMinWithoutTurn) return "";
  const bool up = camera_.T_robot_cam.linear()(2, 2) > 0.0;
  return textWithoutTurn(std::string("the camera looks straight ") + (up ? "up" : "down") +
                         ", but its images show the ground ahead");
}

std::string MountCheck::textWithoutTurn(const std::string& evidence) const {
  return "camera pose: by cameraPose = " + poseText(camera_.T_robot_cam) + " " + evidence +
         ": the pose lacks the turn to optical axes (x right, y down, z forward); write "
         "cameraPose = " +
         poseText(turned(camera_.T_robot_cam, robotFromOptical().linear()));
}

std::optional<Finding> MountCheck::addTurn(const Eigen::Matrix3d& by_camera,
                                           const Eigen::Matrix3d& by_gyroscope, std::size_t frame) {
  const Eigen::Vector3d measured = logSo3(by_gyroscope);
  if (decided_by_turns_ || measured.norm() < kMinTurnRad) return std::nullopt;
  const Eigen::Matrix3d R = camera_.T_robot_cam.linear();
  const Eigen::Vector3d turn = logSo3(by_camera);
  turned_rad_ += measured.norm();
  difference_rad_ += (turn - measured).norm();
  difference_turned_rad_ +=
      (R * robotFromOptical().linear() * R.transpose() * turn - measured).norm();
  if (turned_rad_ < kMinTurnsRad) return std::nullopt;
  decided_by_turns_ = true;
  const bool is_contrary = difference_rad_ > kContrary * turned_rad_;
  if (!is_contrary || difference_turned_rad_ >= kEqual * turned_rad_) return std::nullopt;
  return decide(textWithoutTurn("its turns contradict the gyroscope's (if it is right, correct the "
                                "inertial sensor's sensorPose, or leave that out by "
                                "slam.use_imu=false)"),
                frame);
}

std::string MountCheck::testUpsideDown(const stereo::DisparityImage& disparity) {
  const double up_y = stereo::mountedUp(camera_).y();
  if (std::abs(up_y) < kUprightComponent) return "";
  const bool said_upright = up_y < 0.0;
  StereoCamera turned_camera = camera_;
  turned_camera.T_robot_cam = upsideDown(camera_.T_robot_cam);
  StereoCamera flipped_camera = said_upright ? camera_ : turned_camera;
  const stereo::DisparityImage flipped_image = flipped(disparity, flipped_camera);
  if (!said_upright && showsGround(flipped_image, flipped_camera)) {
    decided_ = true;
    return "";
  }
  const bool contrary = said_upright ? showsGround(flipped_image, flipped_camera)
                                     : showsGround(disparity, turned_camera);
  if (contrary) ++upside_down_;
  if (upside_down_ < kMinUpsideDown) return "";
  return std::string("camera pose: the images show the ground ") +
         (said_upright ? "above" : "below") +
         " the camera, but by cameraPose = " + poseText(camera_.T_robot_cam) + " it is " +
         (said_upright ? "upright" : "upside-down") +
         ": turn it about its optical axis; write cameraPose = " +
         poseText(turned_camera.T_robot_cam);
}

}  // namespace headway::pipeline
