// SPDX-License-Identifier: BSD-3-Clause
#include "rectifier.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

/// Two different lenses with distortion, turned against each other; the robot frame is tilted.
RawStereoCamera crookedPair() {
  RawStereoCamera raw;
  raw.left.width = raw.right.width = 752;
  raw.left.height = raw.right.height = 480;
  raw.left.fx = 458.7;
  raw.left.fy = 457.3;
  raw.left.cx = 367.2;
  raw.left.cy = 248.4;
  raw.left.distortion = {-0.28, 0.074, 0.0002, 1.8e-5, 0.0};
  raw.right.fx = 457.6;
  raw.right.fy = 456.1;
  raw.right.cx = 380.0;
  raw.right.cy = 255.2;
  raw.right.distortion = {-0.283, 0.0745, -0.0001, -3.6e-5, 0.0};
  raw.T_left_right.linear() = expSo3({0.01, -0.02, 0.015});
  raw.T_left_right.translation() << 0.11, 0.002, -0.003;
  raw.T_robot_left = robotFromOptical() * Pose(Eigen::Translation3d(0.1, 0.2, 0.3));
  return raw;
}

/// The same pair behind fisheyes, or with the left one alone behind one.
RawStereoCamera fisheyePair(bool both = true) {
  RawStereoCamera raw = crookedPair();
  raw.left.is_fisheye = true;
  raw.left.distortion = {-0.012, 0.031, -0.028, 0.0067, 0.0};
  raw.left.fx = raw.left.fy = 286.1;
  if (!both) return raw;
  raw.right.is_fisheye = true;
  raw.right.distortion = {-0.009, 0.027, -0.025, 0.0059, 0.0};
  raw.right.fx = raw.right.fy = 286.5;
  return raw;
}

RawStereoCamera rationalPair() {
  RawStereoCamera raw = crookedPair();
  raw.left.distortion = {4.1, 1.7, 1e-4, -2e-4, 0.06};
  raw.left.rational = {4.4, 2.9, 0.35};
  raw.right.distortion = {3.9, 1.6, 1e-4, 1e-4, 0.05};
  raw.right.rational = {4.2, 2.8, 0.33};
  return raw;
}

/// Pixel of a point in a lens' frame, by OpenCV's distortion models.
cv::Point2d distortedPixel(const RawCamera& lens, const Eigen::Vector3d& point) {
  const cv::Matx33d K(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1);
  const std::vector<cv::Point3d> points = {{point.x(), point.y(), point.z()}};
  std::vector<double> distortion(lens.distortion.begin(), lens.distortion.end());
  std::vector<cv::Point2d> pixels;
  if (lens.is_fisheye) {
    distortion.resize(4);
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K,
                               distortion);
  } else {
    distortion.insert(distortion.end(), lens.rational.begin(), lens.rational.end());
    cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K, distortion, pixels);
  }
  return pixels.front();
}

/// An image that is dark but for a soft spot.
cv::Mat spotAt(const cv::Point2d& place, const cv::Size& size) {
  cv::Mat image(size, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double square = (u - place.x) * (u - place.x) + (v - place.y) * (v - place.y);
      image.at<unsigned char>(v, u) =
          cv::saturate_cast<unsigned char>(255 * std::exp(-square / 18));
    }
  }
  return image;
}

cv::Point2d centroidOf(const cv::Mat& image) {
  const cv::Moments moments = cv::moments(image);
  return {moments.m10 / moments.m00, moments.m01 / moments.m00};
}

TEST(RectifierTest, RectifiedPairsAreUnchanged) {
  const Rectifier rectifier(rawFrom(test::smallCamera()));
  EXPECT_TRUE(rectifier.passesThrough());
  const cv::Mat image = test::wall(0).left;
  EXPECT_EQ(image.data, rectifier.rectify(Rectifier::kLeft, image).data);
  const Box2d box{1, 2, 3, 4};
  EXPECT_EQ(box.left, rectifier.rectify(box).left);
  EXPECT_EQ(0.2, rectifier.camera().baseline_m);
}

TEST(RectifierTest, AnyDeviationCountsAsNotRectified) {
  const RawStereoCamera good = rawFrom(test::smallCamera());
  EXPECT_TRUE(isRectified(good));
  const auto with = [&](auto change) {
    RawStereoCamera camera = good;
    change(camera);
    return isRectified(camera);
  };
  EXPECT_FALSE(with([](auto& c) { c.left.distortion[0] = 1e-3; }));
  EXPECT_FALSE(with([](auto& c) { c.right.distortion[4] = 1e-3; }));
  EXPECT_FALSE(with([](auto& c) { c.right.fx += 0.1; }));
  EXPECT_FALSE(with([](auto& c) { c.right.cx += 0.1; }));
  EXPECT_FALSE(with([](auto& c) { c.T_left_right.linear() = expSo3({0, 0, 1e-3}); }));
  EXPECT_FALSE(with([](auto& c) { c.T_left_right.translation().y() = 1e-3; }));
  EXPECT_TRUE(with([](auto& c) { c.T_left_right.linear() = expSo3({0, 0, 1e-7}); }));
}

