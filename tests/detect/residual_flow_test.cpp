// SPDX-License-Identifier: BSD-3-Clause
#include "residual_flow.h"

#include <gtest/gtest.h>
#include <headway/core/statistics.h>
#include <headway/stereo/disparity.h>
#include <headway_test/painted_street.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "point_follower.h"
#include "upright_segments.h"

namespace headway::detect {
namespace {

using test::PaintedBox;
using test::PaintedStreet;

const Eigen::Vector3d kAcross(1.3, 0.0, 0.0);
const PaintedBox kWall{{0.0, 1.6, 9.3}, 7.0, 2.2, {0.0, 0.0, 0.0}, 31};
const PaintedBox kWalker{{-0.6, 1.6, 9.0}, 0.7, 1.7, kAcross, 32};
const PaintedBox kStander{{-0.6, 1.6, 9.0}, 0.7, 1.7, {0.0, 0.0, 0.0}, 32};

/// Two frames of a street, and how the image moved between them.
struct Look {
  PaintedStreet street;
  stereo::DisparityImage disparity;
  ResidualFlow flow;

  /// @param gain  by which the second pair is brighter
  explicit Look(std::vector<PaintedBox> boxes, double gain = 1.0) : street(std::move(boxes)) {
    CameraPath path(*street.camera(), 0.5);
    ResidualFlowMeter meter(*street.camera());
    for (int i = 0; i < 2; ++i) {
      StereoFrame frame = street.frame(i);
      if (i == 1) frame.left.convertTo(frame.left, CV_8U, gain);
      if (i == 1) frame.right.convertTo(frame.right, CV_8U, gain);
      disparity = stereo::denseDisparity(frame, {});
      path.advance(frame.time, street.T_map_robot(i) * street.camera()->T_robot_cam);
      flow = meter.measure(stereo::reducedImage(frame.left, disparity.reduce), disparity, path);
      EXPECT_EQ(flow.empty(), i == 0) << "the first frame has nothing to be compared with";
    }
  }

  /// Flows where a box is seen [px].
  [[nodiscard]] std::vector<double> flowsOn(const PaintedBox& box) const {
    const Eigen::Vector3d foot = street.placeInCamera(box, 1);
    const Eigen::Vector3d half(0.3 * box.width, 0.0, 0.0);
    const Eigen::Vector3d up(0.0, -0.8 * box.height, 0.0);
    const auto low = *project(foot + half + 0.3 * up, *street.camera());
    const auto high = *project(foot - half + up, *street.camera());
    std::vector<double> flows;
    for (int row = disparity.cellOf(high.y()); row < disparity.cellOf(low.y()); ++row) {
      for (int column = disparity.cellOf(high.x()); column < disparity.cellOf(low.x()); ++column) {
        const float residual = flow.columns.at<float>(row, column);
        if (!std::isnan(residual)) flows.push_back(residual);
      }
    }
    return flows;
  }

  /// Of all cells whose flow is known, how many seem to move.
  [[nodiscard]] double movingShare() const {
    int known = 0;
    int moving = 0;
    for (int i = 0; i < static_cast<int>(flow.columns.total()); ++i) {
      const float residual = flow.columns.at<float>(i / flow.columns.cols, i % flow.columns.cols);
      if (std::isnan(residual)) continue;
      ++known;
      const float sigma = flow.sigmas.at<float>(i / flow.columns.cols, i % flow.columns.cols);
      moving += std::abs(residual) > 4.0F * sigma ? 1 : 0;
    }
    EXPECT_GT(known, 1000);
    return moving / static_cast<double>(known);
  }

