// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "measurement_model.h"
#include "tracked_object.h"

namespace headway::objects {
namespace {

constexpr double kFocal_px = 500.0;
constexpr double kHeight_m = 1.6;

/// Image box of an upright object of 0.8 m by 1.6 m.
Box2d predictedBoxAt(const Eigen::Vector3d& centre) {
  const double u = kFocal_px * centre.x() / centre.z() + 320.0;
  const double v = kFocal_px * centre.y() / centre.z() + 240.0;
  const double half_width = 0.5 * kFocal_px * 0.8 / centre.z();
  const double half_height = 0.5 * kFocal_px * kHeight_m / centre.z();
  return {u - half_width, v - half_height, u + half_width, v + half_height};
}

TEST(PredictedBoxTest, IsTheProjectionAtTheNewPosition) {
  const Eigen::Vector3d from(1.0, 0.2, 8.0);
  for (const auto& to : {Eigen::Vector3d(1.0, 0.2, 8.0), {-2.0, 0.3, 5.0}, {0.0, -1.0, 20.0}}) {
    const auto box = predictedBox(predictedBoxAt(from), from, to, kHeight_m);
    ASSERT_TRUE(box);
    const Box2d expected = predictedBoxAt(to);
    EXPECT_NEAR(box->left, expected.left, 1e-9);
    EXPECT_NEAR(box->top, expected.top, 1e-9);
    EXPECT_NEAR(box->right, expected.right, 1e-9);
    EXPECT_NEAR(box->bottom, expected.bottom, 1e-9);
  }
}

TEST(PredictedBoxTest, IsNoneBehindTheCameraAndWithoutHeight) {
  const Eigen::Vector3d front(0.0, 0.0, 5.0), behind(0.0, 0.0, -5.0);
  EXPECT_FALSE(predictedBox(predictedBoxAt(front), front, behind, kHeight_m));
  EXPECT_FALSE(predictedBox(predictedBoxAt(front), behind, front, kHeight_m));
  EXPECT_FALSE(predictedBox(predictedBoxAt(front), front, front, 0.0));
}

TEST(FieldOfViewTest, CoversNothingBeforeTheFirstDetection) {
  FieldOfView view;
  EXPECT_FALSE(view.covers({1.0, 0.0, 5.0}));
  view.move(Pose::Identity());
  EXPECT_FALSE(view.covers({1.0, 0.0, 5.0}));
}

TEST(FieldOfViewTest, ReachesToTheLargestBearingOnBothSides) {
  FieldOfView view;
  view.move(Pose::Identity());
  view.widenTo({2.0, 0.0, 10.0});
  view.widenTo({-1.0, 0.0, 10.0});
  view.widenTo({9.0, 0.0, -10.0});
  EXPECT_TRUE(view.covers({0.9, 0.0, 5.0}));
  EXPECT_TRUE(view.covers({-3.9, 1.0, 20.0}));
  EXPECT_FALSE(view.covers({1.1, 0.0, 5.0}));
  EXPECT_FALSE(view.covers({0.0, 0.0, -5.0})) << "behind the sensor";
}

TEST(FieldOfViewTest, MovesWithTheSensorAndKeepsItsWidth) {
  FieldOfView view;
  view.move(Pose::Identity());
  view.widenTo({2.0, 0.0, 10.0});
  Pose T_map_sensor = Pose::Identity();
  T_map_sensor.linear() = expSo3({0.0, M_PI, 0.0});
  T_map_sensor.translation() << 1.0, 0.0, 0.0;
  view.move(T_map_sensor);
  EXPECT_TRUE(view.covers({1.0, 0.0, -10.0}));
  EXPECT_FALSE(view.covers({1.0, 0.0, 10.0}));
  EXPECT_NEAR(view.inSensor({1.0, 0.0, -10.0}).z(), 10.0, 1e-12);
}

}  // namespace
}  // namespace headway::objects
