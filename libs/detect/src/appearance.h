#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// How something looked in one frame: its own cells of the left image on the disparity grid.
struct Appearance {
  cv::Mat patch;       ///< 8-bit
  cv::Mat mask;        ///< of the same size, 255 where the patch shows it
  cv::Point2d middle;  ///< of the patch in that image [cells]
};

/// Cuts out how something looks.
///
/// @param image  left, on the disparity grid, 8-bit
/// @param cells  that it covers; gaps between them are closed
/// @return       nullopt for hardly any cells or hardly any contrast
[[nodiscard]] std::optional<Appearance> appearanceOf(const cv::Mat& image,
                                                     const std::vector<cv::Point>& cells);

/// Seeks what looks the same in another frame, by normalised correlation.
///
/// @param expected  middle of its patch there; parts outside the image are left out [cells]
/// @param scale     its size there over its size when it was cut out
/// @return          how far from the expected place it is; nullopt if nothing near looks like it,
///                  or where its size must have changed threefold
[[nodiscard]] std::optional<cv::Point> seek(const Appearance& appearance, const cv::Mat& image,
                                            const cv::Point2d& expected, double scale);

}  // namespace headway::detect
