#pragma once

#include <headway/core/pose.h>
#include <mrpt/img/CImage.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <variant>
#include <vector>

namespace headway::io {

/// Pixels of a recorded image, 8-bit grey or BGR, or the reason of a failure ("missing_image",
/// "broken_image", "image_outside_folder": its name leads out of the folder).
///
/// @param image_folder  folder of external images; MRPT's global folder is not used
[[nodiscard]] std::variant<cv::Mat, std::string> pixelsOf(const mrpt::img::CImage& image,
                                                          const std::string& image_folder);

/// Folder of a rawlog's external images: `X_Images` for `X.rawlog`, or `Images` in its folder.
[[nodiscard]] std::string imageFolderOf(const std::string& rawlog);

/// An image file as decodeImage() returns it; empty if it is missing or broken.
[[nodiscard]] cv::Mat loadImage(const std::string& path);

/// Converts an 8-bit BGR image to grey; grey images are returned unchanged.
[[nodiscard]] cv::Mat greyOf(const cv::Mat& image);

/// Paths of the images in a folder, sorted by name.
///
/// @throws InputError if the folder does not exist
[[nodiscard]] std::vector<std::string> imagesIn(const std::string& folder);

/// Loads an image as 8-bit grey or BGR. @throws InputError naming the file on failure
[[nodiscard]] cv::Mat requireImage(const std::string& path);

/// The first number of every row.
[[nodiscard]] std::vector<Time> readTimes(const std::string& path);

}  // namespace headway::io
