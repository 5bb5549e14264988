// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/object_class.h>
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

TEST(SnapshotDeathTest, RequiresNoOpenGl) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
        const auto map = streetMap();
        for (const View view : {View::kFollow, View::kTop, View::kOrbit, View::kCamera}) {
          const cv::Mat picture = drawn(streetInput(map), view);
          if (pixelsLike(picture, colourOf(ObjectClass::kCar)) < 100) std::exit(1);
        }
        saveScene("/dev/null", streetInput(map));
        std::exit(7);
      },
      ::testing::ExitedWithCode(7), "");
}

/// A wall of dense points across the street, red at the left and blue at the right, or grey.
mrpt::maps::CColouredPointsMap::Ptr denseWall(float x, bool grey = false) {
  auto wall = mrpt::maps::CColouredPointsMap::Create();
  for (float y = -6.F; y <= 6.F; y += 0.1F) {
    for (float z = 0.F; z <= 3.F; z += 0.1F) {
      if (grey) {
        wall->insertPointRGB(x, y, z, 0.4F, 0.4F, 0.4F);
      } else {
        wall->insertPointRGB(x, y, z, y > 0.F ? 0.9F : 0.1F, 0.1F, y > 0.F ? 0.1F : 0.9F);
      }
    }
  }
  return wall;
}

/// The mean colour around the projection of a place in a view, BGR.
cv::Scalar colourAt(const cv::Mat& picture, const Eigen::Vector3d& place,
                    const SnapshotInput& input, View view) {
  SnapshotOptions options{picture.cols, picture.rows, view};
  const auto pixel = render::project(place, externalView(options, input, groundHeight(input)));
  return cv::mean(picture(cv::Rect(cvRound(pixel->x()) - 2, cvRound(pixel->y()) - 2, 5, 5)));
}

class DenseViewTest : public ::testing::TestWithParam<View> {
 protected:
  map::PerceptionMap map = streetMap();
  const Eigen::Vector3d red_place{6.0, 3.0, 2.5}, blue_place{6.0, -3.0, 2.5};
};

TEST_P(DenseViewTest, ShowsTheDenseMapInItsColoursWhereItProjects) {
  map.update(10.0, {});
  map.update(denseWall(6.F));
  auto input = streetInput(map);
  input.image = cv::Mat();
  const cv::Mat picture = drawn(input, GetParam(), 960, 540);
  const auto red = colourAt(picture, red_place, input, GetParam());
  const auto blue = colourAt(picture, blue_place, input, GetParam());
  EXPECT_GT(red[2], 2.0 * red[0]);
  EXPECT_GT(red[2], 80.0);
  EXPECT_GT(blue[0], 2.0 * blue[2]);
  EXPECT_GT(blue[0], 80.0);
}

TEST_P(DenseViewTest, CanLeaveItOut) {
  map.update(denseWall(6.F));
  const auto input = streetInput(map);
  const auto draw = [&](bool dense) {
    SnapshotOptions options{640, 360, GetParam()};
    options.dense = dense;
    return SnapshotRenderer(options).draw(input);
  };
  const cv::Mat without = drawn(streetInput(streetMap()), GetParam());
  EXPECT_EQ(cv::norm(draw(false), without, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(draw(true), without, cv::NORM_INF), 50.0);
}

TEST_P(DenseViewTest, IsDeterministic) {
  map.update(denseWall(6.F));
  const auto input = streetInput(map);
  EXPECT_EQ(cv::norm(drawn(input, GetParam()), drawn(input, GetParam()), cv::NORM_INF), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Views, DenseViewTest,
                         ::testing::Values(View::kFollow, View::kTop, View::kOrbit));

TEST(SnapshotTest, ObjectsBehindTheDenseMapAreFaint) {
  map::PerceptionMap map;
  map.update(10.0, {streetTrack(3, ObjectClass::kCyclist, {12.0, 1.0}, 0.4, 0.0)});
  auto input = streetInput(map);
  input.image = cv::Mat();
  const auto ink = [&] {
    return pixelsLike(drawn(input, View::kFollow, 1280, 720), colourOf(ObjectClass::kCyclist));
  };
  const int before = ink();
  map.update(denseWall(8.F, true));
  const int behind = ink();
  EXPECT_LT(behind, before);
  EXPECT_GT(behind, 20) << "of the legend, at least";
}

TEST(SnapshotTest, DrawsTheNewDenseMapAfterAChange) {
  map::PerceptionMap map = streetMap();
  map.update(10.0, {});
  map.update(denseWall(6.F));
  SnapshotOptions options{640, 360, View::kTop};
  SnapshotRenderer renderer(options);
  const cv::Mat first = renderer.draw(streetInput(map));
  EXPECT_EQ(cv::norm(first, renderer.draw(streetInput(map)), cv::NORM_INF), 0.0);
  map.update(denseWall(9.F));
  EXPECT_GT(cv::norm(first, renderer.draw(streetInput(map)), cv::NORM_INF), 50.0);
}

TEST(SnapshotTest, LandmarksAreVisibleOnDenseSurfaces) {
  map::PerceptionMap map;
  map.update(denseWall(6.F));
  map.update(slam::MapView{{{LandmarkId{1}, {6.0, 3.0, 1.0}, 4, 255}}, {}});
  auto input = streetInput(map);
  input.image = cv::Mat();
  const auto colour =
      colourAt(drawn(input, View::kFollow, 1280, 720), {6.0, 3.0, 1.0}, input, View::kFollow);
  EXPECT_GT(colour[0], 60.0) << "bluish on the red wall";
}

TEST(ThemeTest, HasNames) {
  EXPECT_EQ(themeFrom("dark"), Theme::kDark);
  EXPECT_EQ(themeFrom("light"), Theme::kLight);
  EXPECT_EQ(themeFrom("Light"), std::nullopt);
}

double luminance(Colour colour) {
  return 0.299 * colour.red + 0.587 * colour.green + 0.114 * colour.blue;
}

TEST(ThemeTest, DarkIsDarkAndLightIsLight) {
  const auto map = streetMap();
  auto input = streetInput(map);
  input.image = cv::Mat();
  const auto brightness = [&](Theme theme, View view) {
    SnapshotOptions options{640, 360, view};
    options.theme = theme;
    return cv::mean(SnapshotRenderer(options).draw(input))[1];
  };
  for (const View view : {View::kFollow, View::kTop, View::kOrbit}) {
    EXPECT_LT(brightness(Theme::kDark, view), 70.0);
    EXPECT_GT(brightness(Theme::kLight, view), 170.0);
  }
}

/// Text and what is drawn on the ground differ from what they are drawn on by a sixth of the
/// range or more, labels by more.
TEST(ThemeTest, EverythingDiffersFromItsBackground) {
  for (const auto* palette : {&kDarkPalette, &kLightPalette}) {
    const double ground = luminance(palette->backdrop.ground), panel = luminance(palette->panel);
    for (const Colour colour : {palette->path, palette->prediction, palette->truth,
                                palette->occupied, palette->low, palette->high}) {
      EXPECT_GT(std::abs(luminance(colour) - ground), 42.0);
    }
    EXPECT_GT(std::abs(luminance(palette->text) - panel), 128.0);
    EXPECT_GT(std::abs(luminance(palette->dim_text) - panel), 100.0);
    for (int i = 0; i < kObjectClassCount; ++i) {
      const auto label = labelColour(static_cast<ObjectClass>(i), *palette);
      EXPECT_GT(std::abs(luminance(label) - panel), 100.0) << i;
    }
  }
}

}  // namespace
}  // namespace headway::scene
