// SPDX-License-Identifier: BSD-3-Clause
// Registration of colour and depth images, by the edges of both.
#include "registration_check.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

namespace headway::import {
namespace {

// Searched values, from -max to max.
struct Axis {
  double max = 0.0;
  int half = 0;  ///< steps on each side

  [[nodiscard]] constexpr int count() const { return 2 * half + 1; }
  [[nodiscard]] constexpr double step() const { return max / half; }
  [[nodiscard]] constexpr double at(int i) const { return (i - half) * step(); }
};

constexpr Axis kShift{0.075, 15};          // [m]: cameras of one housing are nearer to each other
constexpr Axis kGrowth{0.12, 24};          // twice what one lens for both cameras does (6 %)
constexpr Axis kFringe{4.0, 4};            // of structured light [px]
constexpr double kReachRatio = 0.1;        // of a profile to each side, to the width of the image
constexpr float kFarther = 0.85F;          // disparity behind a contour to that of the contour
constexpr double kLargestHole = 0.06;      // beside it, to the width of the image
constexpr int kLineStep = 4;               // of searched rows and columns [px]
constexpr std::size_t kMaxFrames = 200;    // whose sums are held: 0.1 MB each
constexpr std::size_t kMinContours = 300;  // in all
constexpr float kMinGrey = 3.0F;           // mean gradient of a profile, below which it is noise
constexpr float kMaxRatio = 4.0F;          // of a gradient to the mean of its profile
constexpr int kResampled = 40;
constexpr double kFringeSigma_px = 1.0;  // of contours in depth images, common to all

constexpr std::size_t indexOf(int shift, int growth, int fringe) {
  const int index = (growth * kFringe.count() + fringe) * kShift.count() + shift;
  return static_cast<std::size_t>(index);
}
const std::size_t kSums =
    static_cast<std::size_t>(kShift.count()) * kGrowth.count() * kFringe.count();

/// Contour of a near surface on a line of an image.
struct Contour {
  int at = 0;           ///< last pixel of the surface
  int outward = 1;      ///< where the farther surface is: 1 or -1
  float disparity = 0;  ///< [px]
};

/// Contours along a row, or along a column of the transposed image.
std::vector<Contour> contoursOf(const cv::Mat& disparity, int row) {
  const auto* line = disparity.ptr<float>(row);
  const int hole = std::max(2, static_cast<int>(kLargestHole * disparity.cols));
  std::vector<Contour> contours;
  int before = -1;  // last pixel with a depth
  for (int at = 0; at < disparity.cols; ++at) {
    if (!(line[at] > 0.0F)) continue;
    if (before >= 0 && at - before <= hole) {
      if (line[at] < kFarther * line[before]) contours.push_back({before, 1, line[before]});
      if (line[before] < kFarther * line[at]) contours.push_back({at, -1, line[at]});
    }
    before = at;
  }
  return contours;
}

/// Adds the gradients at the contours of one row, moved in all ways that are searched.
///
/// @param gradient  along rows, >= 0
/// @param centre    principal point along the row [px]
/// @param shift_px  of 1 m, of a contour with disparity 1
void addContour(const Contour& contour, const float* gradient, int size, double centre,
                double shift_px, std::vector<float>& sums, std::size_t& count) {
  const int reach = static_cast<int>(kReachRatio * size);
  const double place = contour.at + 0.5 * contour.outward;
  const int first = static_cast<int>(place) - reach;
  if (first < 0 || first + 2 * reach + 1 >= size) return;
  float mean = 0.0F;
  for (int i = 0; i <= 2 * reach; ++i)
    mean += gradient[first + i] / static_cast<float>(2 * reach + 1);
  if (mean < kMinGrey) return;
  ++count;
  const double by_shift = shift_px * static_cast<double>(contour.disparity);
  for (int growth = 0; growth < kGrowth.count(); ++growth) {
    const double grown = place + kGrowth.at(growth) * (place - centre);
    for (int fringe = 0; fringe < kFringe.count(); ++fringe) {
      const double at = grown - kFringe.at(fringe) * contour.outward + 0.5;
      float* sum = &sums[indexOf(0, growth, fringe)];
      for (int shift = 0; shift < kShift.count(); ++shift) {
        const int pixel = static_cast<int>(std::floor(at + by_shift * kShift.at(shift)));
        if (pixel < first || pixel > first + 2 * reach) continue;
        sum[shift] += std::min(kMaxRatio, gradient[pixel] / mean);
      }
    }
  }
}

/// Gradient along rows, averaged across them: contours are longer than that.
cv::Mat gradientOf(const cv::Mat& image) {
  cv::Mat gradient;
  cv::Sobel(image, gradient, CV_32F, 1, 0, 3, 0.125);
  return cv::abs(gradient);
}

}  // namespace

void RegistrationCheck::add(const StereoFrame& frame) {
  if (frames_.size() >= kMaxFrames || frame.disparity.empty()) return;
  Sums sums{std::vector<float>(kSums, 0.0F), std::vector<float>(kSums, 0.0F), 0};
  const auto& camera = *frame.camera;
  focal_px_ = camera.fx;
  width_px_ = camera.width;
  std::vector<double> depths;
  for (const bool is_down : {false, true}) {
    const cv::Mat disparity = is_down ? cv::Mat(frame.disparity.t()) : frame.disparity;
    const cv::Mat gradient = gradientOf(is_down ? cv::Mat(frame.left.t()) : frame.left);
    for (int row = 0; row < disparity.rows; row += kLineStep) {
      for (const Contour& contour : contoursOf(disparity, row)) {
        const double focal = is_down ? camera.fy : camera.fx;
        addContour(contour, gradient.ptr<float>(row), disparity.cols,
                   is_down ? camera.cy : camera.cx, focal / (camera.fx * camera.baseline_m),
                   is_down ? sums.down : sums.across, sums.contours);
        depths.push_back(camera.fx * camera.baseline_m / static_cast<double>(contour.disparity));
      }
    }
  }
  if (sums.contours == 0) return;
  depths_.push_back(median(depths));
  frames_.push_back(std::move(sums));
}

namespace {

/// Index of the maximum, refined by a parabola through its neighbours.
double vertexOf(const Axis& axis, int best, const std::array<double, 3>& around) {
  const double curvature = 2.0 * around[1] - around[0] - around[2];
  const double offset =
      curvature > 0.0 ? std::clamp(0.5 * (around[2] - around[0]) / curvature, -0.5, 0.5) : 0.0;
  return axis.at(best) + offset * axis.step();
}

}  // namespace

std::optional<Eigen::Vector3d> RegistrationCheck::best(const std::vector<const Sums*>& frames) {
  std::vector<float> across(kSums, 0.0F), down(kSums, 0.0F);
  for (const Sums* frame : frames) {
    for (std::size_t i = 0; i < kSums; ++i) {
      across[i] += frame->across[i];
      down[i] += frame->down[i];
    }
  }
  const auto at = [](const std::vector<float>& sums, int shift, int growth, int fringe) {
    return static_cast<double>(sums[indexOf(shift, growth, fringe)]);
  };
  const auto maximumOf = [&](const std::vector<float>& sums, int growth, int fringe) {
    const auto* begin = &sums[indexOf(0, growth, fringe)];
    return static_cast<int>(std::max_element(begin, begin + kShift.count()) - begin);
  };
  const auto sumOf = [&](int growth, int fringe) {
    return at(across, maximumOf(across, growth, fringe), growth, fringe) +
           at(down, maximumOf(down, growth, fringe), growth, fringe);
  };
  double most = 0.0;
  int growth = 0, fringe = 0;
  for (int i = 0; i < kGrowth.count(); ++i) {
    for (int j = 0; j < kFringe.count(); ++j) {
      if (sumOf(i, j) <= most) continue;
      most = sumOf(i, j), growth = i, fringe = j;
    }
  }
  const int x = maximumOf(across, growth, fringe), y = maximumOf(down, growth, fringe);
  for (const auto& [axis, i] : {std::pair(kGrowth, growth), {kShift, x}, {kShift, y}}) {
    if (i == 0 || i + 1 == axis.count()) return std::nullopt;  // may lie beyond
  }
  const auto shifted = [&](const std::vector<float>& sums, int i) {
    return vertexOf(kShift, i,
                    {at(sums, i - 1, growth, fringe), at(sums, i, growth, fringe),
                     at(sums, i + 1, growth, fringe)});
  };
  return Eigen::Vector3d(
      shifted(across, x), shifted(down, y),
      vertexOf(kGrowth, growth, {sumOf(growth - 1, fringe), most, sumOf(growth + 1, fringe)}));
}

std::optional<Registration> RegistrationCheck::result() const {
  std::size_t contours = 0;
  std::vector<const Sums*> all;
  for (const Sums& frame : frames_) {
    contours += frame.contours;
    all.push_back(&frame);
  }
  const auto found = contours < kMinContours ? std::nullopt : best(all);
  if (!found) return std::nullopt;
  std::mt19937 random(1);
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (int i = 0; i < kResampled; ++i) {
    std::vector<const Sums*> some;
    for (std::size_t k = 0; k < all.size(); ++k) some.push_back(all[random() % all.size()]);
    const auto other = best(some);
    if (!other) return std::nullopt;
    squares += (*other - *found).array().square();
  }
  const double shift = kFringeSigma_px * median(depths_) / focal_px_;
  const double growth = kFringeSigma_px / (0.25 * width_px_);
  Registration result{*found, {}};
  result.sigma =
      (squares / kResampled + Eigen::Array3d(shift, shift, growth).square()).sqrt().matrix();
  return result;
}

}  // namespace headway::import
