// SPDX-License-Identifier: BSD-3-Clause
#include <headway/report/page_images.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::report {
namespace {

constexpr std::size_t kMaxImages = 160;
constexpr int kImageWidth = 448;  // [px]; about 15 kB each
constexpr int kImageQuality = 65;

std::vector<std::uint8_t> smallJpeg(const cv::Mat& image) {
  cv::Mat small = image;
  if (image.cols > kImageWidth) {
    const double scale = static_cast<double>(kImageWidth) / image.cols;
    cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
  }
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", small, jpeg, {cv::IMWRITE_JPEG_QUALITY, kImageQuality});
  return jpeg;
}

}  // namespace

void PageImages::add(std::size_t frame, const cv::Mat& image) {
  if (image.empty() || added_++ % step_ != 0) return;
  jpegs_[frame] = smallJpeg(image);
  if (jpegs_.size() <= kMaxImages) return;
  std::size_t position = 0;
  for (auto jpeg = jpegs_.begin(); jpeg != jpegs_.end(); ++position) {
    jpeg = position % 2 == 0 ? std::next(jpeg) : jpegs_.erase(jpeg);
  }
  step_ *= 2;
}

}  // namespace headway::report
