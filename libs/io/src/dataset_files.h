#pragma once

#include <headway/core/pose.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::io {

/// Paths of the images in a folder, ordered by name.
///
/// @throws InputError if the folder does not exist
[[nodiscard]] std::vector<std::string> imagesIn(const std::string& folder);

/// An image as 8-bit grey or BGR. @throws InputError naming the file if that is not possible
[[nodiscard]] cv::Mat requireImage(const std::string& path);

/// The first number of every row.
[[nodiscard]] std::vector<Time> readTimes(const std::string& path);

}  // namespace headway::io