  [[nodiscard]] std::vector<UprightSegment> segments(const ResidualFlow& by) const {
    const auto ground = stereo::findGround(disparity, *street.camera(), std::nullopt);
    EXPECT_TRUE(ground);
    const auto standing = standingCells(disparity, *street.camera(), *ground, 30.0);
    return segmentsByFlow(disparity, by, *street.camera(), standing, {});
  }
};

/// The one whose middle lies within reach of a place; null if there is none.
const UprightSegment* bodyAt(const std::vector<UprightSegment>& segments,
                             const Eigen::Vector3d& foot, const StereoCamera& camera) {
  for (const auto& segment : segments) {
    const Eigen::Vector3d off = *triangulate(segment.uvd, camera) - foot;
    if (std::abs(off.x()) < 0.4 && std::abs(off.z()) < 0.6) return &segment;
  }
  return nullptr;
}

TEST(ResidualFlowTest, IsHowFarAWalkerWentBeforeAStillWall) {
  const Look look({kWall, kWalker});
  const auto flows = look.flowsOn(kWalker);
  ASSERT_GT(flows.size(), 40u);
  const double depth = look.street.placeInCamera(kWalker, 1).z();
  const double went = look.street.camera()->fx * 0.1 * kAcross.x() / depth;
  EXPECT_NEAR(median(flows), went, 0.4) << "smoothing takes a little off";
}

TEST(ResidualFlowTest, IsNothingWhereAllStands) {
  const Look look({kWall, kStander});
  EXPECT_NEAR(median(look.flowsOn(kStander)), 0.0, 0.3);
  EXPECT_LT(look.movingShare(), 0.03);
}

TEST(ResidualFlowTest, DoesNotTakeBrightnessForMotion) {
  EXPECT_LT(Look({kWall, kStander}, 0.75).movingShare(), 0.03);
  const Look look({kWall, kWalker}, 0.75);
  const double depth = look.street.placeInCamera(kWalker, 1).z();
  EXPECT_NEAR(median(look.flowsOn(kWalker)), 340.0 * 0.13 / depth, 0.4);
}

/// Cells of a wall within `reach` of something nearer by a half.
std::vector<cv::Point> besideNearer(const stereo::DisparityImage& disparity, int reach) {
  std::vector<cv::Point> cells;
  const cv::Mat& d = disparity.values;
  for (int row = 0; row < d.rows; ++row) {
    for (int column = reach; column + reach < d.cols; ++column) {
      const float own = d.at<float>(row, column);
      const float nearest =
          std::max(d.at<float>(row, column - reach), d.at<float>(row, column + reach));
      if (own > 0.0F && nearest > 1.5F * own) cells.emplace_back(column, row);
    }
  }
  return cells;
}

const PaintedBox kFarWall{{0.0, 1.6, 15.0}, 9.0, 2.6, {0.0, 0.0, 0.0}, 31};

TEST(ResidualFlowTest, IsUnknownBesideSomethingNearer) {
  const Look look({kFarWall, kWalker});
  const auto cells = besideNearer(look.disparity, 2);
  ASSERT_GT(cells.size(), 50u);
  for (const cv::Point& cell : cells) ASSERT_TRUE(std::isnan(look.flow.columns.at<float>(cell)));
  EXPECT_GT(look.flowsOn(kWalker).size(), 40u) << "on what is nearer it is known";
}

TEST(PointFollowerTest, FollowsNothingBesideSomethingNearer) {
  const PaintedStreet street({kFarWall, kWalker});
  CameraPath path(*street.camera(), 0.5);
  PointFollower follower(*street.camera(), {});
  stereo::DisparityImage disparity;
  for (int i = 0; i < 4; ++i) {
    const StereoFrame frame = street.frame(i);
    const stereo::FrameContext context(frame);
    disparity = context.disparity();
    const int number =
        path.advance(frame.time, street.T_map_robot(i) * street.camera()->T_robot_cam);
    follower.follow(context, disparity, path);
    follower.replenish(frame, disparity, std::nullopt, number);
  }
  const double of_walker = project(street.placeInCamera(kWalker, 3), *street.camera())->z();
  cv::Mat walker = disparity.values > 0.8 * of_walker;
  cv::dilate(walker, walker, cv::getStructuringElement(cv::MORPH_RECT, {7, 7}));
  int on_walker = 0, on_wall = 0, beside = 0;
  for (const PointTrack& point : follower.points()) {
    const Eigen::Vector3d& uvd = point.observations.back().uvd;
    const cv::Point cell(disparity.cellOf(uvd.x()), disparity.cellOf(uvd.y()));
    if (uvd.z() > 0.8 * of_walker) {
      ++on_walker;
    } else if (1.5 * uvd.z() < of_walker) {
      ++(walker.at<unsigned char>(cell) != 0 ? beside : on_wall);
    }
  }
  EXPECT_GT(on_walker, 10);
  EXPECT_GT(on_wall, 50);
  EXPECT_EQ(beside, 0);
}

/// A textured image on the disparity grid, and an object in front of it.
struct NearObject {
  StereoCamera camera = [] {
    StereoCamera robot;
    robot.width = 1280;
    robot.height = 720;
    robot.fx = robot.fy = 700.0;
    robot.cx = 639.5;
    robot.cy = 359.5;
    robot.baseline_m = 0.12;
    return robot;
  }();
  stereo::DisparityImage disparity;
  cv::Mat image;

