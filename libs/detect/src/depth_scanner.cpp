// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/depth_scanner.h>

#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "left_out_cells.h"

namespace headway::detect {
namespace {

constexpr int kMaxKnownCells = 20'000;
constexpr int kBorderCells = 2;         // of a block of the matcher
constexpr double kMinStepPx = 2.0;      // of the disparity, at the edge of a foreground ...
constexpr double kMinStepRatio = 0.08;  // ... or as a ratio of it

/// Steps between the cells of a scan, in cells of the disparity image. Rows are denser, because
/// the ground before a camera is seen at a grazing angle.
constexpr std::array<std::array<int, 2>, 8> kSteps{
    {{1, 1}, {2, 1}, {3, 1}, {3, 2}, {4, 2}, {5, 3}, {6, 4}, {8, 6}}};

/// Cells with a reliable depth: 8-bit, non-zero.
cv::Mat reliableCells(const stereo::DisparityImage& disparity, const MovingRegions& moving,
                      double min_disparity) {
  const cv::Mat& values = disparity.values;
  const int side = 2 * kBorderCells + 1;
  cv::Mat farthest;
  cv::erode(values, farthest, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  const double max_px =
      std::numeric_limits<std::uint16_t>::max() / DepthScan::kUnitsPerPx;  // as stored
  cv::Mat reliable = (values >= min_disparity) & (values < max_px);
  const cv::Mat step = values - farthest;
  reliable &= (step <= kMinStepPx) | (step <= kMinStepRatio * values);
  reliable.setTo(0, leftOutCells(moving, disparity));
  return reliable;
}

std::array<int, 2> stepsFor(int known_cells) {
  for (const auto& steps : kSteps) {
    if (known_cells <= kMaxKnownCells * steps[0] * steps[1]) return steps;
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
                    const MovingRegions& moving, const stereo::RigCapability& rig) {
  const StereoCamera& camera = *frame.camera;
  const double min_disparity = rig.focal_baseline / rig.dense_to_m;
  const cv::Mat reliable = reliableCells(disparity, moving, min_disparity);
  const auto steps = stepsFor(cv::countNonZero(reliable));
  DepthScan scan;
  scan.grid = gridOf(camera, disparity, steps, rig.sigma_disparity_px);
  scan.known.assign((scan.grid.cells() + 7) / 8, 0);
  if (scan.grid.cells() == 0) return scan;
  const cv::Mat colours = coloursOf(frame, scan.grid);
  const auto channels = static_cast<std::size_t>(colours.channels());
  std::size_t cell = 0;
  for (int row = 0; row < scan.grid.rows; ++row) {
    const int from_row = row * steps[1] + steps[1] / 2;
    const auto* is_reliable = reliable.ptr<std::uint8_t>(from_row);
    const auto* values = disparity.values.ptr<float>(from_row);
    const auto* colour = colours.ptr<std::uint8_t>(row);
    for (int column = 0; column < scan.grid.columns; ++column, ++cell, colour += channels) {
      const int from = column * steps[0] + steps[0] / 2;
      if (is_reliable[from] == 0) continue;
      scan.known[cell / 8] |= static_cast<std::uint8_t>(1U << (cell % 8));
      scan.disparity.push_back(static_cast<std::uint16_t>(
          std::lround(static_cast<double>(values[from]) * DepthScan::kUnitsPerPx)));
      scan.colour.insert(scan.colour.end(), colour, colour + channels);
    }
  }
  return scan;
}

}  // namespace headway::detect
