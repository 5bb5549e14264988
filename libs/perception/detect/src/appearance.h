// SPDX-License-Identifier: BSD-3-Clause
// Templates of objects: how one is cut out of an image and found in another.
#pragma once

#include <headway/core/appearance.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// The mask of an object.
///
/// @param cells   of the disparity grid
/// @param reduce  pixels to one cell, each way
/// @return        null without cells
[[nodiscard]] std::shared_ptr<const ObjectMask> maskOf(const std::vector<cv::Point>& cells,
                                                       int reduce);

/// Cuts the template of an object out of an image; its geometry and time are left to the caller.
///
/// @param image   left, on the disparity grid, 8-bit
/// @param cells   that show the object; gaps between them are closed
/// @param reduce  pixels to one cell, each way
/// @return        nullopt for too few cells or too little contrast to be found again
[[nodiscard]] std::optional<AppearanceTemplate> templateOf(const cv::Mat& image,
                                                           const std::vector<cv::Point>& cells,
                                                           int reduce);

/// Whether the image of an object repeats along its rows, as corrugated sheets, shelves and
/// railings do: neither disparities nor flow along rows are unambiguous there.
///
/// @param image  left, on the disparity grid, 8-bit
/// @param cells  that show the object
[[nodiscard]] bool repeatsAlongRows(const cv::Mat& image, const std::vector<cv::Point>& cells);

/// Searches another frame for a template by normalised correlation.
///
/// @param expected  centre of the patch there; parts outside the image are left out [cells]
/// @param scale     size of the object there over its size in the template
/// @return          offset from the expected place [cells]; nullopt if nothing near it is similar,
///                  or for scales beyond a factor of three
[[nodiscard]] std::optional<cv::Point> findTemplate(const AppearanceTemplate& appearance,
                                                    const cv::Mat& image,
                                                    const cv::Point2d& expected, double scale);

}  // namespace headway::detect
