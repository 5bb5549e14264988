#include "dataset_files.h"

#include <headway/core/error.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "recorded_image.h"
#include "text_rows.h"

namespace headway::io {

namespace fs = std::filesystem;

std::vector<std::string> imagesIn(const std::string& folder) {
  static const std::set<std::string> endings = {".png", ".jpg",  ".jpeg", ".bmp",
                                                ".tif", ".tiff", ".pgm",  ".ppm"};
  std::error_code error;
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (endings.count(entry.path().extension().string()) > 0) {
      paths.push_back(entry.path().string());
    }
  }
  if (error) throw InputError(folder + ": is not a folder that can be read: " + error.message());
  std::sort(paths.begin(), paths.end());
  return paths;
}

cv::Mat requireImage(const std::string& path) {
  cv::Mat image = loadImage(path);
  if (image.empty()) {
    throw InputError(path + ": is missing, broken, or not an image of 8 bits a channel");
  }
  return image;
}

std::vector<Time> readTimes(const std::string& path) {
  std::vector<Time> times;
  TextRows rows(path);
  while (rows.next()) times.push_back(rows.number(0));
  return times;
}

}  // namespace headway::io
