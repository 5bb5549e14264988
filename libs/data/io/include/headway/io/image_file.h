// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::io {

/// An image file as decodeImage() returns it; empty if it is missing or broken.
[[nodiscard]] cv::Mat loadImage(const std::string& path);

/// The same as 8-bit grey.
[[nodiscard]] cv::Mat loadGreyImage(const std::string& path);

/// A PNG with 16 bits and one channel; empty if it is missing, broken or another one.
[[nodiscard]] cv::Mat loadDepthImage(const std::string& path);

/// Whether the file is an image of 16 bits per channel, which loadImage() does not read.
[[nodiscard]] bool isDeepImageFile(const std::string& path);

/// Converts an 8-bit BGR image to grey; grey images are returned unchanged.
[[nodiscard]] cv::Mat greyOf(const cv::Mat& image);

}  // namespace headway::io
