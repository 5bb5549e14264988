// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of encoded images: JPEG, PNG, BMP, PNM and TIFF.
#include <headway/io/image_file.h>

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <stdexcept>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const cv::Mat image = headway::io::decodeImage({reinterpret_cast<const char*>(data), size});
  const bool is_usable = image.empty() || image.type() == CV_8UC1 || image.type() == CV_8UC3;
  if (!is_usable || image.total() > headway::io::kMaxImagePixels) {
    throw std::logic_error("an image beyond the limits");
  }
  return 0;
}
