// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/output_file.h>
#include <headway/map/object_file.h>
#include <headway/map/static_grid.h>

#include <cstdint>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <vector>

namespace headway::map {
namespace {

// Thresholds of map servers: free below 0.196, occupied above 0.65 of darkness.
constexpr float kFree = 0.804f;
constexpr float kOccupied = 0.35f;
constexpr std::uint8_t kFreeGrey = 254, kUnknownGrey = 205, kOccupiedGrey = 0;

std::uint8_t greyOf(float free_probability) {
  if (free_probability > kFree) return kFreeGrey;
  return free_probability < kOccupied ? kOccupiedGrey : kUnknownGrey;
}

void writePicture(const std::string& path, const mrpt::maps::COccupancyGridMap2D& grid) {
  const int width = static_cast<int>(grid.getSizeX());
  const int height = static_cast<int>(grid.getSizeY());
  cv::Mat_<std::uint8_t> picture(height, width);
  for (int y = 0; y < height; ++y) {
    auto* row = picture[height - 1 - y];
    for (int x = 0; x < width; ++x) row[x] = greyOf(grid.getCell(x, y));
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  writeFile(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

void writeDescription(const std::string& path, const std::string& picture,
                      const mrpt::maps::COccupancyGridMap2D& grid) {
  std::ostringstream text;
  text << "image: " << picture << "\nresolution: " << grid.getResolution() << "\norigin: ["
       << grid.getXMin() << ", " << grid.getYMin() << ", 0.0]\nnegate: 0\n"
       << "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
  writeFile(path, text.str());
}

}  // namespace

void writeStaticGrid(const std::string& prefix, const mrpt::maps::COccupancyGridMap2D& grid) {
  writeObject(prefix + ".gridmap.gz", grid);
  writePicture(prefix + ".png", grid);
  writeDescription(prefix + ".yaml", std::filesystem::path(prefix).filename().string() + ".png",
                   grid);
}

}  // namespace headway::map
