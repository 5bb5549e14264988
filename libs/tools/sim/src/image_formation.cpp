// SPDX-License-Identifier: BSD-3-Clause
#include "image_formation.h"

#include <headway/core/random.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "random_draws.h"

namespace headway::sim {
namespace {

constexpr int kSpare = 256;  // the noise sheet is larger than the image by this [px]
constexpr double kSheetSigma = 24.0;

}  // namespace

ImageFormation::ImageFormation(const CameraParams& params, int width, int height,
                               std::uint64_t seed)
    : params_(params), seed_(seed) {
  if (params.vignetting > 0.0) {
    light_.create(height, width, CV_8UC3);
    const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1), r2 = cx * cx + cy * cy;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const double ratio =
            1.0 - params.vignetting * ((u - cx) * (u - cx) + (v - cy) * (v - cy)) / r2;
        light_.at<cv::Vec3b>(v, u) = cv::Vec3b::all(cv::saturate_cast<uchar>(255.0 * ratio));
      }
    }
  }
  Random random(seedOf({seed, 1}));
  noise_.create(height + kSpare, width + kSpare, CV_8UC3);
  for (int v = 0; v < noise_.rows; ++v) {
    auto* row = noise_.ptr<uchar>(v);
    for (int i = 0; i < noise_.cols * 3; ++i) {
      const std::uint64_t bits = random.bits();
      double sum = 0.0;  // of eight bytes: near enough to normal
      for (int k = 0; k < 8; ++k) sum += static_cast<double>((bits >> (8 * k)) & 0xff);
      row[i] = cv::saturate_cast<uchar>(128.0 + (sum - 1020.0) / 209.0 * kSheetSigma);
    }
  }
}

cv::Mat ImageFormation::expose(const cv::Mat& picture, std::size_t frame, Side side) const {
  cv::Mat result;
  const double wander =
      1.0 + params_.exposure_change * std::sin(static_cast<double>(frame) * 0.045);
  const double gain = wander * (side == Side::kRight ? 1.0 + params_.gain_difference : 1.0);
  if (light_.empty()) {
    picture.convertTo(result, -1, gain);
  } else {
    cv::multiply(picture, light_, result, gain / 255.0);
  }
  if (params_.noise_grey > 0.0) {
    Random random(seedOf({seed_, frame, static_cast<std::uint64_t>(side), 2}));
    const cv::Rect place(drawPoint(kSpare, kSpare, random), result.size());
    const double k = params_.noise_grey / kSheetSigma;
    cv::addWeighted(result, 1.0, noise_(place), k, -128.0 * k, result);
  }
  if (!params_.colour) cv::cvtColor(result, result, cv::COLOR_BGR2GRAY);
  return result;
}

}  // namespace headway::sim
