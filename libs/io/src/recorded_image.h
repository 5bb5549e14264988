#pragma once

#include <mrpt/img/CImage.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <variant>

namespace headway::io {

/// Pixels of a recorded image, 8-bit grey or BGR; or the reason why there are none
/// ("missing_image", "broken_image").
///
/// @param image_folder  where images beside the rawlog are. MRPT's global folder is left alone.
[[nodiscard]] std::variant<cv::Mat, std::string> pixelsOf(const mrpt::img::CImage& image,
                                                          const std::string& image_folder);

/// Where the images beside a rawlog are: `X_Images` for `X.rawlog`, or `Images` in the same folder.
[[nodiscard]] std::string imageFolderOf(const std::string& rawlog);

/// An image file as 8-bit grey or BGR, transparency left out; empty if it is missing, broken or of
/// another kind (such as 16 bit).
[[nodiscard]] cv::Mat loadImage(const std::string& path);

/// 8-bit grey of an 8-bit grey or BGR image. Grey stays as it is.
[[nodiscard]] cv::Mat greyOf(const cv::Mat& image);

}  // namespace headway::io
