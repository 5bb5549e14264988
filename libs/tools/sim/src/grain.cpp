// SPDX-License-Identifier: BSD-3-Clause
// Random textures and colours.
#include "grain.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::sim {
namespace {

constexpr int kSheet = 2048;  // [px]

cv::Mat whiteNoise(int size, Random& random) {
  cv::Mat noise(size, size, CV_32F);
  for (int y = 0; y < size; ++y) {
    auto* row = noise.ptr<float>(y);
    for (int x = 0; x < size; ++x) {
      // Sum of four uniforms: near enough to normal, and quick.
      const std::uint64_t bits = random.bits();
      row[x] = static_cast<float>((bits & 0xffff) + ((bits >> 16) & 0xffff) +
                                  ((bits >> 32) & 0xffff) + (bits >> 48)) /
                   131072.0F -
               1.0F;
    }
  }
  return noise;
}

/// Octaves of white noise between two cell sizes [px], as an 8-bit sheet.
cv::Mat octaves(int smallest_cell, int largest_cell, Random& random) {
  cv::Mat sum = cv::Mat::zeros(kSheet, kSheet, CV_32F);
  for (int cell = smallest_cell; cell <= largest_cell; cell *= 2) {
    cv::Mat layer = whiteNoise(kSheet / cell, random);
    if (cell > 1) cv::resize(layer, layer, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += layer;
  }
  cv::Scalar mean, deviation;
  cv::meanStdDev(sum, mean, deviation);
  cv::Mat sheet;
  sum.convertTo(sheet, CV_8U, 32.0 / deviation[0], 128.0 - mean[0] * 32.0 / deviation[0]);
  return sheet;
}

}  // namespace

Grain::Grain(std::uint64_t seed) {
  Random random(seed);
  fine_ = octaves(1, 4, random);
  coarse_ = octaves(8, 128, random);
}

cv::Mat Grain::patch(const cv::Mat& sheet, int width, int height, Random& random) const {
  const cv::Rect place(drawPoint(kSheet - width + 1, kSheet - height + 1, random),
                       cv::Size(width, height));
  cv::Mat cut = sheet(place);
  const int mirror = random.below(4);
  cv::Mat turned;
  if (mirror == 3) {
    turned = cut;
  } else {
    cv::flip(cut, turned, mirror - 1);
  }
  return turned;
}

void Grain::roughen(cv::Mat& picture, double fine, double coarse, Random& random) const {
  cv::Mat blend, colour;
  const cv::Mat large = patch(coarse_, picture.cols, picture.rows, random);
  const cv::Mat small = patch(fine_, picture.cols, picture.rows, random);
  cv::addWeighted(small, fine / 32.0, large, coarse / 32.0, 128.0 * (1.0 - (fine + coarse) / 32.0),
                  blend);
  cv::cvtColor(blend, colour, cv::COLOR_GRAY2BGR);
  cv::addWeighted(picture, 1.0, colour, 1.0, -128.0, picture);
}

}  // namespace headway::sim
