// SPDX-License-Identifier: BSD-3-Clause
// Videos as images of a camera, by OpenCV, which decodes them with FFmpeg: therefore no part of io.
#include <headway/core/error.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <opencv2/videoio.hpp>

#include "commands.h"

namespace headway::import {
namespace {

/// Frames are decoded in order; an earlier one is reached by opening the file again.
class Video : public io::ImageSequence {
 public:
  explicit Video(const std::string& path) : path_(path) {
    open();
    while (capture_.grab()) times_.push_back(1e-3 * capture_.get(cv::CAP_PROP_POS_MSEC));
    size_ = times_.size();
    const auto is_late = [](Time a, Time b) { return !(b > a); };
    if (std::adjacent_find(times_.begin(), times_.end(), is_late) != times_.end()) times_.clear();
    if (size_ == 0) throw InputError(path + ": contains no images that OpenCV decodes");
    open();
  }

  [[nodiscard]] const std::string& name() const override { return path_; }
  [[nodiscard]] std::size_t size() const override { return size_; }
  [[nodiscard]] std::string nameOf(std::size_t index) const override {
    return path_ + ", image " + std::to_string(index);
  }
  [[nodiscard]] cv::Mat image(std::size_t index) const override {
    if (index < next_) open();
    while (next_ < index && capture_.grab()) ++next_;
    cv::Mat image;
    if (!capture_.read(image) || image.depth() != CV_8U) {
      throw InputError(nameOf(index) + ": cannot be decoded");
    }
    ++next_;
    return image.clone();  // the decoder uses its memory again
  }
  [[nodiscard]] const std::vector<Time>& times() const override { return times_; }

 private:
  void open() const {
    next_ = 0;
    if (capture_.open(path_)) return;
    const std::string pointer = io::lfsPointerFault(path_);
    throw InputError(path_ + ": " +
                     (pointer.empty() ? "is no video that OpenCV can open" : pointer));
  }

  std::string path_;
  mutable cv::VideoCapture capture_;
  mutable std::size_t next_ = 0;  ///< index of the image that is decoded next
  std::size_t size_ = 0;
  std::vector<Time> times_;  ///< of the container
};

}  // namespace

std::unique_ptr<io::ImageSequence> openImages(const std::string& path) {
  if (std::filesystem::is_regular_file(path)) return std::make_unique<Video>(path);
  return io::imagesOfFolder(path);
}

}  // namespace headway::import
