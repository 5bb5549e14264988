// SPDX-License-Identifier: BSD-3-Clause
#include "image_formation.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "grain.h"

namespace headway::sim {
namespace {

using Side = ImageFormation::Side;

const cv::Size kSize(160, 120);

CameraParams perfectCamera() {
  CameraParams params;
  params.noise_grey = params.gain_difference = params.vignetting = params.exposure_change = 0.0;
  return params;
}

cv::Mat exposed(const CameraParams& params, const cv::Mat& picture, std::size_t frame, Side side,
                std::uint64_t seed = 1) {
  return ImageFormation(params, kSize.width, kSize.height, seed).expose(picture, frame, side);
}

cv::Mat evenGrey(int grey) { return {kSize, CV_8UC3, cv::Scalar::all(grey)}; }

double deviationOf(const cv::Mat& picture) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture, mean, deviation);
  return deviation[0];
}

TEST(ImageFormationTest, GammaBendsTheTonesBetweenBlackAndWhite) {
  CameraParams params = perfectCamera();
  for (const double gamma : {0.5, 2.0}) {
    params.gamma = gamma;
    const auto toneOf = [&](int grey) {
      return exposed(params, evenGrey(grey), 0, Side::kLeft).at<cv::Vec3b>(0, 0)[0];
    };
    EXPECT_EQ(0, toneOf(0));
    EXPECT_EQ(255, toneOf(255));
    EXPECT_NEAR(255.0 * std::pow(90.0 / 255.0, gamma), toneOf(90), 0.51);
  }
}

TEST(ImageFormationTest, APerfectCameraChangesNothing) {
  const cv::Mat picture = evenGrey(90);
  const cv::Mat image = exposed(perfectCamera(), picture, 0, Side::kLeft);
  EXPECT_EQ(cv::norm(image, picture, cv::NORM_INF), 0.0);
}

TEST(ImageFormationTest, NoiseHasTheDeviationAskedForAndDiffersByFrameAndSide) {
  CameraParams params = perfectCamera();
  params.noise_grey = 4.0;
  const cv::Mat image = exposed(params, evenGrey(120), 0, Side::kLeft);
  EXPECT_NEAR(deviationOf(image), 4.0, 0.5);
  EXPECT_NEAR(cv::mean(image)[0], 120.0, 0.7);
  EXPECT_GT(cv::norm(image, exposed(params, evenGrey(120), 1, Side::kLeft), cv::NORM_INF), 3.0);
  EXPECT_GT(cv::norm(image, exposed(params, evenGrey(120), 0, Side::kRight), cv::NORM_INF), 3.0);
  EXPECT_EQ(cv::norm(image, exposed(params, evenGrey(120), 0, Side::kLeft), cv::NORM_INF), 0.0);
}

TEST(ImageFormationTest, TheRightImageIsBrighterByTheGainDifference) {
  CameraParams params = perfectCamera();
  params.gain_difference = 0.1;
  const double left = cv::mean(exposed(params, evenGrey(100), 0, Side::kLeft))[0];
  const double right = cv::mean(exposed(params, evenGrey(100), 0, Side::kRight))[0];
  EXPECT_NEAR(right / left, 1.1, 0.02);
}

TEST(ImageFormationTest, CornersLoseLight) {
  CameraParams params = perfectCamera();
  params.vignetting = 0.3;
  const cv::Mat image = exposed(params, evenGrey(200), 0, Side::kLeft);
  const auto at = [&](int u, int v) { return static_cast<int>(image.at<cv::Vec3b>(v, u)[0]); };
  EXPECT_NEAR(at(80, 60), 200, 2);
  EXPECT_NEAR(at(0, 0), 140, 8);
  EXPECT_NEAR(at(0, 0), at(159, 119), 2);
  EXPECT_GT(at(40, 30), at(5, 5));
}

TEST(ImageFormationTest, BrightnessChangesSlowly) {
  CameraParams params = perfectCamera();
  params.exposure_change = 0.2;
  double darkest = 255.0, brightest = 0.0, before = -1.0;
  for (std::size_t frame = 0; frame < 300; ++frame) {
    const double mean = cv::mean(exposed(params, evenGrey(100), frame, Side::kLeft))[0];
    if (before >= 0.0) {
      EXPECT_LT(std::abs(mean - before), 6.0) << frame;
    }
    before = mean;
    darkest = std::min(darkest, mean);
    brightest = std::max(brightest, mean);
  }
  EXPECT_GT(brightest - darkest, 10.0);
  EXPECT_LT(brightest - darkest, 50.0);
}

TEST(ImageFormationTest, ACameraWithoutColourRecordsGrey) {
  CameraParams params = perfectCamera();
  params.colour = false;
  EXPECT_EQ(exposed(params, evenGrey(50), 0, Side::kLeft).type(), CV_8UC1);
}

TEST(GrainTest, RoughensAroundTheColourOfThePicture) {
  const Grain grain(4);
  Random random(1);
  cv::Mat picture(256, 256, CV_8UC3, cv::Scalar(40, 90, 160));
  grain.roughen(picture, 6.0, 5.0, random);
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture, mean, deviation);
  EXPECT_NEAR(mean[0], 40.0, 5.0);
  EXPECT_NEAR(mean[1], 90.0, 5.0);
  EXPECT_NEAR(mean[2], 160.0, 5.0);
  EXPECT_NEAR(deviation[1], std::hypot(6.0, 5.0), 2.5);
}

TEST(GrainTest, NoTwoPatchesAreAlikeButTheSameSeedGivesTheSame) {
  const Grain grain(4), same(4);
  Random random(1), again(1);
  const auto patch = [](const Grain& of, Random& with) {
    cv::Mat picture(128, 128, CV_8UC3, cv::Scalar::all(128));
    of.roughen(picture, 6.0, 5.0, with);
    return picture;
  };
  const cv::Mat first = patch(grain, random), second = patch(grain, random);
  EXPECT_GT(cv::norm(first, second, cv::NORM_INF), 10.0);
  EXPECT_EQ(cv::norm(first, patch(same, again), cv::NORM_INF), 0.0);
}

TEST(GrainTest, CoarseNoiseIsSmootherThanFineNoise) {
  const Grain grain(4);
  const auto roughness = [&](double fine, double coarse) {
    Random random(1);
    cv::Mat picture(256, 256, CV_8UC3, cv::Scalar::all(128)), grey, edges;
    grain.roughen(picture, fine, coarse, random);
    cv::cvtColor(picture, grey, cv::COLOR_BGR2GRAY);
    cv::Laplacian(grey, edges, CV_32F);
    return deviationOf(edges);
  };
  EXPECT_GT(roughness(8.0, 0.0), 3.0 * roughness(0.0, 8.0));
}

}  // namespace
}  // namespace headway::sim
