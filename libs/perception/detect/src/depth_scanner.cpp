// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/depth_scanner.h>

#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "left_out_cells.h"
#include "planar_disparity.h"

namespace headway::detect {
namespace {

constexpr int kMaxCells = 10'000;
constexpr int kBorderCells = 2;           // of a block of the matcher
constexpr double kMinStepPx = 2.0;        // of the disparity, at the edge of a foreground ...
constexpr double kMinStepRatio = 0.08;    // ... or as a ratio of it
constexpr double kMaxGroundStepPx = 4.0;  // of the ground's disparity in half a block

/// Steps between the cells of a scan, in cells of the disparity image. Rows are denser, because
/// the ground before a camera is seen at a grazing angle.
constexpr std::array<std::array<int, 2>, 8> kSteps{
    {{1, 1}, {2, 1}, {3, 1}, {3, 2}, {4, 2}, {5, 3}, {6, 4}, {8, 6}}};

/// As stored.
constexpr auto kMaxDisparityPx =
    static_cast<float>(std::numeric_limits<std::uint16_t>::max() / DepthScan::kUnitsPerPx);

/// Cells of disparities that are not much greater than the least one around, which is taken from
/// `around`: 8-bit, non-zero.
cv::Mat withoutSteps(const cv::Mat& values, const cv::Mat& around) {
  const int side = 2 * kBorderCells + 1;
  cv::Mat farthest;
  cv::erode(around, farthest, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
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
      if (!(value >= min_disparity && value < kMaxDisparityPx)) continue;
      scan.known[cell / 8] |= static_cast<std::uint8_t>(1U << (cell % 8));
      scan.disparity.push_back(static_cast<std::uint16_t>(
          std::lround(static_cast<double>(value) * DepthScan::kUnitsPerPx)));
      scan.colour.insert(scan.colour.end(), colour, colour + channels);
    }
  }
  return scan;
}

}  // namespace headway::detect
