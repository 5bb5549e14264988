// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/detect/ground_scanner.h>
#include <headway_test/input_error.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace headway::detect {
namespace {

constexpr double kHeight = 1.6;  // of the camera [m]

/// Independent of what the test camera, whose disparities have no noise, is capable of.
GroundScanParams withReach(double reach_m) {
  GroundScanParams params;
  params.reach_m = reach_m;
  return params;
}

StereoCamera testCamera(double height = kHeight) {
  StereoCamera camera;
  camera.width = 620;
  camera.height = 240;
  camera.fx = camera.fy = 360.0;
  camera.cx = 309.5;
  camera.cy = 100.0;
  camera.baseline_m = 0.54;
  camera.T_robot_cam = Eigen::Translation3d(0.0, 0.0, height) * robotFromOptical();
  return camera;
}

/// An image on the disparity grid whose columns differ from each other, or repeat after a period.
cv::Mat pictureOf(const stereo::DisparityImage& disparity, int period = 0) {
  std::mt19937 random(1);
  std::vector<unsigned char> greys(static_cast<std::size_t>(disparity.values.cols));
  for (auto& grey : greys) grey = static_cast<unsigned char>(random() % 200);
  cv::Mat image(disparity.values.size(), CV_8U);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const int at = period > 0 ? column % period : column;
      image.at<unsigned char>(row, column) = greys[static_cast<std::size_t>(at)];
    }
  }
  return image;
}

/// Something upright across the way, over a part of its width (x to the right) and height [m].
struct Plate {
  double depth;
  double left;
  double right;
  double bottom;
  double top;
};

/// What the camera, pitched down by an angle, sees of level ground and plates on it.
stereo::DisparityImage imageOf(const std::vector<Plate>& plates, double pitch = 0.0,
                               const std::function<double(double)>& ground = {},
                               double camera_height = kHeight) {
  const StereoCamera camera = testCamera();
  stereo::DisparityImage image;
  image.reduce = 2;
  image.values = cv::Mat(camera.height / 2, camera.width / 2, CV_32F, cv::Scalar(0));
  for (int row = 0; row < image.values.rows; ++row) {
    const double y = (image.pixelOf(row) - camera.cy) / camera.fy;
    // Direction in the level frame: forward, right, down.
    const double down = y * std::cos(pitch) + std::sin(pitch);
    const double forward = std::cos(pitch) - y * std::sin(pitch);
    for (int column = 0; column < image.values.cols; ++column) {
      const double right = (image.pixelOf(column) - camera.cx) / camera.fx;
      double nearest = down > 0.0 ? camera_height / down : std::numeric_limits<double>::infinity();
      if (ground) {
        for (double z = 1.0; z < 30.0; z += 0.05) {
          if (camera_height - down / forward * z <= ground(z)) {
            nearest = z / forward;
            break;
          }
        }
      }
      for (const auto& plate : plates) {
        const double z = plate.depth / forward;
        const double height = camera_height - down * z;
        if (right * z < plate.left || right * z > plate.right) continue;
        if (height >= plate.bottom && height <= plate.top) nearest = std::min(nearest, z);
      }
      if (nearest > 60.0) continue;
      image.values.at<float>(row, column) =
          static_cast<float>(camera.fx * camera.baseline_m / nearest);
    }
  }
  return image;
}

GroundScan scanOf(const stereo::DisparityImage& image, const MovingRegions& moving = {},
                  const GroundScanParams& params = withReach(20.0)) {
  const auto camera = testCamera();
  const auto ground = stereo::findGround(image, camera, std::nullopt);
  EXPECT_TRUE(ground);
  return ground ? scanGround(image, pictureOf(image), camera, *ground, moving, params)
                : GroundScan{};
}

/// Whether a place lies on a free piece of a ray [m].
bool isFree(const GroundScan& scan, double x, double y) {
  for (const auto& piece : scan.free) {
    const Eigen::Vector2d from = piece.from.cast<double>().head<2>();
    const Eigen::Vector2d along = piece.to.cast<double>().head<2>() - from;
    const Eigen::Vector2d to_place = Eigen::Vector2d(x, y) - from;
    const double share = along.dot(to_place) / std::max(1e-9, along.squaredNorm());
    if (share >= 0.0 && share <= 1.0 && (to_place - share * along).norm() < 0.06) return true;
  }
  return false;
}

