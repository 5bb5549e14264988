// SPDX-License-Identifier: BSD-3-Clause
#include "depth_scan_bytes.h"

#include <cstring>

#include "stored_values.h"

namespace headway::map {
namespace {

constexpr std::int32_t kMaxSide = 16384;  // of a grid [cells]
constexpr double kMaxDepthM = 300.0;

template <typename Item>
void writeItems(ByteWriter& out, const std::vector<Item>& items) {
  out.bytes.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
}

template <typename Item>
std::vector<Item> readItems(ByteReader& in, std::size_t count) {
  const auto bytes = in.take(count * sizeof(Item));
  std::vector<Item> items(count);
  if (count > 0) std::memcpy(items.data(), bytes.data(), bytes.size());
  return items;
}

void write(ByteWriter& out, const DepthScanGrid& grid) {
  out.value(grid.columns);
  out.value(grid.rows);
  for (const double value : {grid.u0, grid.v0, grid.step_u, grid.step_v, grid.fx, grid.fy, grid.cx,
                             grid.cy, grid.focal_baseline, grid.sigma_disparity_px}) {
    out.value(value);
  }
  map::write(out, grid.T_robot_cam);
}

DepthScanGrid readGrid(ByteReader& in) {
  DepthScanGrid grid;
  grid.columns = in.value<std::int32_t>();
  grid.rows = in.value<std::int32_t>();
  for (double* value : {&grid.u0, &grid.v0, &grid.step_u, &grid.step_v, &grid.fx, &grid.fy,
                        &grid.cx, &grid.cy, &grid.focal_baseline, &grid.sigma_disparity_px}) {
    *value = in.finiteValue<double>();
  }
  grid.T_robot_cam = readPose(in);
  const bool has_size =
      grid.columns > 0 && grid.rows > 0 && grid.columns <= kMaxSide && grid.rows <= kMaxSide;
  const bool has_camera = grid.step_u > 0.0 && grid.step_v > 0.0 && grid.fx > 0.0 &&
                          grid.fy > 0.0 && grid.focal_baseline > 0.0 &&
                          grid.sigma_disparity_px > 0.0 && grid.T_robot_cam.matrix().allFinite();
  if (!has_size || !has_camera) throw InputError("damaged: a depth scan has no camera");
  return grid;
}

std::size_t countKnown(const DepthScan& scan) {
  std::size_t known = 0;
  for (std::size_t cell = 0; cell < scan.grid.cells(); ++cell) known += scan.isKnown(cell) ? 1 : 0;
  return known;
}

/// Refuses what would take any amount of memory: its points lie farther away than a camera sees.
void requireWithinReach(const DepthScan& scan) {
  for (const auto disparity : scan.disparity) {
    const double depth = scan.grid.focal_baseline * DepthScan::kUnitsPerPx / disparity;
    if (disparity == 0 || !(depth < kMaxDepthM)) {
      throw InputError("damaged: a depth scan reaches farther than any camera");
    }
  }
}

}  // namespace

void write(ByteWriter& out, const DepthScan& scan) {
  write(out, scan.grid);
  out.value(static_cast<std::uint8_t>(scan.hasColour() ? 3 : 1));
  writeItems(out, scan.known);
  writeItems(out, scan.disparity);
  writeItems(out, scan.colour);
}

DepthScan readDepthScan(ByteReader& in) {
  DepthScan scan;
  scan.grid = readGrid(in);
  const std::size_t channels = in.value<std::uint8_t>();
  if (channels != 1 && channels != 3) throw InputError("damaged: a depth scan has no colours");
  scan.known = readItems<std::uint8_t>(in, (scan.grid.cells() + 7) / 8);
  const std::size_t count = countKnown(scan);
  if (count == 0) throw InputError("damaged: a depth scan has no depths");
  scan.disparity = readItems<std::uint16_t>(in, count);
  scan.colour = readItems<std::uint8_t>(in, channels * count);
  requireWithinReach(scan);
  return scan;
}

}  // namespace headway::map
