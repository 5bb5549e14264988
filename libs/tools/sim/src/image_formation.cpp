// SPDX-License-Identifier: BSD-3-Clause
// What a camera does to time, brightness and depth: trigger, exposure, noise.
#include "image_formation.h"

#include <headway/core/random.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "grain.h"

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
  if (params.gamma != 1.0) {
    tones_.create(1, 256, CV_8U);
    for (int i = 0; i < 256; ++i) {
      tones_.at<uchar>(i) = cv::saturate_cast<uchar>(255.0 * std::pow(i / 255.0, params.gamma));
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
  if (!tones_.empty()) cv::LUT(result, tones_, result);
  if (params_.noise_grey > 0.0) {
    Random random(seedOf({seed_, frame, static_cast<std::uint64_t>(side), 2}));
    const cv::Rect place(drawPoint(kSpare, kSpare, random), result.size());
    const double k = params_.noise_grey / kSheetSigma;
    cv::addWeighted(result, 1.0, noise_(place), k, -128.0 * k, result);
  }
  if (!params_.colour) cv::cvtColor(result, result, cv::COLOR_BGR2GRAY);
  return result;
}

namespace {

/// Marks the pixels of a row that the projector does not reach because of a nearer surface.
void findShadows(const float* depth, int columns, float focal_baseline, std::vector<char>& hidden) {
  std::vector<float> nearest(static_cast<std::size_t>(columns),
                             std::numeric_limits<float>::infinity());
  const auto ray = [&](int u) {
    const float at = static_cast<float>(u) - focal_baseline / depth[u];
    return at >= 0.0F ? static_cast<std::ptrdiff_t>(at) : -1;
  };
  for (int u = 0; u < columns; ++u) {
    if (!(depth[u] > 0.0F)) continue;
    const auto at = ray(u);
    if (at >= 0) nearest[at] = std::min(nearest[at], depth[u]);
  }
  for (int u = 0; u < columns; ++u) {
    hidden[u] = 0;
    if (!(depth[u] > 0.0F)) continue;
    const auto at = ray(u);
    if (at >= 0 && depth[u] > 1.03F * nearest[at]) hidden[u] = 1;  // another surface
  }
}

/// Whether a nearer surface begins beside the pixel.
bool isAtEdge(const cv::Mat& depth, int u, int v) {
  const float own = depth.at<float>(v, u);
  const auto is_nearer = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= depth.cols || row >= depth.rows) return false;
    const float other = depth.at<float>(row, column);
    return other > 0.0F && own > 1.05F * other;
  };
  return is_nearer(u - 1, v) || is_nearer(u + 1, v) || is_nearer(u, v - 1) || is_nearer(u, v + 1);
}

}  // namespace

DepthSensor::DepthSensor(const CameraParams& params, const StereoCamera& camera, std::uint64_t seed)
    : params_(params),
      focal_baseline_(static_cast<float>(camera.fx * camera.baseline_m)),
      seed_(seed) {
  if (!params.depth_camera) return;
  Random random(seedOf({seed, 1}));
  noise_.create(params.height + kSpare, params.width + kSpare, CV_32F);
  for (int v = 0; v < noise_.rows; ++v) {
    auto* row = noise_.ptr<float>(v);
    for (int u = 0; u < noise_.cols; ++u) row[u] = static_cast<float>(random.normal());
  }
  cv::GaussianBlur(noise_, noise_, {}, 1.0);  // neighbouring pixels err alike
  cv::Scalar mean, deviation;
  cv::meanStdDev(noise_, mean, deviation);
  noise_ = (noise_ - mean[0]) / deviation[0];
}

cv::Mat DepthSensor::measure(const cv::Mat& depth, std::size_t frame) const {
  Random random(seedOf({seed_, frame, 2}));
  const cv::Rect place(drawPoint(kSpare, kSpare, random), depth.size());
  const cv::Mat noise = noise_(place);
  const auto scale = static_cast<float>(params_.depth_noise);
  const auto nearest = static_cast<float>(params_.depth_min_m);
  const auto farthest = static_cast<float>(params_.depth_max_m);
  cv::Mat ranges(depth.size(), CV_16U, cv::Scalar(0));
  std::vector<char> hidden(static_cast<std::size_t>(depth.cols));
  for (int v = 0; v < depth.rows; ++v) {
    const auto* truth = depth.ptr<float>(v);
    findShadows(truth, depth.cols, focal_baseline_, hidden);
    for (int u = 0; u < depth.cols; ++u) {
      const float measured = truth[u] + scale * truth[u] * truth[u] * noise.at<float>(v, u);
      if (hidden[u] != 0 || !(measured >= nearest && measured <= farthest)) continue;
      if (isAtEdge(depth, u, v)) continue;
      ranges.at<std::uint16_t>(v, u) =
          cv::saturate_cast<std::uint16_t>(std::round(measured * 1000.0F));
    }
  }
  return ranges;
}

}  // namespace headway::sim
