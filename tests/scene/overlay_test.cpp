// SPDX-License-Identifier: BSD-3-Clause
#include "overlay.h"

#include <gtest/gtest.h>
#include <headway/plot/colours.h>

#include <opencv2/imgproc.hpp>

#include "drawn_picture.h"
#include "example_street.h"
#include "view.h"

namespace headway::scene {
namespace {

int count(const cv::Mat& picture, Colour colour) {
  cv::Mat equal;
  cv::inRange(picture, plot::bgr(colour), plot::bgr(colour), equal);
  return cv::countNonZero(equal);
}

TEST(ShownTracksTest, AreConfirmedOrCoasting) {
  std::vector<Track> tracks;
  for (const auto status : {TrackStatus::kTentative, TrackStatus::kConfirmed,
                            TrackStatus::kCoasting, TrackStatus::kEnded}) {
    tracks.push_back(streetTrack(int(tracks.size()), ObjectClass::kCar, {5, 0}, 0.0, 0.0));
    tracks.back().status = status;
  }
  const auto shown = shownTracks(tracks);
  ASSERT_EQ(shown.size(), 2u);
  EXPECT_EQ(shown[0], &tracks[1]);
  EXPECT_EQ(shown[1], &tracks[2]);
}

TEST(BoxesTest, AreThinnerWhileCoasting) {
  const auto ink = [](TrackStatus status) {
    auto track = streetTrack(1, ObjectClass::kCar, {5, 0}, 0.0, 0.0);
    track.status = status;
    cv::Mat picture(1080, 1920, CV_8UC3, cv::Scalar(0, 0, 0));
    Canvas canvas(picture);
    const auto view = render::makeView(1920, 1080, 1.2, render::lookAt({-20, 0, 3}, {10, 0, 1}));
    drawBoxes(canvas, view, {track});
    return cv::sum(picture)[0];
  };
  EXPECT_GT(ink(TrackStatus::kConfirmed), ink(TrackStatus::kCoasting));
  EXPECT_GT(ink(TrackStatus::kCoasting), 0.0);
}

TEST(BoxesTest, AreThinnerWhereTheMapHidesThem) {
  const auto track = streetTrack(1, ObjectClass::kCar, {5, 0}, 0.0, 0.0);
  const auto ink = [&](const Hides& hides) {
    cv::Mat picture(1080, 1920, CV_8UC3, cv::Scalar(0, 0, 0));
    Canvas canvas(picture);
    const auto view = render::makeView(1920, 1080, 1.2, render::lookAt({-20, 0, 3}, {10, 0, 1}));
    drawBoxes(canvas, view, {track}, hides);
    return cv::sum(picture)[0];
  };
  const double shown = ink([](const Eigen::Vector3d&) { return false; });
  const double half = ink([&](const Eigen::Vector3d& p) { return p.y() > track.position.y(); });
  const double hidden = ink([](const Eigen::Vector3d&) { return true; });
  EXPECT_GT(shown, 1.1 * half);
  EXPECT_GT(half, 1.1 * hidden);
  EXPECT_GT(hidden, 0.0);
}

TEST(CaptionTest, IsInTheTopLeftCorner) {
  const map::PerceptionMap map;
  cv::Mat picture = background();
  Canvas canvas(picture);
  drawCaption(canvas, SnapshotInput{map, 12, 3.0});
  const cv::Rect caption = changed(picture);
  EXPECT_FALSE(caption.empty());
  EXPECT_TRUE((caption & cv::Rect(0, 0, kWidth / 2, kHeight / 4)) == caption);
}

TEST(ScaleBarTest, HasItsTrueLength) {
  cv::Mat picture = background();
  Canvas canvas(picture);
  drawScaleBar(canvas, 0.1);
  const int bar_row = kHeight - canvas.px(18) - canvas.px(4) / 2;
  EXPECT_EQ(count(picture.row(bar_row), kDarkPalette.text), 100)
      << "10 m of at most 192 px = 19.2 m";
}

TEST(InsetTest, RequiresImageAndCamera) {
  const auto map = streetMap();
  auto input = streetInput(map);
  cv::Mat picture = background();
  Canvas canvas(picture);
  auto without_image = input;
  without_image.image = cv::Mat();
  drawInset(canvas, without_image);
  auto without_camera = input;
  without_camera.camera = nullptr;
  drawInset(canvas, without_camera);
  EXPECT_TRUE(changed(picture).empty());
  drawInset(canvas, input);
  const cv::Rect inset = changed(picture);
  EXPECT_EQ(inset.width, cvRound(0.3 * kWidth));
  EXPECT_EQ(inset.br().x, kWidth - canvas.px(18));
}

TEST(LandmarksTest, AreDotsAtTheirProjection) {
  slam::MapView static_map;
  static_map.landmarks = {{LandmarkId{1}, {10, 1, 1}, 3, 200},
                          {LandmarkId{2}, {-60, 0, 0}, 3, 200}};
  cv::Mat picture = background();
  Canvas canvas(picture);
  drawLandmarksOver(canvas, forwardView(), static_map);
  const auto pixel = render::project({10, 1, 1}, forwardView());
  ASSERT_TRUE(pixel);
  const cv::Rect dot = changed(picture);
  EXPECT_LE(dot.width, 5);
  EXPECT_TRUE(dot.contains({cvRound(pixel->x()), cvRound(pixel->y())}));
}

cv::Mat withLegend(Legend& legend, const SnapshotInput& input, Legend::Layout layout) {
  cv::Mat picture = background();
  Canvas canvas(picture);
  legend.draw(canvas, input, layout);
  return picture;
}

TEST(LegendTest, ListsTheClassesThatOccur) {
  map::PerceptionMap map;
  map.update(0.0, {streetTrack(1, ObjectClass::kCyclist, {5, 0}, 0.0, 0.0)});
  Legend legend;
  const cv::Mat picture = withLegend(legend, {map, 0, 0.0}, Legend::Layout::kColumn);
  EXPECT_GT(count(picture, colourOf(ObjectClass::kCyclist)), 20);
  EXPECT_GT(count(picture, kPredictionColour), 20);
  EXPECT_GT(count(picture, kDarkPalette.path), 20);
  EXPECT_EQ(count(picture, colourOf(ObjectClass::kCar)), 0);
  EXPECT_EQ(count(picture, kTruthColour), 0);
}

TEST(LegendTest, KeepsClassesOnceTheyOccurred) {
  map::PerceptionMap map;
  map.update(0.0, {streetTrack(1, ObjectClass::kCyclist, {5, 0}, 0.0, 0.0)});
  Legend legend;
  const auto first = changed(withLegend(legend, {map, 0, 0.0}, Legend::Layout::kColumn));
  map.update(1.0, {});
  EXPECT_EQ(changed(withLegend(legend, {map, 1, 1.0}, Legend::Layout::kColumn)), first);
}

TEST(LegendTest, ContainsTheTruthIfShown) {
  const map::PerceptionMap map;
  SnapshotInput input{map, 0, 0.0};
  Legend legend;
  const auto without = changed(withLegend(legend, input, Legend::Layout::kColumn));
  input.true_path = {{0.0, Pose::Identity()}};
  const auto with = changed(withLegend(legend, input, Legend::Layout::kColumn));
  EXPECT_GT(with.height, without.height);
}

TEST(LegendTest, RowIsLowAndColumnNarrow) {
  const auto map = streetMap();
  Legend legend;
  const auto row = changed(withLegend(legend, {map, 0, 0.0}, Legend::Layout::kRow));
  const auto column = changed(withLegend(legend, {map, 0, 0.0}, Legend::Layout::kColumn));
  EXPECT_GT(row.width, column.width);
  EXPECT_LT(row.height, column.height);
  EXPECT_LE(row.br().y, kHeight);
}

}  // namespace
}  // namespace headway::scene
