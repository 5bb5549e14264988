// SPDX-License-Identifier: BSD-3-Clause
#include "planar_disparity.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace headway::detect {
namespace {

constexpr int kBlock = 2;                               // cells that are summed once [cells]
constexpr std::array<int, 3> kHalfSides = {24, 12, 6};  // of the windows [cells]
constexpr double kMinKnownRatio = 0.08;                 // of a window
constexpr double kMaxOffset = 0.6;    // of a cell from the middle of known ones [their deviations]
constexpr double kMinSpread = 0.3;    // standard deviation of the known ones [half sides]
constexpr double kMaxNoise = 1.25;    // of disparities that agree with a plane [sigmas]
constexpr double kSameSurface = 3.0;  // a known disparity from the plane of its window [sigmas]

/// The plane's disparity in a cell at (u, v); nullopt if the disparities are not of a plane, or do
/// not surround the cell.
std::optional<double> planeAt(const std::array<double, 10>& sums, double u, double v,
                              double half_side, double sigma_px) {
  const double n = sums[0];
  const double side = 2.0 * half_side;
  if (n < kMinKnownRatio * side * side) return std::nullopt;
  const double mean_u = sums[1] / n, mean_v = sums[2] / n, mean_d = sums[3] / n;
  const double uu = sums[4] / n - mean_u * mean_u;
  const double uv = sums[5] / n - mean_u * mean_v;
  const double vv = sums[6] / n - mean_v * mean_v;
  const double ud = sums[7] / n - mean_u * mean_d;
  const double vd = sums[8] / n - mean_v * mean_d;
  const double dd = sums[9] / n - mean_d * mean_d;
  const double min_variance = kMinSpread * kMinSpread * half_side * half_side;
  const double determinant = uu * vv - uv * uv;
  if (uu < min_variance || vv < min_variance || determinant < 0.3 * uu * vv) return std::nullopt;
  const double du = u - mean_u, dv = v - mean_v;
  constexpr double kMaxSquare = kMaxOffset * kMaxOffset;
  if (du * du > kMaxSquare * uu || dv * dv > kMaxSquare * vv) return std::nullopt;
  const double slope_u = (vv * ud - uv * vd) / determinant;
  const double slope_v = (uu * vd - uv * ud) / determinant;
  const double variance = dd - slope_u * ud - slope_v * vd;
  const double max_noise = kMaxNoise * sigma_px;
  if (variance > max_noise * max_noise) return std::nullopt;
  return mean_d + slope_u * du + slope_v * dv;
}

}  // namespace

PlanarDisparity::PlanarDisparity(const cv::Mat& disparity, const cv::Mat& known,
                                 const cv::Mat& reliable, double sigma_px)
    : disparity_(disparity),
      known_(known),
      reliable_(reliable),
      sigma_px_(sigma_px),
      columns_((disparity.cols + kBlock - 1) / kBlock),
      rows_((disparity.rows + kBlock - 1) / kBlock),
      integral_(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1)) {
  const auto stride = static_cast<std::size_t>(columns_ + 1);
  std::vector<Moments> line(static_cast<std::size_t>(columns_));
  for (int row = 0; row < disparity.rows; ++row) {
    if (row % kBlock == 0) std::fill(line.begin(), line.end(), Moments{});
    const auto* is_known = known.ptr<std::uint8_t>(row);
    const auto* values = disparity.ptr<float>(row);
    for (int column = 0; column < disparity.cols; ++column) {
      if (is_known[column] == 0) continue;
      const double u = column, v = row, d = static_cast<double>(values[column]);
      const Moments cell = {1.0, u, v, d, u * u, u * v, v * v, u * d, v * d, d * d};
      Moments& block = line[static_cast<std::size_t>(column / kBlock)];
      for (std::size_t i = 0; i < cell.size(); ++i) block[i] += cell[i];
    }
    if (row % kBlock + 1 != kBlock && row + 1 != disparity.rows) continue;
    Moments sum{};
    const std::size_t first = static_cast<std::size_t>(row / kBlock + 1) * stride;
    for (std::size_t column = 0; column < line.size(); ++column) {
      const std::size_t corner = first + column + 1;
      for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] += line[column][i];
        integral_[corner][i] = integral_[corner - stride][i] + sum[i];
      }
    }
  }
}

PlanarDisparity::Moments PlanarDisparity::momentsAround(int column, int row, int half_side) const {
  const auto corner = [&](int block_column, int block_row) -> const Moments& {
    return integral_[static_cast<std::size_t>(block_row) * static_cast<std::size_t>(columns_ + 1) +
                     static_cast<std::size_t>(block_column)];
  };
  const auto block = [](int cell, int blocks) { return std::clamp(cell / kBlock, 0, blocks); };
  const int left = block(column - half_side, columns_), right = block(column + half_side, columns_);
  const int top = block(row - half_side, rows_), bottom = block(row + half_side, rows_);
  Moments sums{};
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] = corner(right, bottom)[i] - corner(left, bottom)[i] - corner(right, top)[i] +
              corner(left, top)[i];
  }
  return sums;
}

float PlanarDisparity::at(int column, int row) const {
  const bool is_known = known_.at<std::uint8_t>(row, column) != 0;
  const float value = disparity_.at<float>(row, column);
  for (const int half_side : kHalfSides) {
    const auto plane =
        planeAt(momentsAround(column, row, half_side), column, row, half_side, sigma_px_);
    if (!plane) continue;
    const double off = std::abs(*plane - static_cast<double>(value));
    if (!is_known || off <= kSameSurface * sigma_px_) return static_cast<float>(*plane);
  }
  return reliable_.at<std::uint8_t>(row, column) != 0 ? value : 0.0F;
}

}  // namespace headway::detect
