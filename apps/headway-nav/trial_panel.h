// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/math/TPose2D.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "trial.h"

namespace headway::app {

/// Layout of a picture of trials [px].
inline constexpr int kPanelWidth = 426, kPictureHeight = 720, kTitleHeight = 64, kLegendHeight = 54;

const cv::Scalar kPaper(250, 250, 250), kInk(60, 50, 45), kFaint(215, 215, 215);
const cv::Scalar kRobot(170, 95, 30), kPerson(40, 130, 235), kPillar(140, 140, 140);
const cv::Scalar kPrediction(80, 165, 70), kObstacle(60, 60, 215), kContact(40, 40, 220);

/// Panel of one trial in a picture: its ground from above, x upwards, y to the left.
///
/// Places are of the trial's frame [m]. The scale is such that `bounds` fill the panel, and is
/// shown by a bar.
class TrialPanel {
 public:
  /// @param image   of the panel, with room for title and legend; drawn on
  /// @param bounds  x and y that the panel shows, in its middle [m]
  TrialPanel(cv::Mat image, const RobotParams& robot, const Eigen::AlignedBox2d& bounds);

  /// Grid, scale and goal.
  void drawGround();
  void circle(const Eigen::Vector2d& centre, double radius_m, const cv::Scalar& colour,
              int thickness);
  void dot(const Eigen::Vector2d& centre, int radius_px, const cv::Scalar& colour);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Scalar& colour,
            int thickness);
  void robot(const mrpt::math::TPose2D& pose, const cv::Scalar& colour, int thickness);
  /// Left out where it would cover another text.
  ///
  /// @param place  of its lower left corner
  void text(const std::string& words, const Eigen::Vector2d& place, double size,
            const cv::Scalar& colour);
  void title(const std::string& name, const std::string& state, bool bad);

  /// Whether a position is in the drawn area.
  [[nodiscard]] bool shows(const Eigen::Vector2d& place) const;

 private:
  [[nodiscard]] double spacingM() const;
  void drawScale(double metres);
  [[nodiscard]] cv::Point at(const Eigen::Vector2d& place) const;

  cv::Mat image_;
  RobotParams robot_;
  Eigen::Vector2d middle_;  ///< position in the middle of the panel [m]
  double pixels_per_m_;
  std::vector<cv::Rect> texts_;  ///< drawn so far [px]
};

}  // namespace headway::app
