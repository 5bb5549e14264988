// SPDX-License-Identifier: BSD-3-Clause
// Depth and colour of the static surfaces in a frame, on a grid.
#include <headway/core/statistics.h>
#include <headway/detect/depth_scanner.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "left_out_cells.h"

namespace headway::detect {
namespace {

constexpr int kSumBlock = 2;                            // cells that are summed once [cells]
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
  const double max_square = square(kMaxOffset);
  if (du * du > max_square * uu || dv * dv > max_square * vv) return std::nullopt;
  const double slope_u = (vv * ud - uv * vd) / determinant;
  const double slope_v = (uu * vd - uv * ud) / determinant;
  const double variance = dd - slope_u * ud - slope_v * vd;
  const double max_noise = kMaxNoise * sigma_px;
  if (variance > max_noise * max_noise) return std::nullopt;
  return mean_d + slope_u * du + slope_v * dv;
}

/// Disparities smoothed and completed by local planes, whose disparities are linear in the image.
///
/// Block matching leaves most of plain surfaces unknown, and what it gives of them is noisy. A
/// plane is fitted by least squares to the known disparities in square windows around a cell, the
/// largest first. Where they agree with it, the cell takes the plane's disparity: a known one if it
/// agrees, too, and an unknown one if known ones surround it. At edges and creases no plane fits,
/// and the disparities stay as they are.
///
/// @see  Scharstein & Szeliski 2002, "A taxonomy and evaluation of dense two-frame stereo
///       correspondence algorithms", sec. 3.4 (holes are filled by fitting surfaces)
class PlanarDisparity {
 public:
  /// @param disparity  32-bit float [px]
  /// @param known      8-bit, non-zero where planes are fitted to it
  /// @param reliable   8-bit, non-zero where it is taken as it is if no plane fits
  /// @param sigma_px   noise of a disparity [px]
  PlanarDisparity(const cv::Mat& disparity, const cv::Mat& known, const cv::Mat& reliable,
                  double sigma_px)
      : disparity_(disparity),
        known_(known),
        reliable_(reliable),
        sigma_px_(sigma_px),
        columns_((disparity.cols + kSumBlock - 1) / kSumBlock),
        rows_((disparity.rows + kSumBlock - 1) / kSumBlock),
        integral_(static_cast<std::size_t>(columns_ + 1) * static_cast<std::size_t>(rows_ + 1)) {
    const auto stride = static_cast<std::size_t>(columns_ + 1);
    std::vector<Moments> line(static_cast<std::size_t>(columns_));
    for (int row = 0; row < disparity.rows; ++row) {
      if (row % kSumBlock == 0) std::fill(line.begin(), line.end(), Moments{});
      const auto* is_known = known.ptr<std::uint8_t>(row);
      const auto* values = disparity.ptr<float>(row);
      for (int column = 0; column < disparity.cols; ++column) {
        if (is_known[column] == 0) continue;
        const double u = column, v = row, d = static_cast<double>(values[column]);
        const Moments cell = {1.0, u, v, d, u * u, u * v, v * v, u * d, v * d, d * d};
        Moments& block = line[static_cast<std::size_t>(column / kSumBlock)];
        for (std::size_t i = 0; i < cell.size(); ++i) block[i] += cell[i];
      }
      if (row % kSumBlock + 1 != kSumBlock && row + 1 != disparity.rows) continue;
      Moments sum{};
      const std::size_t first = static_cast<std::size_t>(row / kSumBlock + 1) * stride;
      for (std::size_t column = 0; column < line.size(); ++column) {
        const std::size_t corner = first + column + 1;
        for (std::size_t i = 0; i < sum.size(); ++i) {
          sum[i] += line[column][i];
          integral_[corner][i] = integral_[corner - stride][i] + sum[i];
        }
      }
    }
  }

