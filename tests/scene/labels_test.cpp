// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/map/track_geometry.h>

#include <opencv2/imgproc.hpp>

#include "drawn_picture.h"
#include "example_street.h"
#include "overlay.h"

namespace headway::scene {
namespace {

cv::Mat labelled(const std::vector<Track>& tracks) {
  cv::Mat picture = background();
  Canvas canvas(picture);
  drawLabels(canvas, forwardView(), tracks, 1.0);
  return picture;
}

TEST(LabelsTest, AreAboveTheBox) {
  const auto track = streetTrack(7, ObjectClass::kCar, {5, 0}, 0.0, 0.0);
  const cv::Rect label = changed(labelled({track}));
  ASSERT_FALSE(label.empty());
  const auto top =
      render::project(track.position + Eigen::Vector3d(0, 0, 0.5 * track.size.z()), forwardView());
  ASSERT_TRUE(top);
  EXPECT_LT(label.br().y, top->y());
  EXPECT_NEAR(0.5 * (label.x + label.br().x), top->x(), 4.0);
}

TEST(LabelsTest, OfEqualPositionsDoNotOverlap) {
  const auto near = streetTrack(1, ObjectClass::kCar, {5, 0}, 0.0, 0.0);
  const auto far = streetTrack(2, ObjectClass::kCar, {5.5, 0}, 0.0, 0.0);
  const cv::Rect one = changed(labelled({near}));
  const cv::Rect both = changed(labelled({near, far}));
  EXPECT_GE(both.height, 2 * one.height) << "the second label is above the first";
}

TEST(LabelsTest, AreOmittedForFarHiddenAndTentativeTracks) {
  auto tentative = streetTrack(3, ObjectClass::kCar, {5, 0}, 0.0, 0.0);
  tentative.status = TrackStatus::kTentative;
  EXPECT_TRUE(changed(labelled({streetTrack(1, ObjectClass::kCar, {200, 0}, 0.0, 0.0),
                                streetTrack(2, ObjectClass::kCar, {-60, 0}, 0.0, 0.0), tentative}))
                  .empty());
}

TEST(LabelLayoutTest, TakesThePlaceAboveTheBoxThenOthers) {
  LabelLayout layout({200, 200});
  const cv::Rect box(80, 100, 40, 30);
  layout.occupy(box);
  const auto first = layout.place({30, 10}, box, 4);
  EXPECT_EQ(first, cv::Rect(85, 86, 30, 10));
  std::vector<cv::Rect> placed{*first};
  while (const auto next = layout.place({30, 10}, box, 4)) {
    for (const auto& other : placed) EXPECT_TRUE((*next & other).empty());
    EXPECT_TRUE((*next & box).empty());
    placed.push_back(*next);
  }
  EXPECT_GT(placed.size(), 5u);
}

TEST(LabelLayoutTest, StaysInThePicture) {
  LabelLayout layout({100, 100});
  const auto below = layout.place({30, 10}, {40, 5, 20, 20}, 4);
  ASSERT_TRUE(below) << "no room above";
  EXPECT_EQ(*below & cv::Rect(0, 0, 100, 100), *below);
  EXPECT_FALSE(layout.place({120, 10}, {40, 50, 20, 20}, 4)) << "wider than the picture";
}

TEST(LabelLayoutTest, AnOutlineIsNotItsBoundingRectangle) {
  LabelLayout layout({100, 100});
  layout.occupy(std::vector<cv::Point>{{0, 99}, {99, 99}, {99, 0}});
  EXPECT_TRUE(layout.place({30, 10}, {10, 25, 30, 1}, 4));
  EXPECT_FALSE(layout.place({30, 10}, {65, 98, 30, 1}, 4));
}

TEST(LabelsTest, OfACrowdCoverNeitherEachOtherNorBoxesNorPanels) {
  std::vector<Track> crowd;
  for (int i = 0; i < 40; ++i) {
    crowd.push_back(streetTrack(i, i % 3 == 0 ? ObjectClass::kCar : ObjectClass::kPedestrian,
                                {2.0 + 3.1 * (i % 8), -7.0 + 2.3 * (i / 8)}, 0.2 * i, 1.0));
  }
  const std::vector<cv::Rect> panels{{0, 0, 300, 60}, {700, 0, 260, 200}};
  for (const double scale : {1.0, 4.0}) {  // 1280 and 3840 wide, for the same layout
    const cv::Size size(cvRound(scale * kWidth), cvRound(scale * kHeight));
    cv::Mat picture(size, CV_8UC3, cv::Scalar(0, 0, 0));
    Canvas canvas(picture);
    const auto view =
        render::makeView(size.width, size.height, 1.2, render::lookAt({-20, 0, 6}, {10, 0, 1}));
    const auto labels = drawLabels(canvas, view, crowd, 1.0, panels);
    EXPECT_GT(labels.size(), 8u);
    cv::Mat covered(size, CV_8U, cv::Scalar(0));
    for (const auto& track : crowd) {
      std::vector<cv::Point> corners, outline;
      for (const auto& corner : map::boxCorners(track)) {
        const auto pixel = render::project(corner, view);
        ASSERT_TRUE(pixel);
        corners.emplace_back(cvRound(pixel->x()), cvRound(pixel->y()));
      }
      cv::convexHull(corners, outline);
      cv::fillConvexPoly(covered, outline, cv::Scalar(1));
    }
    for (const auto& panel : panels) covered(panel).setTo(1);
    for (const auto& label : labels) {
      ASSERT_EQ(label & cv::Rect({0, 0}, size), label) << "within the picture";
      EXPECT_EQ(cv::countNonZero(covered(label)), 0) << label;
      covered(label).setTo(1);
    }
  }
}

TEST(LabelsTest, GrowWithThePicture) {
  const auto track = streetTrack(7, ObjectClass::kCar, {5, 0}, 0.0, 0.0);
  const auto heightAt = [&](int width, int height) {
    cv::Mat picture(height, width, CV_8UC3, cv::Scalar(0, 0, 0));
    Canvas canvas(picture);
    const auto view = render::makeView(width, height, 1.2, render::lookAt({-20, 0, 3}, {10, 0, 1}));
    return drawLabels(canvas, view, {track}, 1.0).at(0).height;
  };
  EXPECT_GE(heightAt(1280, 720), 16) << "capitals of 9 px";
  EXPECT_NEAR(heightAt(3840, 2160), 3 * heightAt(1280, 720), 6);
}

}  // namespace
}  // namespace headway::scene