int obstaclesBetween(const GroundScan& scan, double from, double to) {
  int count = 0;
  for (const auto& obstacle : scan.obstacles) {
    if (obstacle.foot.x() > from && obstacle.foot.x() < to) ++count;
  }
  return count;
}

TEST(ScanGroundTest, LevelGroundIsFreeAsFarAsItReaches) {
  const auto scan = scanOf(imageOf({}));
  EXPECT_TRUE(scan.obstacles.empty());
  EXPECT_TRUE(isFree(scan, 6.0, 0.0));
  EXPECT_TRUE(isFree(scan, 15.0, 3.0));
  EXPECT_FALSE(isFree(scan, 21.0, 0.0)) << "beyond the reach";
  EXPECT_FALSE(isFree(scan, 2.0, 0.0)) << "below the image, unobserved";
}

TEST(ScanGroundTest, TheNearestUprightThingEndsTheRay) {
  const auto scan = scanOf(imageOf({{9.0, -1.0, 1.0, 0.0, 1.5}, {14.0, -8.0, 8.0, 0.0, 3.0}}));
  EXPECT_TRUE(isFree(scan, 8.0, 0.0));
  EXPECT_FALSE(isFree(scan, 9.5, 0.0)) << "behind it";
  EXPECT_TRUE(isFree(scan, 11.0, 4.0)) << "beside it";
  EXPECT_GT(obstaclesBetween(scan, 8.8, 9.2), 30);
  EXPECT_GT(obstaclesBetween(scan, 13.6, 14.4), 100);
  EXPECT_EQ(obstaclesBetween(scan, 0.0, 20.0), static_cast<int>(scan.obstacles.size()));
  for (const auto& obstacle : scan.obstacles) {
    EXPECT_NEAR(obstacle.foot.z(), 0.0, 0.05);
    EXPECT_TRUE(obstacle.foot.x() > 10.0f || std::abs(obstacle.foot.y()) < 1.1f);
    EXPECT_GT(obstacle.sigma_m, 0.0f);
  }
}

TEST(ScanGroundTest, IsTheSameForACameraThatPitches) {
  for (const double pitch : {-0.05, 0.06}) {
    const auto scan = scanOf(imageOf({{9.0, -1.0, 1.0, 0.0, 1.5}}, pitch));
    EXPECT_GT(obstaclesBetween(scan, 8.5, 9.5), 30) << pitch;
    EXPECT_EQ(obstaclesBetween(scan, 8.5, 9.5), static_cast<int>(scan.obstacles.size())) << pitch;
  }
}

TEST(ScanGroundTest, NeitherKerbsNorBridgesStop) {
  const auto scan = scanOf(imageOf({{8.0, -3.0, 3.0, 0.0, 0.15}, {12.0, -9.0, 9.0, 2.5, 4.0}}));
  EXPECT_TRUE(scan.obstacles.empty());
  EXPECT_TRUE(isFree(scan, 13.0, 0.0)) << "under the bridge";
}

TEST(ScanGroundTest, ARampIsNoWall) {
  const auto ramp = [](double z) { return z < 8.0 ? 0.0 : 0.09 * (z - 8.0); };
  const auto scan = scanOf(imageOf({}, 0.0, ramp));
  EXPECT_TRUE(scan.obstacles.empty());
  const auto step = [](double z) { return z < 8.0 ? 0.0 : 0.5; };
  EXPECT_GT(obstaclesBetween(scanOf(imageOf({}, 0.0, step)), 7.8, 8.3), 100);
}

TEST(ScanGroundTest, ATableIsAnObstacleThoughNothingStands) {
  std::vector<Plate> top;
  for (double depth = 5.0; depth < 5.8; depth += 0.02) top.push_back({depth, -1.0, 1.0, 0.7, 0.72});
  const auto scan = scanOf(imageOf(top));
  EXPECT_GT(obstaclesBetween(scan, 4.9, 5.9), 50);
  EXPECT_FALSE(isFree(scan, 5.4, 0.0));
  EXPECT_TRUE(isFree(scan, 5.4, 2.0)) << "beside it";
}

