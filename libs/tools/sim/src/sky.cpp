// SPDX-License-Identifier: BSD-3-Clause
#include "sky.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::sim {
namespace {

constexpr int kSkyWidth = 2048, kSkyHeight = 512;  // [px]
constexpr int kHorizonRow = 400;                   // row of the horizon
constexpr float kTopElevation = 1.1F;              // [rad] of the picture's upper edge

/// Wraps around without a seam: noise on a torus, one octave.
void addClouds(cv::Mat& density, int cells, double amount, Random& random) {
  cv::Mat coarse(std::max(2, cells / 3), cells, CV_32F);
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      coarse.at<float>(y, x) = static_cast<float>(amount * random.uniform(-1, 1));
    }
  }
  cv::Mat wrapped;
  cv::copyMakeBorder(coarse, wrapped, 0, 0, 2, 2, cv::BORDER_WRAP);
  const double scale = static_cast<double>(kSkyWidth) / cells;
  cv::resize(wrapped, wrapped, {static_cast<int>((cells + 4) * scale), kSkyHeight}, 0, 0,
             cv::INTER_CUBIC);
  density += wrapped(cv::Rect(static_cast<int>(2 * scale), 0, kSkyWidth, kSkyHeight));
}

void drawSkyline(cv::Mat& picture, Random& random) {
  double height = 20.0;
  for (int x = 0; x < kSkyWidth; ++x) {  // wooded hills
    height = std::fmin(34.0, std::fmax(6.0, height + 0.9 * random.normal()));
    // The end meets the beginning.
    const double blend = x > kSkyWidth - 100 ? (kSkyWidth - x) / 100.0 : 1.0;
    const int top = kHorizonRow - static_cast<int>(blend * height + (1 - blend) * 20.0);
    const double level = random.uniform(0.85, 1.1);
    cv::line(picture, {x, top}, {x, kSkyHeight - 1}, cv::Scalar(118, 128, 115) * level, 1);
  }
  for (int i = 0; i < 90; ++i) {  // far roofs and towers
    const int x = random.below(kSkyWidth), w = 6 + random.below(24), h = 8 + random.below(40);
    const cv::Scalar colour = cv::Scalar(140, 140, 145) * random.uniform(0.75, 1.1);
    cv::rectangle(picture, {x, kHorizonRow - h}, {x + w, kSkyHeight - 1}, colour, cv::FILLED);
    for (int k = 0; k < w * h / 40; ++k) {
      cv::rectangle(picture, {x + random.below(w), kHorizonRow - random.below(h)},
                    {x + random.below(w), kHorizonRow - random.below(h)}, colour * 0.8, cv::FILLED);
    }
  }
}

}  // namespace

cv::Mat drawSky(Random& random) {
  cv::Mat density = cv::Mat::zeros(kSkyHeight, kSkyWidth, CV_32F);
  for (int cells = 8; cells <= 256; cells *= 2) {
    addClouds(density, cells, std::pow(cells / 8.0, -0.75), random);
  }
  cv::Mat picture(kSkyHeight, kSkyWidth, CV_8UC3);
  for (int y = 0; y < kSkyHeight; ++y) {
    const float haze = static_cast<float>(y) / kHorizonRow;
    for (int x = 0; x < kSkyWidth; ++x) {
      const float cloud = std::fmin(1.0F, std::fmax(0.0F, 0.5F + 0.7F * density.at<float>(y, x)));
      const float light = cloud * 60.0F;
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      pixel[0] = cv::saturate_cast<uchar>(205.0F + 10.0F * haze + light * 0.4F);
      pixel[1] = cv::saturate_cast<uchar>(165.0F + 40.0F * haze + light * 0.8F);
      pixel[2] = cv::saturate_cast<uchar>(135.0F + 65.0F * haze + light);
    }
  }
  drawSkyline(picture, random);
  cv::GaussianBlur(picture, picture, {3, 3}, 0);
  return picture;
}

Mesh skyMesh(float radius) {
  constexpr int kSpans = 48, kRings = 6;
  // The horizon's row lies at elevation 0; rows are equally spaced in elevation.
  const float bottom = -kTopElevation * static_cast<float>(kSkyHeight - kHorizonRow) / kHorizonRow;
  const auto at = [&](int span, int ring) {
    const float azimuth = 2.0F * static_cast<float>(M_PI) * static_cast<float>(span) / kSpans;
    const float elevation =
        kTopElevation + (bottom - kTopElevation) * static_cast<float>(ring) / kRings;
    return MeshVertex{
        radius * Eigen::Vector3f(std::cos(elevation) * std::cos(azimuth),
                                 -std::cos(elevation) * std::sin(azimuth), std::sin(elevation)),
        {static_cast<float>(span) / kSpans, static_cast<float>(ring) / kRings}};
  };
  Mesh mesh;
  for (int span = 0; span < kSpans; ++span) {
    for (int ring = 0; ring < kRings; ++ring) {
      mesh.addTriangle(at(span, ring), at(span + 1, ring), at(span + 1, ring + 1));
      mesh.addTriangle(at(span, ring), at(span + 1, ring + 1), at(span, ring + 1));
    }
  }
  return mesh;
}

}  // namespace headway::sim
