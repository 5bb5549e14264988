// SPDX-License-Identifier: BSD-3-Clause
// A rectified pair, or an image with depths, and the motion measured since the frame before.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <cstddef>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace headway {

/// The robot's motion since the previous frame, from other sensors.
struct MotionPrior {
  /// Index of that frame; nullopt: one less than this frame's.
  std::optional<std::size_t> previous_frame;
  std::optional<Pose> T_previous_current;             ///< wheel odometry: robot now in robot before
  std::optional<Eigen::Matrix3d> R_previous_current;  ///< gyroscope: turn of the robot frame
  /// Accelerometer: integral of the specific force between both frames, turned by the gyroscope
  /// into the robot frame of the previous one [m/s] (Forster et al. 2017, eq. 33, without bias).
  std::optional<Eigen::Vector3d> velocity_increment;
  /// Mean specific force around this frame, robot frame: +g upwards at rest [m/s^2].
  std::optional<Eigen::Vector3d> specific_force;
};

/// One rectified stereo pair with time and calibration.
///
/// Images share their memory with the producer's and must not be modified.
struct StereoFrame {
  std::size_t index = 0;  ///< of the stereo frame in its rawlog, from 0
  Time time = 0.0;        ///< [s]
  cv::Mat left;           ///< 8-bit grey, camera->height x camera->width
  cv::Mat right;          ///< 8-bit grey, same size; empty: depth camera
  /// Of a depth camera, 32-bit float, size of `left`: disparities [px], 0 where unknown; else
  /// empty.
  cv::Mat disparity;
  cv::Mat left_colour;                         ///< 8-bit BGR of the left image; empty if grey
  std::shared_ptr<const StereoCamera> camera;  ///< never null; the same object for all frames
  MotionPrior motion_prior;
};

/// The motion from the frame before a skipped one to the frame after it, as far as both parts are
/// known.
///
/// @param next  of the frame after it; returned as it is if it counts from another frame
[[nodiscard]] inline MotionPrior joined(const StereoFrame& skipped, const MotionPrior& next) {
  if (next.previous_frame.value_or(skipped.index) != skipped.index) return next;
  const MotionPrior& first = skipped.motion_prior;
  MotionPrior all;
  all.previous_frame = first.previous_frame.value_or(skipped.index - 1);
  all.specific_force = next.specific_force;
  if (first.T_previous_current && next.T_previous_current) {
    all.T_previous_current = *first.T_previous_current * *next.T_previous_current;
  }
  if (!first.R_previous_current) return all;
  if (next.R_previous_current) {
    all.R_previous_current = *first.R_previous_current * *next.R_previous_current;
  }
  if (first.velocity_increment && next.velocity_increment) {
    all.velocity_increment =
        *first.velocity_increment + *first.R_previous_current * *next.velocity_increment;
  }
  return all;
}

}  // namespace headway