TEST(ScanGroundTest, WhatIsAsHighAsAnObstacleIsOneBehindAnObstacle) {
  const auto kerb = [](double z) { return z < 8.0 ? 0.0 : 0.35; };
  const auto scan = scanOf(imageOf({}, 0.0, kerb));
  EXPECT_GT(obstaclesBetween(scan, 7.8, 8.3), 100);
  EXPECT_GT(obstaclesBetween(scan, 9.0, 12.0), 100);
  EXPECT_FALSE(isFree(scan, 10.0, 0.0));
}

/// The same as blocks of 14 px would match it.
stereo::DisparityImage matched(stereo::DisparityImage image) {
  image.block_px = 14;
  return image;
}

TEST(ScanGroundTest, WhatIsNarrowerThanAMatchedBlockIsAWrongMatch) {
  // 14 px at 8 m are 0.31 m.
  EXPECT_EQ(obstaclesBetween(scanOf(matched(imageOf({{8.0, -0.05, 0.05, 0.0, 1.0}}))), 7.0, 9.0),
            0);
  EXPECT_GT(obstaclesBetween(scanOf(matched(imageOf({{8.0, -0.2, 0.2, 0.0, 1.0}}))), 7.0, 9.0), 5);
  EXPECT_FALSE(isFree(scanOf(matched(imageOf({{8.0, -0.05, 0.05, 0.0, 1.0}}))), 8.2, 0.0))
      << "but not free ground";
}

TEST(ScanGroundTest, WhatHangsInTheAirIsAsWideAsAPerson) {
  // At 3 m, a block is 0.12 m wide.
  EXPECT_EQ(obstaclesBetween(scanOf(matched(imageOf({{3.0, -0.05, 0.05, 0.5, 1.5}}))), 2.5, 3.5),
            0);
  EXPECT_GT(obstaclesBetween(scanOf(matched(imageOf({{3.0, -0.2, 0.2, 0.5, 1.5}}))), 2.5, 3.5), 10);
  EXPECT_GT(obstaclesBetween(scanOf(matched(imageOf({{3.0, -0.07, 0.07, 0.0, 1.5}}))), 2.5, 3.5), 3)
      << "a post";
}

TEST(ScanGroundTest, WhatGroundIsSeenUnderIsAsWideAsASeat) {
  const auto nearIn = [](const stereo::DisparityImage& image) {
    return obstaclesBetween(scanOf(matched(image)), 2.5, 3.5);
  };
  // Some bricks of a wall, matched a few bricks off.
  auto narrow = imageOf({{3.0, -0.08, 0.08, 0.5, 1.0}, {8.0, -8.0, 8.0, 0.0, 3.0}});
  EXPECT_EQ(nearIn(narrow), 0);
  EXPECT_GT(nearIn(imageOf({{3.0, -0.2, 0.2, 0.5, 1.0}, {8.0, -8.0, 8.0, 0.0, 3.0}})), 10);
  const double nearest = testCamera().fx * testCamera().baseline_m / 3.0;
  for (int column = 0; column < narrow.values.cols; ++column) {  // legs without texture
    int foot = narrow.values.rows;
    for (int row = 0; row < narrow.values.rows; ++row) {
      float& d = narrow.values.at<float>(row, column);
      if (std::abs(static_cast<double>(d) - nearest) < 1e-3) foot = row;
      if (row > foot) d = 0.0F;
    }
  }
  EXPECT_GT(nearIn(narrow), 2) << "it may stand";
}

TEST(ScanGroundTest, StripesThatHangBeforeTheirWallAreMatchedAPeriodOff) {
  const auto camera = testCamera();
  auto hanging = imageOf({{8.0, -1.0, 1.0, 0.6, 1.6}, {14.0, -8.0, 8.0, 0.0, 3.0}});
  auto standing = imageOf({{8.0, -1.0, 1.0, 0.0, 1.6}, {14.0, -8.0, 8.0, 0.0, 3.0}});
  hanging.block_px = standing.block_px = 18;
  const auto ground = stereo::findGround(hanging, camera, std::nullopt);
  ASSERT_TRUE(ground);
  const auto nearIn = [&](const stereo::DisparityImage& image, int period) {
    const auto scan =
        scanGround(image, pictureOf(image, period), camera, *ground, {}, withReach(20.0));
    EXPECT_FALSE(isFree(scan, 8.5, 0.0)) << "whatever it is";
    EXPECT_GT(obstaclesBetween(scan, 13.0, 15.0), 50) << "the wall itself";
    return obstaclesBetween(scan, 7.8, 8.2);
  };
  EXPECT_GT(nearIn(hanging, 0), 30);
  EXPECT_EQ(nearIn(hanging, 7), 0);
  EXPECT_GT(nearIn(standing, 7), 30) << "what stands hides the ground behind it";
}

