#include <headway/core/error.h>
#include <headway/map/static_grid.h>
#include <mrpt/img/CImage.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/serialization/CArchive.h>

#include <filesystem>
#include <fstream>

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
  mrpt::img::CImage picture(width, height, mrpt::img::CH_GRAY);
  for (int y = 0; y < height; ++y) {
    auto* row = picture.ptrLine<std::uint8_t>(static_cast<unsigned>(height - 1 - y));
    for (int x = 0; x < width; ++x) row[x] = greyOf(grid.getCell(x, y));
  }
  if (!picture.saveToFile(path)) throw InputError(path + ": cannot be written");
}

void writeDescription(const std::string& path, const std::string& picture,
                      const mrpt::maps::COccupancyGridMap2D& grid) {
  std::ofstream file(path);
  file << "image: " << picture << "\nresolution: " << grid.getResolution() << "\norigin: ["
       << grid.getXMin() << ", " << grid.getYMin() << ", 0.0]\nnegate: 0\n"
       << "occupied_thresh: 0.65\nfree_thresh: 0.196\n";
  file.close();
  if (!file) throw InputError(path + ": cannot be written");
}

}  // namespace

void writeStaticGrid(const std::string& prefix, const mrpt::maps::COccupancyGridMap2D& grid) {
  const std::string path = prefix + ".gridmap.gz";
  mrpt::io::CFileGZOutputStream stream;
  if (!stream.open(path)) throw InputError(path + ": cannot be written");
  mrpt::serialization::archiveFrom(stream) << grid;
  stream.close();
  writePicture(prefix + ".png", grid);
  writeDescription(prefix + ".yaml", std::filesystem::path(prefix).filename().string() + ".png",
                   grid);
}

}  // namespace headway::map