/// Law of the rectifier: a point in space is at its projection in both images.
void expectPointsAtTheirProjection(const RawStereoCamera& raw) {
  const Rectifier rectifier(raw);
  EXPECT_FALSE(rectifier.passesThrough());
  EXPECT_NEAR(raw.T_left_right.translation().norm(), rectifier.camera().baseline_m, 1e-12);
  const cv::Size size(raw.left.width, raw.left.height);
  for (const Eigen::Vector3d& point_left :
       {Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(0.8, -0.5, 3), Eigen::Vector3d(-1, 0.4, 4)}) {
    const Eigen::Vector3d point_robot = raw.T_robot_left * point_left;
    const Eigen::Vector3d point_cam = rectifier.camera().T_robot_cam.inverse() * point_robot;
    const Eigen::Vector3d expected = project(point_cam, rectifier.camera()).value();
    const auto left = spotAt(distortedPixel(raw.left, point_left), size);
    const auto right =
        spotAt(distortedPixel(raw.right, raw.T_left_right.inverse() * point_left), size);
    const auto place_left = centroidOf(rectifier.rectify(Rectifier::kLeft, left));
    const auto place_right = centroidOf(rectifier.rectify(Rectifier::kRight, right));
    EXPECT_NEAR(expected.x(), place_left.x, 0.1);
    EXPECT_NEAR(expected.y(), place_left.y, 0.1);
    EXPECT_NEAR(expected.x() - expected.z(), place_right.x, 0.1);
    EXPECT_NEAR(expected.y(), place_right.y, 0.1);
  }
}

TEST(RectifierTest, PointsAreAtTheirRectifiedProjection) {
  expectPointsAtTheirProjection(crookedPair());
}

TEST(RectifierTest, FisheyeAndRationalLensesAreRectified) {
  expectPointsAtTheirProjection(fisheyePair());
  expectPointsAtTheirProjection(fisheyePair(false));
  expectPointsAtTheirProjection(rationalPair());
  EXPECT_NEAR(286.3, Rectifier(fisheyePair()).camera().fx, 1e-9);
  RawStereoCamera ideal = rawFrom(test::smallCamera());
  ideal.left.is_fisheye = ideal.right.is_fisheye = true;
  EXPECT_FALSE(isRectified(ideal)) << "even without coefficients, a fisheye is no pinhole";
}

void expectBoxesToFollow(const RawStereoCamera& raw) {
  const Rectifier rectifier(raw);
  const Eigen::Vector3d corner_a(-0.5, -0.3, 2), corner_b(0.4, 0.2, 2);
  const auto a = distortedPixel(raw.left, corner_a);
  const auto b = distortedPixel(raw.left, corner_b);
  const Box2d box = rectifier.rectify(Box2d{a.x, a.y, b.x, b.y});
  for (const auto& corner : {corner_a, corner_b}) {
    const Eigen::Vector3d point_cam =
        rectifier.camera().T_robot_cam.inverse() * raw.T_robot_left * corner;
    const Eigen::Vector3d uvd = project(point_cam, rectifier.camera()).value();
    EXPECT_TRUE(box.contains(uvd.x() + (corner.x() < 0 ? 0.01 : -0.01), uvd.y()));
  }
  EXPECT_LT(box.width(), 1.2 * (b.x - a.x));
  EXPECT_TRUE(std::isnan(rectifier.rectify(Box2d{NAN, 0, 1, 1}).left));
}

TEST(RectifierTest, BoxesFollowTheImage) {
  expectBoxesToFollow(crookedPair());
  expectBoxesToFollow(fisheyePair());
  expectBoxesToFollow(rationalPair());
}

TEST(RectifierTest, SameRectificationEachTime) {
  const auto image = test::wall(0, 8, {752, 480}).left;
  const Rectifier a(crookedPair()), b(crookedPair());
  EXPECT_TRUE(
      test::sameImage(a.rectify(Rectifier::kRight, image), b.rectify(Rectifier::kRight, image)));
}

TEST(RectifierTest, RefusesInvalidStereoPairs) {
  RawStereoCamera camera = crookedPair();
  camera.T_left_right = camera.T_left_right.inverse();
  EXPECT_THROW(Rectifier{camera}, InputError);
  camera.T_left_right.translation().setZero();
  EXPECT_THROW(Rectifier{camera}, InputError);
}

}  // namespace
}  // namespace headway::io