TEST(ScanGroundTest, TheUpperEdgeOfABlockIsNoHeight) {
  // At 6 m, half a block is 0.12 m: what seems 0.35 m high may be 0.23 m.
  const auto low = scanOf(matched(imageOf({{6.0, -1.0, 1.0, 0.0, 0.35}})));
  EXPECT_EQ(obstaclesBetween(low, 5.5, 6.5), 0);
  EXPECT_FALSE(isFree(low, 6.2, 0.0)) << "nor is it free ground";
  EXPECT_GT(obstaclesBetween(scanOf(imageOf({{6.0, -1.0, 1.0, 0.0, 0.35}})), 5.5, 6.5), 30);
  EXPECT_GT(obstaclesBetween(scanOf(matched(imageOf({{6.0, -1.0, 1.0, 0.0, 0.5}}))), 5.5, 6.5), 30);
}

TEST(ScanGroundTest, TheDistanceOfAnObstacleIsTheMiddleOfItsNoise) {
  stereo::DisparityImage image = matched(imageOf({{6.0, -1.0, 1.0, 0.0, 1.5}}));
  cv::RNG random(1);
  for (auto& d : cv::Mat_<float>(image.values)) d += static_cast<float>(random.gaussian(0.25));
  const auto scan = scanOf(image);
  const double sigma = 0.4 * 36.0 / (360.0 * 0.54);
  int near = 0, all = 0;
  for (const auto& obstacle : scan.obstacles) {
    if (std::abs(obstacle.foot.y()) > 0.9 || obstacle.foot.x() > 7.0F) continue;
    ++all;
    near += std::abs(obstacle.foot.x() - 6.0) < sigma ? 1 : 0;
  }
  EXPECT_GT(all, 40);
  EXPECT_GT(near, 0.95 * all);
}

TEST(ScanGroundTest, ADropEndsFreeGround) {
  const auto pit = [](double z) { return z < 8.0 || z > 12.0 ? 0.0 : -1.0; };
  const auto scan = scanOf(imageOf({}, 0.0, pit));
  EXPECT_TRUE(isFree(scan, 7.5, 0.0));
  for (double x = 8.2; x < 20.0; x += 0.5) EXPECT_FALSE(isFree(scan, x, 0.0)) << x;
  const auto slope = [](double z) { return z < 8.0 ? 0.0 : -0.08 * (z - 8.0); };
  EXPECT_TRUE(isFree(scanOf(imageOf({}, 0.0, slope)), 9.0, 0.0)) << "a ramp down is no drop";
}

constexpr double kRobotHeight = 0.5;  // of the camera [m]

/// Scan of an image from a camera at a height above known ground.
GroundScan scanFrom(double height, const stereo::DisparityImage& image,
                    double sigma_disparity_px = 0.4, double min_obstacle_height_m = 0.12) {
  const auto camera = testCamera(height);
  const auto ground =
      stereo::groundPlane(stereo::rigCapability(camera), stereo::mountedUp(camera), height);
  GroundScanParams params = withReach(6.0);
  params.min_obstacle_height_m = min_obstacle_height_m;
  params.sigma_disparity_px = sigma_disparity_px;
  (void)params.capabilityOf(camera);
  return scanGround(image, pictureOf(image), camera, ground, {}, params);
}

/// What a robot's camera scans on level ground; rows between two depths are not matched.
GroundScan robotScan(double unmatched_from, double unmatched_to, double sigma_disparity_px = 0.4) {
  const auto camera = testCamera(kRobotHeight);
  auto image = imageOf({}, 0.0, {}, kRobotHeight);
  const auto rowAt = [&](double depth) {
    return image.cellOf(camera.cy + camera.fy * kRobotHeight / depth);
  };
  if (unmatched_to > 0.0) {
    image.values.rowRange(rowAt(unmatched_to), rowAt(unmatched_from)).setTo(0.0F);
  }
  return scanFrom(kRobotHeight, image, sigma_disparity_px);
}