  explicit NearObject(int column, float near_disparity) {
    cv::RNG random(7);
    image = cv::Mat(360, 640, CV_8U);
    random.fill(image, cv::RNG::UNIFORM, 60, 200);
    cv::Mat paint(200, 100, CV_8U);
    random.fill(paint, cv::RNG::UNIFORM, 60, 200);
    const cv::Rect place(column, 80, paint.cols, paint.rows);
    paint.copyTo(image(place));
    cv::GaussianBlur(image, image, {0, 0}, 3.0);
    disparity.reduce = 2;
    disparity.values = cv::Mat(image.size(), CV_32F, cv::Scalar(7.0F));
    disparity.values(place).setTo(near_disparity);
  }
};

/// Median flow of the object at a column [px].
double flowOfObject(const ResidualFlow& flow, int column) {
  std::vector<double> flows;
  for (int row = 100; row < 260; ++row) {
    for (int c = column + 20; c < column + 80; ++c) {
      const float residual = flow.columns.at<float>(row, c);
      if (!std::isnan(residual)) flows.push_back(residual);
    }
  }
  EXPECT_GT(flows.size(), 4000u);
  return median(flows);
}

TEST(ResidualFlowTest, OfNearWalkersExceedsTheSearchRangeOfTheGrid) {
  constexpr int kBefore = 250, kNow = 274;  // 1.44 m/s at 1.4 m [cells]
  const NearObject before(kBefore, 60.0F), now(kNow, 60.0F);
  CameraPath path(now.camera, 0.5);
  ResidualFlowMeter meter(now.camera);
  path.advance(0.0, Pose::Identity());
  EXPECT_TRUE(meter.measure(before.image, before.disparity, path).empty());
  path.advance(1.0 / 15.0, Pose::Identity());
  const ResidualFlow flow = meter.measure(now.image, now.disparity, path);
  EXPECT_NEAR(flowOfObject(flow, kNow), 2.0 * (kNow - kBefore), 2.0);
}

TEST(ResidualFlowTest, IsMeasuredOverTheSameTimeAtAHigherRate) {
  const NearObject before(250, 60.0F), between(262, 60.0F), now(274, 60.0F);
  CameraPath path(now.camera, 0.5);
  ResidualFlowMeter meter(now.camera);
  path.advance(0.0, Pose::Identity());
  EXPECT_TRUE(meter.measure(before.image, before.disparity, path).empty());
  path.advance(1.0 / 30.0, Pose::Identity());
  EXPECT_TRUE(meter.measure(between.image, between.disparity, path).empty());
  path.advance(2.0 / 30.0, Pose::Identity());
  const ResidualFlow flow = meter.measure(now.image, now.disparity, path);
  ASSERT_FALSE(flow.empty());
  EXPECT_NEAR(flow.seconds, 2.0 / 30.0, 1e-9);
  EXPECT_NEAR(flowOfObject(flow, 274), 2.0 * 24.0, 2.0);
}

TEST(SegmentsByResidualFlowTest, CutsOutAWalkerCloseToAWall) {
  const Look look({kWall, kWalker});
  const Eigen::Vector3d foot = look.street.placeInCamera(kWalker, 1);
  EXPECT_FALSE(bodyAt(look.segments({}), foot, *look.street.camera())) << "by disparities alone";
  const auto segments = look.segments(look.flow);
  const UprightSegment* walker = bodyAt(segments, foot, *look.street.camera());
  ASSERT_TRUE(walker);
  ASSERT_TRUE(walker->across);
  EXPECT_NEAR(walker->across->speed, kAcross.x(), 0.15);
  EXPECT_LT(walker->across->sigma, 0.15);
}

TEST(SegmentsByResidualFlowTest, CutsNothingOutOfWhatStands) {
  const Look look({kWall, kStander});
  for (const auto& segment : look.segments(look.flow)) {
    if (!segment.across) continue;
    EXPECT_LT(std::abs(segment.across->speed), 3.0 * segment.across->sigma);
  }
}

}  // namespace
}  // namespace headway::detect
