// SPDX-License-Identifier: BSD-3-Clause
// Images of a folder or a rawlog: where they are, and what is wrong with one that cannot be used.
#include "image_files.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/image_file.h>
#include <headway/io/rawlog_source.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string_view>
#include <vector>

#include "text_rows.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDeepImage = "image_16_bit";

void requireSizeOf(const cv::Mat& image, const std::string& path, const RawCamera& lens) {
  if (image.size() == cv::Size(lens.width, lens.height)) return;
  throw InputError(path + ": has " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                   " px, but the calibration is of images of " + std::to_string(lens.width) + "x" +
                   std::to_string(lens.height) + " px");
}

void requireNoPointer(const cv::Mat& image, const std::string& path) {
  const std::string fault = image.empty() ? lfsPointerFault(path) : "";
  if (!fault.empty()) throw InputError(path + ": " + fault);
}

}  // namespace

bool isInside(const std::filesystem::path& folder, const std::filesystem::path& path) {
  std::error_code ignored;
  const fs::path root = fs::weakly_canonical(folder, ignored);
  const fs::path target = fs::weakly_canonical(path, ignored);
  return !root.empty() &&
         std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first == root.end();
}

std::string imageFolderOf(const std::string& rawlog) {
  const fs::path folder = fs::path(rawlog).parent_path();
  const std::string stem = fs::path(rawlogStem(rawlog)).filename().string();
  const std::string whole = fs::path(rawlog).stem().string();  // X.rawlog of X.rawlog.gz
  std::error_code ignored;
  for (const std::string& name :
       {stem + "_Images", stem + "_images", stem + "_IMAGES", whole + "_Images", whole + "_images",
        whole + "_IMAGES", std::string("Images")}) {
    if (fs::is_directory(folder / name, ignored)) return (folder / name).string();
  }
  return (folder / (stem + "_Images")).string();
}

std::variant<cv::Mat, std::string> pixelsOf(const mrpt::img::CImage& image,
                                            const std::string& image_folder) {
  cv::Mat pixels;
  if (image.isExternallyStored()) {
    const fs::path path = fs::path(image_folder) / image.getExternalStorageFile();
    std::error_code ignored;
    if (!isInside(image_folder, path)) return std::string("image_outside_folder");
    if (!fs::is_regular_file(path, ignored)) return std::string("missing_image");
    pixels = loadImage(path.string());
    if (pixels.empty() && isDeepImageFile(path.string())) return std::string(kDeepImage);
  } else if (!image.isEmpty()) {
    pixels = image.asCvMatRef();
    if (pixels.depth() == CV_16U) return std::string(kDeepImage);
    if (pixels.type() == CV_8UC4) cv::cvtColor(pixels, pixels, cv::COLOR_BGRA2BGR);
    if (pixels.type() != CV_8UC1 && pixels.type() != CV_8UC3) pixels.release();
  }
  if (pixels.empty()) return std::string("broken_image");
  return pixels;
}

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
  if (error) throw InputError(folder + ": is not a readable folder: " + error.message());
  std::sort(paths.begin(), paths.end(), isNaturallyBefore);
  return paths;
}

std::string lfsPointerFault(const std::string& path) {
  constexpr std::string_view kBegin = "version https://git-lfs.github.com/spec/";  // of pointers
  std::string begin(kBegin.size(), '\0');
  std::ifstream(path, std::ios::binary).read(begin.data(), kBegin.size());
  return begin == kBegin ? "is a Git-LFS pointer, not the file itself: run git lfs pull" : "";
}

cv::Mat requireImage(const std::string& path) {
  cv::Mat image = loadImage(path);
  requireNoPointer(image, path);
  if (image.empty() && isDeepImageFile(path)) {
    throw InputError(path +
                     ": has 16 bits per channel, of which headway reads 8: convert the "
                     "images, such as by: mogrify -depth 8 -normalize *.png");
  }
  if (image.empty()) {
    throw InputError(path + ": missing, broken, or not an image with 8 bits per channel");
  }
  return image;
}

cv::Mat requireImageOf(const std::string& path, const RawCamera& lens) {
  cv::Mat image = requireImage(path);
  requireSizeOf(image, path, lens);
  return image;
}

cv::Mat requireDepthImageOf(const std::string& path, const RawCamera& lens) {
  cv::Mat depth = loadDepthImage(path);
  requireNoPointer(depth, path);
  if (depth.empty()) {
    throw InputError(path +
                     ": missing, broken, or not a PNG with 16 bits and one channel, as a "
                     "depth image is");
  }
  requireSizeOf(depth, path, lens);
  return depth;
}

RawStereoCamera leftAlone(const RawDepthCamera& camera) {
  RawStereoCamera result;
  result.left = result.right = camera.color;
  result.T_robot_left = camera.T_robot_color;
  return result;
}

std::vector<Time> readTimes(const std::string& path) {
  std::vector<Time> times;
  TextRows rows(path);
  while (rows.next()) {
    times.push_back(rows.number(0));
    if (!std::isfinite(times.back())) rows.fail("the time is not a number");
  }
  return times;
}

void requireTimesFor(std::size_t images, const std::string& path, const std::vector<Time>& times) {
  if (times.size() >= images) return;
  throw InputError(path + ": has " + std::to_string(times.size()) + " times for " +
                   std::to_string(images) + " images");
}

std::vector<std::array<std::size_t, 2>> pairedByTime(const std::vector<Time>& times,
                                                     const std::vector<Time>& others,
                                                     double max_gap_s) {
  std::vector<std::array<std::size_t, 2>> pairs;
  std::size_t next = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto gap = [&](std::size_t other) { return std::abs(others[other] - times[i]); };
    while (next < others.size() && others[next] < times[i] - max_gap_s) ++next;
    std::size_t nearest = next;
    while (nearest + 1 < others.size() && gap(nearest + 1) < gap(nearest)) ++nearest;
    if (nearest >= others.size() || gap(nearest) > max_gap_s) continue;
    pairs.push_back({i, nearest});
    next = nearest + 1;
  }
  return pairs;
}

std::vector<Time> unpairedTimes(const std::vector<Time>& times,
                                const std::vector<std::array<std::size_t, 2>>& pairs,
                                std::size_t side) {
  std::vector<Time> unpaired;
  std::size_t next = 0;  // pair, in order of both sides
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (next < pairs.size() && pairs[next][side] == i) {
      ++next;
    } else {
      unpaired.push_back(times[i]);
    }
  }
  return unpaired;
}

}  // namespace headway::io
