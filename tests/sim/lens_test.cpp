// SPDX-License-Identifier: BSD-3-Clause
#include "lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

namespace headway::sim {
namespace {

using ::testing::HasSubstr;

TEST(LensTest, WithoutDistortionNothingChanges) {
  const Lens lens{CameraParams{}};
  cv::Mat picture(376, 1240, CV_8UC3, cv::Scalar(1, 2, 3));
  EXPECT_EQ(lens.record(picture, true).data, picture.data);
  EXPECT_EQ(lens.drawn().width, lens.ideal().width);
  const Box2d box{10, 20, 30, 40};
  EXPECT_DOUBLE_EQ(lens.record(box).left, 10.0);
}

TEST(LensTest, RecordsEachPixelWhereOpenCvFindsItsRay) {
  CameraParams params;
  params.width = 200;
  params.height = 120;
  params.focal_px = 150;
  params.k1 = -0.25;
  params.k2 = 0.06;
  const Lens lens(params);
  const StereoCamera &ideal = lens.ideal(), &drawn = lens.drawn();
  cv::Mat places(drawn.height, drawn.width, CV_32FC2);  // each pixel says where it is
  for (int v = 0; v < drawn.height; ++v) {
    for (int u = 0; u < drawn.width; ++u) {
      places.at<cv::Vec2f>(v, u) = {static_cast<float>(u), static_cast<float>(v)};
    }
  }
  const cv::Mat seen = lens.record(places, true);
  const cv::Matx33d k(ideal.fx, 0, ideal.cx, 0, ideal.fy, ideal.cy, 0, 0, 1);
  for (const cv::Point& pixel : {cv::Point(0, 0), cv::Point(199, 119), cv::Point(50, 100)}) {
    std::vector<cv::Point2d> ray;
    cv::undistortPoints(
        std::vector<cv::Point2d>{cv::Point2d(pixel)}, ray, k, cv::Vec4d(params.k1, params.k2, 0, 0),
        cv::noArray(), cv::noArray(),
        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-12));
    const auto place = seen.at<cv::Vec2f>(pixel);
    EXPECT_NEAR(place[0], drawn.cx + drawn.fx * ray[0].x, 0.05);
    EXPECT_NEAR(place[1], drawn.cy + drawn.fy * ray[0].y, 0.05);
  }
}

TEST(LensTest, DrawsWithTheTrueRigAndRecordsTheNominalOne) {
  CalibrationErrorParams error;
  error.focal_ratio = 0.01;
  error.baseline_ratio = -0.02;
  error.right_pitch_deg = 1.0;
  const CameraParams nominal;
  const Lens lens(nominal, error);
  EXPECT_DOUBLE_EQ(lens.ideal().fx, nominal.focal_px);
  EXPECT_DOUBLE_EQ(lens.recorded().left.fx, nominal.focal_px);
  EXPECT_DOUBLE_EQ(lens.recorded().T_left_right.translation().x(), nominal.baseline_m);
  EXPECT_DOUBLE_EQ(lens.drawn().fx, 1.01 * nominal.focal_px);
  EXPECT_DOUBLE_EQ(lens.T_left_right().translation().x(), 0.98 * nominal.baseline_m);
  const Eigen::Vector3d view = lens.T_left_right().linear().col(2);
  EXPECT_NEAR(view.y(), -std::sin(M_PI / 180.0), 1e-12);  // upwards
}

TEST(LensTest, RefusesADistortionThatFoldsTheImage) {
  CameraParams params;
  params.focal_px = 300;
  params.k1 = -0.5;
  try {
    const Lens lens(params);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("[camera] k1, k2"));
  }
}

}  // namespace
}  // namespace headway::sim
