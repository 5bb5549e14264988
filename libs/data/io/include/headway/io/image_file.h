// SPDX-License-Identifier: BSD-3-Clause
// Decoding of images within limits, and what a file is that is none.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>

namespace headway::io {

/// An image file as decodeImage() returns it; empty if it is missing or broken.
[[nodiscard]] cv::Mat loadImage(const std::string& path);

/// The same as 8-bit grey.
[[nodiscard]] cv::Mat loadGreyImage(const std::string& path);

/// A PNG with 16 bits and one channel; empty if it is missing, broken or another one.
[[nodiscard]] cv::Mat loadDepthImage(const std::string& path);

/// Whether the file is an image of 16 bits per channel, which loadImage() does not read.
[[nodiscard]] bool isDeepImageFile(const std::string& path);

/// What a file of a repository is whose content was not fetched, for messages; empty if it is none.
[[nodiscard]] std::string lfsPointerFault(const std::string& path);

/// Converts an 8-bit BGR image to grey; grey images are returned unchanged.
[[nodiscard]] cv::Mat greyOf(const cv::Mat& image);

/// Limits of images in files, known before any memory is allocated: as many pixels as a grid of the
/// map has cells, and as long a side as a JPEG has.
inline constexpr int kMaxImagePixels = 20'000'000;
inline constexpr int kMaxImageSide = 1 << 16;

/// An encoded image (JPEG, PNG, BMP, PNM or TIFF) as 8-bit grey or BGR without transparency.
///
/// Empty if it is broken, larger than the limits, or of another format or depth. A JPEG is broken
/// if libjpeg warns about it: its pixels are then partly invented.
[[nodiscard]] cv::Mat decodeImage(std::string_view bytes);

/// An encoded PNG with 16 bits and one channel; empty if it is broken or another one.
[[nodiscard]] cv::Mat decodeDepthImage(std::string_view bytes);

/// Whether it is an image of 16 bits per channel, which decodeImage() does not read.
[[nodiscard]] bool isDeepImage(std::string_view bytes);

}  // namespace headway::io
