// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <variant>

#include "messages.h"

namespace headway::bags {

/// A converted image, or the reason why there is none ("image_encoding_mono16", "broken_image").
using ConvertedImage = std::variant<cv::Mat, std::string>;

/// 8-bit grey or BGR; raw colours of a Bayer pattern are interpolated. Has its own pixels.
[[nodiscard]] ConvertedImage pictureFrom(const ImageMessage& message);
[[nodiscard]] ConvertedImage pictureFrom(const CompressedImageMessage& message);

/// Depth in millimetres, 16 bit; 0 where nothing was measured, and beyond 65.5 m.
[[nodiscard]] ConvertedImage depthFrom(const ImageMessage& message);
/// Of the transport compressedDepth.
[[nodiscard]] ConvertedImage depthFrom(const CompressedImageMessage& message);

}  // namespace headway::bags
