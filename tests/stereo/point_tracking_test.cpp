// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/point_tracking.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

/// A smooth random texture.
cv::Mat texture() {
  cv::RNG random(3);
  cv::Mat image(240, 320, CV_8U);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(image, image, {0, 0}, 2.5);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  return image;
}

cv::Mat shifted(const cv::Mat& image, double right, double down) {
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1.0, 0.0, right, 0.0, 1.0, down);
  cv::Mat result;
  cv::warpAffine(image, result, shift, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT_101);
  return result;
}

ImagePyramid pyramidOf(const cv::Mat& image) { return buildPyramid(image, 4, Gradients::kAll); }

std::vector<Eigen::Vector2d> gridOfPoints() {
  std::vector<Eigen::Vector2d> points;
  for (int v = 60; v < 200; v += 20) {
    for (int u = 60; u < 280; u += 20) points.emplace_back(u, v);
  }
  return points;
}

TEST(TrackPointsTest, FindsShiftedPointsToAFractionOfAPixel) {
  const cv::Mat image = texture();
  const Eigen::Vector2d shift(5.3, -3.6);
  const auto points = gridOfPoints();
  const auto tracked =
      trackPoints(pyramidOf(image), pyramidOf(shifted(image, 5.3, -3.6)), points, points, {});
  std::size_t found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!tracked[i]) continue;
    ++found;
    EXPECT_LT((*tracked[i] - points[i] - shift).norm(), 0.15);
  }
  EXPECT_GE(found, points.size() - 2);
}

TEST(TrackPointsTest, APredictionReachesShiftsBeyondThePyramid) {
  const cv::Mat image = texture();
  const Eigen::Vector2d shift(40.0, 0.0);
  std::vector<Eigen::Vector2d> points = {{80.0, 80.0}, {120.0, 140.0}};
  std::vector<Eigen::Vector2d> predicted;
  for (const auto& point : points) predicted.push_back(point + shift + Eigen::Vector2d(2.0, 1.0));
  const auto tracked = trackPoints(pyramidOf(image), pyramidOf(shifted(image, 40.0, 0.0)), points,
                                   predicted, {9, 1, 18.0, 0.7});
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(tracked[i]);
    EXPECT_LT((*tracked[i] - points[i] - shift).norm(), 0.15);
  }
}

TEST(TrackPointsTest, FindsNothingWithoutTextureOrInAnotherImage) {
  const cv::Mat image = texture();
  const cv::Mat flat(image.size(), CV_8U, cv::Scalar(90));
  cv::Mat other;
  cv::flip(image, other, -1);
  const auto points = gridOfPoints();
  for (const auto& found : trackPoints(pyramidOf(flat), pyramidOf(flat), points, points, {})) {
    EXPECT_FALSE(found);
  }
  int found = 0;
  for (const auto& position : trackPoints(pyramidOf(image), pyramidOf(other), points, points, {})) {
    found += position ? 1 : 0;
  }
  EXPECT_LE(found, static_cast<int>(points.size() / 8));
}

TEST(TrackPointsTest, ExposuresMayDiffer) {
  const cv::Mat image = texture();
  cv::Mat darker;
  shifted(image, 3.0, 2.0).convertTo(darker, CV_8U, 0.5, 12.0);
  const auto points = gridOfPoints();
  const auto tracked = trackPoints(pyramidOf(image), pyramidOf(darker), points, points, {});
  std::size_t found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!tracked[i]) continue;
    ++found;
    EXPECT_LT((*tracked[i] - points[i] - Eigen::Vector2d(3.0, 2.0)).norm(), 0.15);
  }
  EXPECT_GE(found, points.size() - 4);
}

TEST(TrackPointsTest, CorrelationRejectsOtherSurroundings) {
  const cv::Mat image = texture();
  cv::Mat other;
  cv::flip(image, other, -1);
  const auto points = gridOfPoints();
  PointTrackingOptions options{15, 1, 255.0, 0.0};
  const auto count = [&] {
    std::size_t found = 0;
    for (const auto& one : trackPoints(pyramidOf(image), pyramidOf(other), points, points, options))
      found += one ? 1 : 0;
    return found;
  };
  EXPECT_GT(count(), points.size() / 2);
  options.min_zncc = 0.9;
  EXPECT_LT(count(), points.size() / 20);
}

TEST(TrackMissingTest, KeepsWhatWasFoundAndTracksTheOthers) {
  const cv::Mat image = texture();
  const auto from = pyramidOf(image);
  const auto to = pyramidOf(shifted(image, 40.0, 0.0));
  const std::vector<Eigen::Vector2d> points = {{80.0, 80.0}, {120.0, 140.0}};
  const std::vector<Eigen::Vector2d> predicted = {{120.0, 80.0}, {160.0, 140.0}};
  const Eigen::Vector2d kept(1.0, 2.0);
  std::vector<TrackedPosition> tracked = {kept, std::nullopt};
  trackMissing(from, to, points, predicted, {9, 1, 18.0, 0.7}, tracked);
  ASSERT_TRUE(tracked[0] && tracked[1]);
  EXPECT_EQ(*tracked[0], kept);
  EXPECT_LT((*tracked[1] - predicted[1]).norm(), 0.15);
}

TEST(TrackPointsTest, NoPointsAreNoError) {
  const auto pyramid = pyramidOf(texture());
  EXPECT_TRUE(trackPoints(pyramid, pyramid, {}, {}, {}).empty());
}

TEST(BuildPyramidTest, GradientsDoNotChangeTheLevels) {
  const cv::Mat image = texture();
  const auto with = buildPyramid(image, 4, Gradients::kAll);
  const auto without = buildPyramid(image, 4);
  EXPECT_TRUE(without.gradients.empty());
  ASSERT_EQ(with.gradients.size(), with.levels.size());
  ASSERT_EQ(with.count(), without.count());
  cv::Mat halved = image;
  for (int level = 0; level < with.count(); ++level) {
    EXPECT_EQ(cv::norm(with.levels[level], without.levels[level], cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(with.levels[level], halved, cv::NORM_INF), 0.0) << level;
    cv::pyrDown(halved, halved);
  }
}

}  // namespace
}  // namespace headway::stereo