TEST(ScanGroundTest, ARobotDoesNotTakeTheFarRimOfAGapForGroundInTheGap) {
  const auto whole = robotScan(0.0, 0.0);
  EXPECT_TRUE(isFree(whole, 2.0, 0.0));
  EXPECT_TRUE(isFree(whole, 3.5, 0.0));
  const auto gap = robotScan(1.8, 4.0);
  EXPECT_TRUE(isFree(gap, 1.5, 0.0));
  for (double x = 2.0; x < 3.9; x += 0.1) EXPECT_FALSE(isFree(gap, x, 0.0)) << x;
  EXPECT_TRUE(isFree(gap, 4.5, 0.0)) << "matched again";
}

TEST(ScanGroundTest, TheFarRimOfAGapFreesNothingBeforeItWhereDisparitiesAreNoisy) {
  const auto gap = robotScan(1.8, 4.0, 2.0);
  EXPECT_TRUE(isFree(gap, 1.5, 0.0));
  for (double x = 2.0; x < 4.2; x += 0.1) EXPECT_FALSE(isFree(gap, x, 0.0)) << x;
}

TEST(ScanGroundTest, ADropIsAnObstacleToARobotButNotToACar) {
  const auto pit = [](double z) { return z < 2.5 || z > 6.0 ? 0.0 : -1.0; };
  const auto scan = scanFrom(kRobotHeight, imageOf({}, 0.0, pit, kRobotHeight));
  EXPECT_TRUE(isFree(scan, 2.0, 0.0));
  EXPECT_GT(obstaclesBetween(scan, 2.3, 3.1), 100);
  for (double x = 2.5; x < 6.0; x += 0.1) EXPECT_FALSE(isFree(scan, x, 0.0)) << x;
  EXPECT_TRUE(scanFrom(kHeight, imageOf({}, 0.0, pit)).obstacles.empty());
}

TEST(ScanGroundTest, LowObstaclesAreFoundWhereAskedForOrRefused) {
  const auto image = imageOf({{2.0, -0.5, 0.5, 0.0, 0.08}}, 0.0, {}, kRobotHeight);
  EXPECT_TRUE(scanFrom(kRobotHeight, image).obstacles.empty()) << "a robot drives over 8 cm";
  EXPECT_GT(obstaclesBetween(scanFrom(kRobotHeight, image, 0.4, 0.07), 1.9, 2.1), 30);
  EXPECT_GT(obstaclesBetween(scanFrom(kRobotHeight, image, 0.4, 0.06), 1.9, 2.1), 30);
  const auto kerb = imageOf({{5.0, -1.0, 1.0, 0.0, 0.13}});
  EXPECT_TRUE(scanFrom(kHeight, kerb, 0.4, 0.3).obstacles.empty()) << "a car drives over a kerb";
  EXPECT_GT(obstaclesBetween(scanFrom(kHeight, kerb, 0.4, 0.12), 4.9, 5.1), 30);
  for (const double height : {0.001, 0.03, 0.05}) {
    EXPECT_THAT(test::inputErrorOf([&] { (void)scanFrom(kRobotHeight, image, 0.4, height); }),
                testing::AllOf(testing::HasSubstr("[grid] min_obstacle_height_m"),
                               testing::HasSubstr("from 0.06 m on")))
        << height;
  }
}

TEST(ScanGroundTest, AKerbIsAnObstacleWhereItStandsOutFromTheGround) {
  const auto kerbAt = [](double depth) {
    return imageOf({{depth, -0.5, 0.5, 0.0, 0.1}}, 0.0, {}, kRobotHeight);
  };
  const auto near = scanFrom(kRobotHeight, kerbAt(2.0), 0.4, 0.0);
  EXPECT_GT(obstaclesBetween(near, 1.9, 2.1), 30);
  EXPECT_FALSE(isFree(near, 2.2, 0.0));
  EXPECT_TRUE(scanFrom(kRobotHeight, kerbAt(4.3), 0.4, 0.0).obstacles.empty()) << "too far";
  EXPECT_TRUE(scanFrom(kRobotHeight, kerbAt(2.0), 0.4, 0.12).obstacles.empty())
      << "who states a height means it";
}