  /// Disparity in a cell [px]; 0 where it is unknown.
  [[nodiscard]] float at(int column, int row) const {
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

 private:
  /// Sums over known cells: 1, u, v, d, uu, uv, vv, ud, vd, dd.
  using Moments = std::array<double, 10>;

  [[nodiscard]] Moments momentsAround(int column, int row, int half_side) const {
    const auto corner = [&](int block_column, int block_row) -> const Moments& {
      return integral_[static_cast<std::size_t>(block_row) *
                           static_cast<std::size_t>(columns_ + 1) +
                       static_cast<std::size_t>(block_column)];
    };
    const auto block = [](int cell, int blocks) { return std::clamp(cell / kSumBlock, 0, blocks); };
    const int left = block(column - half_side, columns_),
              right = block(column + half_side, columns_);
    const int top = block(row - half_side, rows_), bottom = block(row + half_side, rows_);
    Moments sums{};
    for (std::size_t i = 0; i < sums.size(); ++i) {
      sums[i] = corner(right, bottom)[i] - corner(left, bottom)[i] - corner(right, top)[i] +
                corner(left, top)[i];
    }
    return sums;
  }

  cv::Mat disparity_;
  cv::Mat known_;
  cv::Mat reliable_;
  double sigma_px_;
  int columns_, rows_;             ///< of blocks of 2 x 2 cells
  std::vector<Moments> integral_;  ///< of the blocks above and left of each corner of a block
};

constexpr int kMaxCells = 10'000;
constexpr double kMinStepPx = 2.0;        // of the disparity, at the edge of a foreground ...
constexpr double kMinStepRatio = 0.08;    // ... or as a ratio of it
constexpr double kMaxGroundStepPx = 4.0;  // of the ground's disparity in half a block

/// Steps between the cells of a scan, in cells of the disparity image. Rows are denser, because
/// the ground before a camera is seen at a grazing angle.
constexpr std::array<std::array<int, 2>, 8> kSteps{
    {{1, 1}, {2, 1}, {3, 1}, {3, 2}, {4, 2}, {5, 3}, {6, 4}, {8, 6}}};

/// Cells of disparities that are not much greater than the least one around, which is taken from
/// `around`: 8-bit, non-zero.
cv::Mat withoutSteps(const cv::Mat& values, const cv::Mat& around) {
  cv::Mat farthest;
  cv::erode(around, farthest,
            cv::getStructuringElement(cv::MORPH_RECT, {kSmearedCells, kSmearedCells}));
  const cv::Mat step = values - farthest;
  cv::Mat without = (step <= kMinStepPx) | (step <= kMinStepRatio * values);
  without &= values > 0.0;
  return without;
}

/// Cells whose disparity is that of the ground: matched along it, and not of an obstacle before it.
cv::Mat groundCells(const cv::Mat& values, const cv::Mat& ground) {
  const cv::Mat nearer = values - ground;
  const cv::Mat agrees = (values <= 0.0F) | (cv::abs(nearer) <= kMaxGroundStepPx);
  cv::Mat cells = agrees & (ground > 0.0F);
  return cells;
}

/// The disparities with those of the ground, without what is left out.
PlanarDisparity planarDisparity(const stereo::DisparityImage& disparity,
                                const stereo::DisparityImage& ground, const cv::Mat& left_out,
                                double sigma_px) {
  cv::Mat values = disparity.values.clone();
  cv::Mat on_ground;
  if (!ground.empty()) {
    on_ground = groundCells(values, ground.values);
    ground.values.copyTo(values, on_ground);
  }
  values.setTo(0.0F, left_out);
  cv::Mat known_around = values.clone();
  known_around.setTo(std::numeric_limits<float>::max(), values <= 0.0F);
  cv::Mat reliable = withoutSteps(values, values);
  if (!on_ground.empty()) reliable |= on_ground & (values > 0.0F);
  return {values, withoutSteps(values, known_around), reliable, sigma_px};
}

std::array<int, 2> stepsFor(int cells) {
  for (const auto& steps : kSteps) {
    if (cells <= kMaxCells * steps[0] * steps[1]) return steps;
  }
  return kSteps.back();
}

DepthScanGrid gridOf(const StereoCamera& camera, const stereo::DisparityImage& disparity,
                     const std::array<int, 2>& steps, double sigma_disparity_px) {
  DepthScanGrid grid;
  grid.columns = disparity.values.cols / steps[0];
  grid.rows = disparity.values.rows / steps[1];
  grid.u0 = disparity.pixelOf(steps[0] / 2);
  grid.v0 = disparity.pixelOf(steps[1] / 2);
  grid.step_u = steps[0] * disparity.reduce;
  grid.step_v = steps[1] * disparity.reduce;
  grid.fx = camera.fx;
  grid.fy = camera.fy;
  grid.cx = camera.cx;
  grid.cy = camera.cy;
  grid.focal_baseline = camera.fx * camera.baseline_m;
  grid.sigma_disparity_px = sigma_disparity_px;
  grid.T_robot_cam = camera.T_robot_cam;
  return grid;
}

/// The image on the grid of a scan, each cell the mean of its pixels.
cv::Mat coloursOf(const StereoFrame& frame, const DepthScanGrid& grid) {
  const cv::Mat& image = frame.left_colour.empty() ? frame.left : frame.left_colour;
  const cv::Rect covered(0, 0, grid.columns * static_cast<int>(grid.step_u),
                         grid.rows * static_cast<int>(grid.step_v));
  cv::Mat colours;
  cv::resize(image(covered), colours, {grid.columns, grid.rows}, 0, 0, cv::INTER_AREA);
  if (colours.channels() == 3) cv::cvtColor(colours, colours, cv::COLOR_BGR2RGB);
  return colours;
}

}  // namespace

DepthScan scanDepth(const StereoFrame& frame, const stereo::DisparityImage& disparity,
                    const stereo::DisparityImage& ground, const MovingRegions& moving,
                    const stereo::RigCapability& rig) {
  const auto min_disparity = static_cast<float>(rig.focal_baseline / rig.dense_to_m);
  const auto max_disparity =  // as stored
      static_cast<float>(std::numeric_limits<std::uint16_t>::max() / DepthScan::kUnitsPerPx);
  const cv::Mat left_out = leftOutCells(moving, disparity, rig.focal_baseline);
  const auto planar = planarDisparity(disparity, ground, left_out, rig.sigma_disparity_px);
  const auto steps = stepsFor(static_cast<int>(left_out.total()) - cv::countNonZero(left_out));
  DepthScan scan;
  scan.time = frame.time;
  scan.grid = gridOf(*frame.camera, disparity, steps, rig.sigma_disparity_px);
  scan.known.assign((scan.grid.cells() + 7) / 8, 0);
  if (scan.grid.cells() == 0) return scan;
  const cv::Mat colours = coloursOf(frame, scan.grid);
  const auto channels = static_cast<std::size_t>(colours.channels());
  std::size_t cell = 0;
  for (int row = 0; row < scan.grid.rows; ++row) {
    const int from_row = row * steps[1] + steps[1] / 2;
    const auto* is_left_out = left_out.ptr<std::uint8_t>(from_row);
    const auto* colour = colours.ptr<std::uint8_t>(row);
    for (int column = 0; column < scan.grid.columns; ++column, ++cell, colour += channels) {
      const int from = column * steps[0] + steps[0] / 2;
      if (is_left_out[from] != 0) continue;
      const float value = planar.at(from, from_row);
      if (!(value >= min_disparity && value < max_disparity)) continue;
      scan.known[cell / 8] |= static_cast<std::uint8_t>(1U << (cell % 8));
      scan.disparity.push_back(static_cast<std::uint16_t>(
          std::lround(static_cast<double>(value) * DepthScan::kUnitsPerPx)));
      scan.colour.insert(scan.colour.end(), colour, colour + channels);
    }
  }
  return scan;
}

}  // namespace headway::detect
