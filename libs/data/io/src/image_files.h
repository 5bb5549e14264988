// SPDX-License-Identifier: BSD-3-Clause
// Images of a folder or a rawlog: where they are, and what is wrong with one that cannot be used.
#pragma once

#include <headway/core/pose.h>
#include <headway/io/rawlog_sink.h>
#include <mrpt/img/CImage.h>

#include <array>
#include <filesystem>
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

/// Whether `path` lies in `folder` when all links are followed.
[[nodiscard]] bool isInside(const std::filesystem::path& folder, const std::filesystem::path& path);

/// Folder of a rawlog's external images: `X_Images` for `X.rawlog`, or `Images` in its folder.
[[nodiscard]] std::string imageFolderOf(const std::string& rawlog);

/// Paths of the images in a folder, sorted by name.
///
/// @throws InputError if the folder does not exist
[[nodiscard]] std::vector<std::string> imagesIn(const std::string& folder);

/// Loads an image as 8-bit grey or BGR. @throws InputError naming the file on failure
[[nodiscard]] cv::Mat requireImage(const std::string& path);

/// The same, if it has the size of its lens.
[[nodiscard]] cv::Mat requireImageOf(const std::string& path, const RawCamera& lens);

/// A PNG with 16 bits and one channel of its lens's size. @throws InputError naming the file
[[nodiscard]] cv::Mat requireDepthImageOf(const std::string& path, const RawCamera& lens);

/// The first number of every row. @throws InputError naming file and row if it is not finite
[[nodiscard]] std::vector<Time> readTimes(const std::string& path);

/// @throws InputError if a file has fewer times than there are images
void requireTimesFor(std::size_t images, const std::string& path, const std::vector<Time>& times);

/// Indices of images of two cameras that are nearest in time; each image is of one pair at most.
///
/// @param times, others  ascending
[[nodiscard]] std::vector<std::array<std::size_t, 2>> pairedByTime(const std::vector<Time>& times,
                                                                   const std::vector<Time>& others,
                                                                   double max_gap_s);

/// The times of one side's images that are in no pair.
///
/// @param side  0: `times` are the first ones of the pairs, 1: the second ones
[[nodiscard]] std::vector<Time> unpairedTimes(const std::vector<Time>& times,
                                              const std::vector<std::array<std::size_t, 2>>& pairs,
                                              std::size_t side);

inline constexpr double kMaxDepthGapS =
    0.02;  ///< between an image and its depth: less than 1/50 Hz

/// The intensity camera of a depth camera as the left one of a pair without baseline.
[[nodiscard]] RawStereoCamera leftAlone(const RawDepthCamera& camera);

}  // namespace headway::io
