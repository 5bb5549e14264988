// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string_view>

namespace headway::io {

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
