// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/random.h>
#include <headway/eval/plots.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

namespace headway::eval {
namespace {

constexpr double kVoxel = 0.25;
constexpr double kWall = 5.1;  // depth of a wall that fills the image [m]
constexpr double kReach = 8.0;
constexpr double kSigmaPerSquare = 0.4 / 20.0;

StereoCamera camera() {
  StereoCamera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 80.0;
  camera.cx = 80.0;
  camera.cy = 60.0;
  camera.baseline_m = 0.5;
  return camera;
}

TrueDepths wall() {
  return {
      cv::Mat(120, 160, CV_32F, cv::Scalar(kWall)), cv::Mat(120, 160, CV_8U, cv::Scalar(0)), {}};
}

std::vector<TrueSurface::Patch> patchesOf(const TrueDepths& depths, int frames = 3,
                                          double to_m = kReach) {
  TrueSurface surface(camera(), kVoxel, 1.0, to_m);
  for (int i = 0; i < frames; ++i) surface.add(depths, Pose::Identity());
  return surface.patches();
}

/// Points of a grid of half a voxel on the wall, with y from `from_y`, moved by `offset`.
std::vector<Eigen::Vector3d> pointsOnWall(double from_y, double offset) {
  std::vector<Eigen::Vector3d> points;
  for (double y = from_y; y < 5.0; y += 0.5 * kVoxel) {
    for (double z = -3.7; z < 3.7; z += 0.5 * kVoxel) points.emplace_back(kWall + offset, y, z);
  }
  return points;
}

DenseError errorOf(const std::vector<Eigen::Vector3d>& points,
                   const std::vector<ObjectBox>& objects = {}, const TrueDepths& depths = wall()) {
  return denseError(patchesOf(depths), kVoxel, kReach, kSigmaPerSquare, points, objects);
}

TEST(TrueSurfaceTest, MeasuresTheDistanceToAPlaneWhereverItsPixelsAre) {
  const auto patches = patchesOf(wall());
  const PatchIndex index(patches, kVoxel);
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double offset = 0.6 * (random.uniform() - 0.5);
    const Eigen::Vector3d point(kWall + offset, 8.0 * (random.uniform() - 0.5),
                                6.0 * (random.uniform() - 0.5));
    const auto nearest = index.nearest(point, 5);
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(std::abs(offset), nearest->distance_m, 0.02);
    EXPECT_FLOAT_EQ(5.1F, nearest->patch->nearest_m);
  }
  EXPECT_FALSE(index.nearest({2.0, 0.0, 0.0}, 5));
}

TEST(TrueSurfaceTest, CountsFramesInWhichBothCamerasSeeAPatchWithinReach) {
  const double hidden_m = camera().baseline_m;  // wide, at the left edge of the image
  for (const auto& patch : patchesOf(wall(), 4)) {
    const double to_left_edge = kWall - patch.centre.y();
    const bool is_hidden = to_left_edge < hidden_m;
    if (std::abs(to_left_edge - hidden_m) < kVoxel) continue;
    EXPECT_EQ(is_hidden ? 0U : 4U, patch.frames);
  }
  for (const auto& patch : patchesOf(wall(), 4, 5.0)) EXPECT_EQ(0U, patch.frames);
  EXPECT_TRUE(patchesOf(wall(), 4, 3.0).empty()) << "1.5 times the reach is less than the depth";
}

TEST(TrueSurfaceTest, LeavesOutWhatMayMove) {
  TrueDepths depths = wall();
  depths.moving.colRange(0, 80).setTo(255);  // y > 0
  const auto patches = patchesOf(depths);
  ASSERT_FALSE(patches.empty());
  for (const auto& patch : patches) EXPECT_LT(patch.position().y(), 0.01);
}

TEST(TrueSurfaceTest, RefusesImagesOfAnotherSize) {
  TrueSurface surface(camera(), kVoxel, 1.0, kReach);
  TrueDepths depths = wall();
  depths.moving = cv::Mat(60, 80, CV_8U, cv::Scalar(0));
  EXPECT_THROW(surface.add(depths, Pose::Identity()), std::invalid_argument);
}

TEST(TrueSurfaceTest, VoxelsHaveNeighboursOnAllSides) {
  const Eigen::Vector3d at(-0.1, 3.3, 0.05);
  const VoxelKey key = voxelOf(at, kVoxel);
  for (const int step : {-1, 1}) {
    EXPECT_EQ(voxelOf(at + kVoxel * step * Eigen::Vector3d::UnitX(), kVoxel),
              shifted(key, step, 0, 0));
    EXPECT_EQ(voxelOf(at + kVoxel * step * Eigen::Vector3d::UnitY(), kVoxel),
              shifted(key, 0, step, 0));
    EXPECT_EQ(voxelOf(at + kVoxel * step * Eigen::Vector3d::UnitZ(), kVoxel),
              shifted(key, 0, 0, step));
  }
}

TEST(DenseErrorTest, MedianAndBarOfPointsBesideAWall) {
  const auto near = errorOf(pointsOnWall(-4.0, 0.07));
  EXPECT_NEAR(0.07, near.median_m, 0.01);
  const double bar = 0.5 * kSigmaPerSquare * kWall * kWall;  // more than half a voxel
  EXPECT_NEAR(bar, near.median_bar_m, 1e-4);
  EXPECT_GT(near.withinBarRatio(), 0.98);
  EXPECT_EQ(near.points, near.compared);
  EXPECT_LT(errorOf(pointsOnWall(-4.0, 0.35)).withinBarRatio(), 0.02);
}

TEST(DenseErrorTest, HalfOfTheWallIsCovered) {
  const auto error = errorOf(pointsOnWall(0.0, 0.05));
  // Seen by both cameras: y from -5.1 to 4.6 m; a point covers what is within a voxel.
  EXPECT_NEAR((4.6 + kVoxel) / 9.7, error.coverage.ratio().value(), 0.03);
  EXPECT_EQ(0U, error.coverage.matchable);
  EXPECT_EQ(error.coverage.surface, error.by_range[2].surface) << "from 4 to 6 m";
  EXPECT_EQ(0.0, errorOf({}).coverage.ratio());
  EXPECT_EQ(0.0, errorOf(pointsOnWall(-5.0, 1.1 * kVoxel)).coverage.ratio()) << "not near";
}

TEST(DenseErrorTest, SurfaceSeenInTwoFramesIsNotAskedFor) {
  const auto points = pointsOnWall(-5.0, 0.0);
  const auto error = denseError(patchesOf(wall(), 2), kVoxel, kReach, kSigmaPerSquare, points, {});
  EXPECT_EQ(0U, error.coverage.surface);
  EXPECT_EQ(std::nullopt, error.coverage.ratio());
  EXPECT_LT(error.median_m, 0.01) << "but it is surface";
}

TEST(DenseErrorTest, TellsHowMuchOfTheSurfaceStereoMatches) {
  TrueDepths depths = wall();
  depths.matched = cv::Mat(120, 160, CV_8U, cv::Scalar(0));
  depths.matched.rowRange(0, 60).setTo(255);  // z > 0
  const auto error = errorOf(pointsOnWall(0.0, 0.0), {}, depths);
  EXPECT_NEAR(0.5, error.coverage.matchableRatio().value(), 0.05);
  EXPECT_NEAR(error.coverage.ratio().value(), error.coverage.matchableCovered().value(), 0.02);
}

TEST(DenseErrorTest, PointsOfMoversAreThoseWithoutASurfaceInABoxOfWhatMoves) {
  const Eigen::Vector3d inside(3.0, 0.5, 0.2);
  ObjectBox box{{3.0, 0.0, 0.0}, {1.0, 2.0, 1.5}, 0.0, true};
  EXPECT_EQ(1U, errorOf({inside}, {box}).of_movers);
  EXPECT_EQ(1U, errorOf({inside}, {box}).astray);
  EXPECT_EQ((std::vector<std::uint32_t>{1}),
            errorOf({{kWall, 0.0, 0.0}, inside}, {box}).mover_points);
  EXPECT_EQ(0U, errorOf({inside}).of_movers);
  box.yaw = M_PI / 2.0;  // its length is along y now
  EXPECT_EQ(1U, errorOf({inside}, {box}).of_movers) << "within the margin";
  EXPECT_EQ(0U, errorOf({{3.0, 0.9, 0.2}}, {box}).of_movers);
  box.centre.x() = kWall;
  EXPECT_EQ(0U, errorOf({{kWall + 0.1, 0.0, 0.2}}, {box}).of_movers) << "the wall is there, too";
  box.centre.x() = 3.0;
  box.moves = false;
  const auto still = errorOf({inside}, {box});
  EXPECT_EQ(0U, still.of_movers);
  EXPECT_EQ(1U, still.on_still_objects);
  EXPECT_EQ(0U, still.compared);
}

TEST(DensePlotTest, DrawsTheSurfaceAboveTheLegend) {
  const auto patches = patchesOf(wall());
  const auto points = pointsOnWall(0.0, 0.0);
  const auto error = denseError(patches, kVoxel, kReach, kSigmaPerSquare, points, {});
  const cv::Mat plot = densePlot(patches, points, error);
  EXPECT_GE(plot.cols, 900);
  cv::Mat covered, missing;
  cv::inRange(plot, cv::Scalar(110, 150, 60), cv::Scalar(110, 150, 60), covered);
  cv::inRange(plot, cv::Scalar(40, 90, 230), cv::Scalar(40, 90, 230), missing);
  EXPECT_GT(cv::countNonZero(covered), 600);
  EXPECT_GT(cv::countNonZero(missing), 600);
}

}  // namespace
}  // namespace headway::eval
