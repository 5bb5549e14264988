// SPDX-License-Identifier: BSD-3-Clause
// The true camera and the recorded one: distortion and errors of the calibration.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>
#include <headway/sim/sim_params.h>

#include <opencv2/core/mat.hpp>

namespace headway::sim {

/// The way from an ideal drawing to the image that a lens with radial distortion records.
///
/// Without distortion both are the same. With it, more is drawn than recorded, so that the
/// recorded image is filled to its corners. What is drawn is the true pair; what is recorded
/// about it may be wrong by the calibration's error.
class Lens {
 public:
  /// @throws InputError naming the keys of a distortion that folds the image over itself
  explicit Lens(const CameraParams& params, const CalibrationErrorParams& error = {});

  /// The pair as its calibration says, without distortion, in the recorded size.
  [[nodiscard]] const StereoCamera& ideal() const { return ideal_; }
  /// The true left camera to draw with, larger where the lens sees farther.
  [[nodiscard]] const StereoCamera& drawn() const { return drawn_; }
  /// The true right camera in the left one.
  [[nodiscard]] const Pose& T_left_right() const { return T_left_right_; }
  /// The pair as recorded.
  [[nodiscard]] io::RawStereoCamera recorded() const;

  /// @param smooth  interpolate (pictures); else take the nearest pixel (depth, labels)
  [[nodiscard]] cv::Mat record(const cv::Mat& drawing, bool smooth) const;
  /// A drawn box as it lies in the recorded image, uncut.
  [[nodiscard]] Box2d record(const Box2d& box) const;

 private:
  [[nodiscard]] bool distorts() const { return !map_.empty(); }
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& drawn_px) const;

  double k1_, k2_;
  StereoCamera ideal_;  ///< as recorded
  StereoCamera true_;   ///< the same with its true focal length and baseline
  StereoCamera drawn_;
  Pose T_left_right_ = Pose::Identity();
  cv::Mat map_;  ///< for each recorded pixel its place in the drawing; empty: no distortion
};

}  // namespace headway::sim
