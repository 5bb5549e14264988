// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/detect/stereo_lifter.h>
#include <headway_test/folders.h>
#include <headway_test/kitti_stereo.h>
#include <headway_test/limits.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

std::shared_ptr<StereoCamera> sharedTestCamera() {
  auto camera = std::make_shared<StereoCamera>();
  camera->width = 620;
  camera->height = 240;
  camera->fx = camera->fy = 360.0;
  camera->cx = 309.5;
  camera->cy = 100.0;
  camera->baseline_m = 0.54;
  return camera;
}

double disparityAt(double depth, const StereoCamera& camera) {
  return camera.fx * camera.baseline_m / depth;
}

/// A disparity image with one depth everywhere, to paint boxes on.
stereo::DisparityImage wall(double depth, const StereoCamera& camera) {
  stereo::DisparityImage image;
  image.reduce = 2;
  image.values =
      cv::Mat(camera.height / 2, camera.width / 2, CV_32F, cv::Scalar(disparityAt(depth, camera)));
  return image;
}

void paint(stereo::DisparityImage& image, const Box2d& box, double disparity) {
  const cv::Point first(image.cellOf(box.left), image.cellOf(box.top));
  const cv::Point last(image.cellOf(box.right), image.cellOf(box.bottom));
  image.values(cv::Rect(first, last + cv::Point(1, 1))).setTo(disparity);
}

/// Image box of a car of usual size seen from behind.
Box2d carAt(double depth, const StereoCamera& camera) {
  const double half = 0.5 * 1.65 * camera.fx / depth;
  const double high = 1.52 * camera.fy / depth;
  return {300 - half, 90.0, 300 + half, 90.0 + high};
}

TEST(StereoLifterTest, BackgroundAroundAndBehindTheObjectDoesNotWin) {
  const auto camera = sharedTestCamera();
  const Box2d box = carAt(15.0, *camera);
  stereo::DisparityImage image = wall(40.0, *camera);
  // The car fills the lower half of its box; through windows and beside it the wall is seen.
  paint(image, {box.left, box.top + 0.5 * box.height(), box.right, box.bottom},
        disparityAt(15.0, *camera));
  const StereoLifter lifter(camera, image, std::nullopt);
  const auto surface = lifter.surfaceOf(box, ObjectClass::kCar);
  ASSERT_TRUE(surface);
  EXPECT_NEAR(surface->disparity, disparityAt(15.0, *camera), 0.05);
}

TEST(StereoLifterTest, AnOccluderDoesNotWin) {
  const auto camera = sharedTestCamera();
  const Box2d box = carAt(15.0, *camera);
  stereo::DisparityImage image = wall(40.0, *camera);
  paint(image, box, disparityAt(15.0, *camera));
  paint(image, {box.left, box.top, box.left + 0.45 * box.width(), box.bottom},
        disparityAt(6.0, *camera));
  const StereoLifter lifter(camera, image, std::nullopt);
  const auto surface = lifter.surfaceOf(box, ObjectClass::kCar);
  ASSERT_TRUE(surface);
  EXPECT_NEAR(surface->disparity, disparityAt(15.0, *camera), 0.05);
}

TEST(StereoLifterTest, ACarSeenFromBehindReachesAwayFromTheCamera) {
  const auto camera = sharedTestCamera();
  const Box2d box = carAt(12.0, *camera);
  stereo::DisparityImage image = wall(60.0, *camera);
  paint(image, box, disparityAt(12.0, *camera));
  const StereoLifter lifter(camera, image, std::nullopt);
  const auto lifted = lifter.lift(box, ObjectClass::kCar);
  ASSERT_TRUE(lifted);
  EXPECT_NEAR(lifted->box.centre.z(), 14.0, 0.4);
  EXPECT_GT(std::abs(frontOf(lifted->box).z()), 0.95);
  EXPECT_NEAR(lifted->box.height, 1.52, 0.05);
}

