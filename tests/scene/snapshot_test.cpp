// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/class_colour.h>
#include <headway/map/track_geometry.h>
#include <headway/plot/colours.h>
#include <headway/scene/snapshot.h>

#include <cstdlib>

#include "canvas.h"
#include "example_street.h"
#include "view.h"

namespace headway::scene {
namespace {

cv::Mat drawn(const SnapshotInput& input, View view, int width = 640, int height = 360) {
  SnapshotOptions options;
  options.width = width;
  options.height = height;
  options.view = view;
  return SnapshotRenderer(options).draw(input);
}

/// Number of pixels that differ by at most 40 in each channel from a colour.
int pixelsLike(const cv::Mat& picture, Colour colour) {
  cv::Mat alike;
  cv::inRange(picture, plot::bgr(colour) - cv::Scalar::all(40),
              plot::bgr(colour) + cv::Scalar::all(40), alike);
  return cv::countNonZero(alike);
}

bool isLike(const cv::Mat& picture, const Eigen::Vector2d& at, Colour colour) {
  const cv::Rect around(int(std::lround(at.x())) - 1, int(std::lround(at.y())) - 1, 3, 3);
  return pixelsLike(picture(around), colour) > 0;
}

TEST(ViewFromTest, AcceptsTheFourViews) {
  EXPECT_EQ(viewFrom("follow"), View::kFollow);
  EXPECT_EQ(viewFrom("top"), View::kTop);
  EXPECT_EQ(viewFrom("orbit"), View::kOrbit);
  EXPECT_EQ(viewFrom("camera"), View::kCamera);
  EXPECT_EQ(viewFrom("Top"), std::nullopt);
  EXPECT_EQ(viewFrom(""), std::nullopt);
}

class EveryViewTest : public ::testing::TestWithParam<View> {};

TEST_P(EveryViewTest, HasTheRequestedSizeAndShowsTracksAndPredictions) {
  const auto map = streetMap();
  const cv::Mat picture = drawn(streetInput(map), GetParam(), 641, 363);
  ASSERT_EQ(picture.size(), cv::Size(641, 363));
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_GT(pixelsLike(picture, colourOf(ObjectClass::kCar)), 100);
  EXPECT_GT(pixelsLike(picture, colourOf(ObjectClass::kPedestrian)), 20);
  EXPECT_GT(pixelsLike(picture, kPredictionColour), 100);
}

TEST_P(EveryViewTest, DrawsAnEmptyMap) {
  const map::PerceptionMap map;
  const SnapshotInput input{map, 0, 0.0};
  EXPECT_EQ(drawn(input, GetParam()).size(), cv::Size(640, 360));
}

TEST_P(EveryViewTest, DrawsVerySmallPictures) {
  const auto map = streetMap();
  EXPECT_EQ(drawn(streetInput(map), GetParam(), 17, 9).size(), cv::Size(17, 9));
}

TEST_P(EveryViewTest, IsDeterministic) {
  const auto map = streetMap();
  const cv::Mat first = drawn(streetInput(map), GetParam());
  const cv::Mat second = drawn(streetInput(map), GetParam());
  EXPECT_EQ(cv::norm(first, second, cv::NORM_INF), 0.0);
}

TEST_P(EveryViewTest, ShowsTheTruthIfGiven) {
  const auto map = streetMap();
  auto input = streetInput(map);
  input.image = cv::Mat();
  const int without = pixelsLike(drawn(input, GetParam()), kTruthColour);
  input.true_objects = {streetTrack(1, ObjectClass::kCar, {8.0, -3.5}, 0.1, 1.0),
                        streetTrack(2, ObjectClass::kCar, {16.0, 3.5}, 0.1, 1.0)};
  EXPECT_GT(pixelsLike(drawn(input, GetParam()), kTruthColour), without + 50);
}

INSTANTIATE_TEST_SUITE_P(Views, EveryViewTest,
                         ::testing::Values(View::kFollow, View::kTop, View::kOrbit, View::kCamera));

TEST(SnapshotTest, DrawsABoxWhereItProjects) {
  map::PerceptionMap map;
  map.update(10.0, {streetTrack(3, ObjectClass::kCyclist, {12.0, 1.0}, 0.4, 0.0)});
  auto input = streetInput(map);
  input.image = cv::Mat();
  const SnapshotOptions options{640, 360, View::kFollow};
  const cv::Mat picture = SnapshotRenderer(options).draw(input);
  const auto view = externalView(options, input, 0.0);
  for (const auto& corner : map::boxCorners(map.movingObjects().tracks()[0])) {
    const auto pixel = render::project(corner, view);
    ASSERT_TRUE(pixel);
    EXPECT_TRUE(isLike(picture, *pixel, colourOf(ObjectClass::kCyclist))) << pixel->transpose();
  }
}

TEST(SnapshotTest, DrawsBoxesOverTheImageWhereTheyProject) {
  map::PerceptionMap map;
  map.update(10.0, {streetTrack(3, ObjectClass::kTruck, {12.0, 1.0}, 0.4, 0.0)});
  const auto input = streetInput(map);
  const cv::Mat picture = drawn(input, View::kCamera, 1280, 480);
  const Pose T_cam_map = (input.T_map_robot * input.camera->T_robot_cam).inverse();
  for (const auto& corner : map::boxCorners(map.movingObjects().tracks()[0])) {
    const auto uvd = headway::project(T_cam_map * corner, *input.camera);
    ASSERT_TRUE(uvd);
    const Eigen::Vector2d pixel = 2.0 * uvd->head<2>() + Eigen::Vector2d(0.5, 0.5);
    EXPECT_TRUE(isLike(picture, pixel, colourOf(ObjectClass::kTruck))) << pixel.transpose();
  }
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 1000), cv::Vec3b(200, 170, 140));
}

TEST(SnapshotTest, ShowsTheCameraImageAsAnInset) {
  const auto map = streetMap();
  auto input = streetInput(map);
  const Colour sky{140, 170, 200};
  const int with = pixelsLike(drawn(input, View::kFollow), sky);
  input.image = cv::Mat();
  EXPECT_GT(with, pixelsLike(drawn(input, View::kFollow), sky) + 3000);
}

TEST(SnapshotTest, AcceptsGreyImages) {
  const auto map = streetMap();
  auto input = streetInput(map);
  input.image = cv::Mat(240, 640, CV_8UC1, cv::Scalar(180));
  EXPECT_GT(pixelsLike(drawn(input, View::kCamera), {180, 180, 180}), 10000);
}

TEST(SnapshotTest, OmitsTentativeTracks) {
  auto track = streetTrack(3, ObjectClass::kCyclist, {12.0, 1.0}, 0.4, 3.0);
  track.status = TrackStatus::kTentative;
  map::PerceptionMap map;
  map.update(10.0, {track});
  auto input = streetInput(map);
  EXPECT_EQ(pixelsLike(drawn(input, View::kFollow), colourOf(ObjectClass::kCyclist)), 0);
  EXPECT_EQ(pixelsLike(drawn(input, View::kCamera), colourOf(ObjectClass::kCyclist)), 0);
}

TEST(SnapshotDeathTest, RequiresNoOpenGlForTheCameraViewAndSceneFiles) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
        const auto map = streetMap();
        (void)drawn(streetInput(map), View::kCamera);
        saveScene("/dev/null", streetInput(map));
        try {
          (void)drawn(streetInput(map), View::kTop);
        } catch (const render::RendererUnavailable&) {
          std::exit(7);
        }
        std::exit(0);
      },
      ::testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace headway::scene
