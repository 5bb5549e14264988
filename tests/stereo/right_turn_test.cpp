// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rectification.h>

#include <memory>
#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

constexpr double kTurnDegree = M_PI / 180.0;

StereoCamera turnedRig() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 200;
  camera.fx = camera.fy = 260.0;
  camera.cx = 159.5;
  camera.cy = 99.5;
  camera.baseline_m = 0.3;
  return camera;
}

/// A smooth pattern that is known at all places.
double brightness(const Eigen::Vector2d& uv) {
  return 128.0 + 60.0 * std::sin(0.31 * uv.x() + 0.17 * uv.y()) +
         40.0 * std::sin(0.05 * uv.x() - 0.23 * uv.y());
}

/// The pattern of the exact camera as a turned one sees it, or the exact one if not turned.
cv::Mat seen(const Eigen::Vector3d& angles) {
  const StereoCamera rig = turnedRig();
  cv::Mat image(rig.height, rig.width, CV_8U);
  for (int v = 0; v < rig.height; ++v) {
    for (int u = 0; u < rig.width; ++u) {
      // What a turned camera sees at (u, v) is where the camera turned the other way sees it.
      const Eigen::Vector2d at = turnedPixel(Eigen::Vector2d(u, v), -angles, rig);
      image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(brightness(at));
    }
  }
  return image;
}

TEST(RightTurnTest, APixelMovesAsAPointOfSpaceDoes) {
  const StereoCamera rig = turnedRig();
  const Eigen::Vector3d angles = Eigen::Vector3d(0.3, -0.2, 0.4) * kTurnDegree;
  const Eigen::Vector3d point(0.7, -0.4, 5.0);  // in the exact right camera
  const Eigen::Vector3d turned = expSo3(angles).transpose() * point;
  const Eigen::Vector2d exact(rig.fx * point.x() / point.z() + rig.cx,
                              rig.fy * point.y() / point.z() + rig.cy);
  const Eigen::Vector2d expected(rig.fx * turned.x() / turned.z() + rig.cx,
                                 rig.fy * turned.y() / turned.z() + rig.cy);
  EXPECT_LT((turnedPixel(exact, angles, rig) - expected).norm(), 1e-9);
  EXPECT_GT((exact - expected).norm(), 1.0);
}

TEST(RightTurnTest, TurnsTheImageBackToAFractionOfAGreyLevel) {
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();
    angles[axis] = 0.3 * kTurnDegree;
    const cv::Rect inside(8, 8, turnedRig().width - 16, turnedRig().height - 16);
    const cv::Mat exact = seen(Eigen::Vector3d::Zero())(inside);
    const double before = cv::norm(seen(angles)(inside), exact, cv::NORM_L1);
    const cv::Mat undone = RightTurn(angles, turnedRig()).undone(seen(angles));
    const auto pixels = static_cast<double>(exact.total());
    EXPECT_LT(cv::norm(undone(inside), exact, cv::NORM_L1) / pixels, 1.0) << axis;
    EXPECT_GT(before / pixels, 4.0) << axis;
  }
}

TEST(RightTurnTest, WithoutATurnTheImageIsTheSame) {
  const cv::Mat image = seen(Eigen::Vector3d::Zero());
  EXPECT_EQ(RightTurn().undone(image).data, image.data);
  EXPECT_EQ(RightTurn(Eigen::Vector3d::Zero(), turnedRig()).undone(image).data, image.data);
}

TEST(RightTurnTest, DisparitiesFollowTheTurn) {
  const StereoCamera rig = turnedRig();
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  const Eigen::Vector3d yaw(0.0, 0.3 * kTurnDegree, 0.0);
  // Measured in the images as they are, the camera being turned: too great by f yaw (1 + x^2).
  const double exact = 12.0;
  const Eigen::Vector2d right = turnedPixel({100.0 - exact, 60.0}, yaw, rig);
  const double measured = 100.0 - right.x();
  EXPECT_NEAR(measured - exact, rig.fx * yaw.y() * (1.0 + std::pow((88.0 - 159.5) / 260.0, 2)),
              0.02);
  EXPECT_NEAR(turnedDisparity({100.0, 60.0}, measured, none, yaw, rig), exact, 0.01);
  EXPECT_NEAR(turnedDisparity({100.0, 60.0}, exact, yaw, none, rig), measured, 0.01);
}

TEST(RightTurnTest, AllWhoUseAFrameSeeTheExactImage) {
  StereoFrame frame;
  frame.camera = std::make_shared<StereoCamera>(turnedRig());
  const Eigen::Vector3d pitch(0.3 * kTurnDegree, 0.0, 0.0);
  frame.left = seen(Eigen::Vector3d::Zero());
  frame.right = seen(pitch);
  FrontEnd front_end((DisparityParams()));
  const cv::Mat before = frame.right.clone();
  EXPECT_EQ(front_end.next(frame, 0.0).frame().right.data, frame.right.data);
  front_end.setRightTurn({pitch, turnedRig()});
  const auto context = front_end.next(frame, 0.0);
  EXPECT_EQ(cv::norm(context.frame().right, RightTurn(pitch, turnedRig()).undone(frame.right)),
            0.0);
  EXPECT_EQ(cv::norm(frame.right, before), 0.0) << "the recorded image is shared";
  EXPECT_EQ(context.frame().left.data, frame.left.data);
}

}  // namespace
}  // namespace headway::stereo