TEST(StereoLifterTest, WithoutStereoTheHeightGivesTheDepthLessAccurately) {
  const auto camera = sharedTestCamera();
  const Box2d box{300, 80, 315, 80 + 1.74 * 360.0 / 20.0};
  stereo::DisparityImage nothing = wall(10.0, *camera);
  nothing.values.setTo(0.0F);
  stereo::DisparityImage something = nothing;
  something.values = nothing.values.clone();
  paint(something, box, disparityAt(20.0, *camera));
  const auto blind =
      StereoLifter(camera, nothing, std::nullopt).lift(box, ObjectClass::kPedestrian);
  const auto seen =
      StereoLifter(camera, something, std::nullopt).lift(box, ObjectClass::kPedestrian);
  ASSERT_TRUE(blind);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(blind->box.centre.z(), 20.0, 1.0);
  EXPECT_GT(blind->centre_covariance(2, 2), 2.0 * seen->centre_covariance(2, 2));
  // A person has no heading that could leave the place open: the box's edges alone do.
  EXPECT_LT(seen->centre_covariance(0, 0), 0.3 * 0.3);
  EXPECT_GT(seen->centre_covariance(0, 0), 0.05 * 0.05);
}

TEST(StereoLifterTest, SaysNothingWhereNothingIsKnown) {
  const auto camera = sharedTestCamera();
  stereo::DisparityImage nothing = wall(10.0, *camera);
  nothing.values.setTo(0.0F);
  const StereoLifter lifter(camera, nothing, std::nullopt);
  EXPECT_FALSE(lifter.lift({100, 100, 140, 160}, ObjectClass::kUnknown));
  EXPECT_FALSE(lifter.lift({-80, 100, -40, 160}, ObjectClass::kCar)) << "outside of the image";
  EXPECT_FALSE(lifter.lift({NAN, 100, 140, 160}, ObjectClass::kCar));
}

TEST(StereoLifterTest, CovarianceGrowsWithDepthAndFarAwayIsLargestAlongTheRay) {
  const auto camera = sharedTestCamera();
  double before = 0.0;
  for (const double depth : {8.0, 16.0, 30.0}) {
    const Box2d box = carAt(depth, *camera);
    stereo::DisparityImage image = wall(60.0, *camera);
    paint(image, box, disparityAt(depth, *camera));
    const auto lifted = StereoLifter(camera, image, std::nullopt).lift(box, ObjectClass::kCar);
    ASSERT_TRUE(lifted);
    EXPECT_GT(lifted->centre_covariance(2, 2), before);
    // Near by, the headings that explain the box as well say more than stereo's error.
    if (depth > 10.0) {
      EXPECT_GT(lifted->centre_covariance(2, 2), lifted->centre_covariance(0, 0));
    }
    before = lifted->centre_covariance(2, 2);
  }
}

TEST(LiftAllTest, KeepsBoxesThatAreIn3dAlready) {
  const auto camera = sharedTestCamera();
  stereo::DisparityImage image = wall(20.0, *camera);
  const StereoLifter lifter(camera, image, std::nullopt);
  Detections detections;
  detections.items.resize(2);
  detections.items[0].box2d = carAt(20.0, *camera);
  detections.items[1] = detections.items[0];
  detections.items[0].object_class = detections.items[1].object_class = ObjectClass::kCar;
  detections.items[1].box3d = Box3d{{1, 2, 3}, 4, 5, 6, 0};
  liftAll(detections, lifter);
  EXPECT_TRUE(detections.items[0].box3d);
  EXPECT_EQ(detections.items[1].box3d->centre, Eigen::Vector3d(1, 2, 3));
}

TEST(StereoLifterTest, AgreesWithTheTrueDisparityOfRealCars) {
  HEADWAY_REQUIRE_DATA(data);
  std::vector<double> errors;
  for (const char* name : {"000002", "000003", "000007", "000008", "000009", "000010", "000011",
                           "000012", "000013", "000014", "000015", "000016"}) {
    const auto pair =
        test::readKittiStereo(data / "kitti_stereo_2015" / "training", std::string(name) + ".png");
    ASSERT_TRUE(pair.complete);
    const StereoLifter lifter(pair.frame, stereo::DisparityParams{});
    for (const auto& car : pair.cars) {
      const auto surface = lifter.surfaceOf(car.box, ObjectClass::kCar);
      errors.push_back(surface ? std::abs(car.median_disparity / surface->disparity - 1.0) : 1.0);
    }
  }
  ASSERT_GT(errors.size(), 20u);
  std::sort(errors.begin(), errors.end());
  test::expectWithin("median", errors[errors.size() / 2], test::kLiftedDisparityMedian);
  test::expectWithin("percentile_90", errors[errors.size() * 9 / 10],
                     test::kLiftedDisparity90Percent);
}

}  // namespace
}  // namespace headway::detect