TEST(ScanGroundTest, ACameraThatLooksStraightDownScansNothing) {
  stereo::GroundPlane ground;
  ground.up = -Eigen::Vector3d::UnitZ();
  ground.camera_height = kHeight;
  const auto image = imageOf({});
  const auto scan = scanGround(image, pictureOf(image), testCamera(), ground, {}, withReach(20.0));
  EXPECT_TRUE(scan.empty());
}

TEST(ScanGroundTest, NothingIsFreedWhereALongGapWithoutTextureMayHideSomething) {
  stereo::DisparityImage image = imageOf({});
  const auto camera = testCamera();
  const auto rowAt = [&](double depth) {
    return image.cellOf(camera.cy + camera.fy * kHeight / depth);
  };
  image.values.rowRange(rowAt(9.0), rowAt(7.0)).setTo(0.0F);
  EXPECT_TRUE(isFree(scanOf(image), 8.0, 0.0)) << "a short gap";
  image.values.rowRange(rowAt(15.5), rowAt(7.0)).setTo(0.0F);
  const auto scan = scanOf(image);
  EXPECT_TRUE(isFree(scan, 6.5, 0.0));
  EXPECT_FALSE(isFree(scan, 10.0, 0.0));
  EXPECT_TRUE(isFree(scan, 16.0, 0.0)) << "seen again";
}

TEST(ScanGroundTest, LeavesOutWhatMovesAndMayMove) {
  const auto image = imageOf({{9.0, -1.0, 1.0, 0.0, 1.5}});
  const Box2d box{260, 90, 360, 170};
  MovingRegions moving;
  moving.boxes = {{box}};
  EXPECT_TRUE(scanOf(image, moving).obstacles.empty());
  EXPECT_FALSE(isFree(scanOf(image, moving), 9.5, 0.0)) << "what it hides is not free";
  moving.boxes.clear();
  moving.unsure = {{box}};
  EXPECT_TRUE(scanOf(image, moving).obstacles.empty());
  moving.unsure.clear();
  moving.mask = cv::Mat(240, 620, CV_8U, cv::Scalar(0));
  moving.mask(cv::Rect(260, 90, 100, 80)).setTo(255);
  EXPECT_TRUE(scanOf(image, moving).obstacles.empty());
  moving.mask.release();
  moving.boxes = {{-1e6, -1e6, -10, -10}, {700, 10, 900, 50}};
  EXPECT_GT(scanOf(image, moving).obstacles.size(), 30u) << "boxes beside the picture";
}

TEST(ScanGroundTest, LeavesOutWhatIsTooUncertain) {
  GroundScanParams params = withReach(20.0);
  params.max_error_m = 0.1;
  const auto scan = scanOf(imageOf({{14.0, -1.0, 1.0, 0.0, 1.5}}), {}, params);
  EXPECT_TRUE(scan.obstacles.empty());
  EXPECT_FALSE(isFree(scan, 15.0, 0.0)) << "it ends the ray all the same";
}

TEST(ScanGroundTest, TheReachIsThatOfTheRigUnlessItIsGiven) {
  const auto rig = GroundScanParams().capabilityOf(testCamera());
  EXPECT_EQ(rig.min_obstacle_height_m, 0.3);
  const auto scan = scanOf(imageOf({}), {}, {});
  EXPECT_TRUE(isFree(scan, 0.8 * rig.obstacles_to_m, 0.0));
  EXPECT_FALSE(isFree(scan, rig.obstacles_to_m + 0.1, 0.0));
  EXPECT_EQ(withReach(7.0).capabilityOf(testCamera()).obstacles_to_m, 7.0);
}

TEST(GroundScanParamsTest, AreDescribedWithRanges) {
  GroundScanParams values;
  Params params;
  values.describe(params.section("grid"));
  params.set("grid.reach=12");
  EXPECT_EQ(values.reach_m, 12.0);
  EXPECT_THROW(params.set("grid.min_obstacle_height_m=-0.1"), InputError);
}

TEST(GroundScanParamsTest, RefuseValuesOutOfRange) {
  GroundScanParams values;
  values.max_error_m = 0.0;
  EXPECT_EQ("[grid] max_error_m: '0' is out of range [m, 0.05 .. 10]",
            test::inputErrorOf([&] { values.validate(); }));
}

}  // namespace
}  // namespace headway::detect
