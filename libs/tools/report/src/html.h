// SPDX-License-Identifier: BSD-3-Clause
// Pieces of HTML.
#pragma once

#include <headway/core/object_class.h>

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::report {

/// Text with `&`, `<`, `>` and `"` replaced by their HTML entities.
[[nodiscard]] std::string escaped(const std::string& text);

/// A number with fixed decimals; "–" if it is not finite.
[[nodiscard]] std::string fixed(double value, int decimals);

/// An integer with narrow spaces between groups of three digits.
[[nodiscard]] std::string grouped(std::size_t value);

/// A number of things: "1 track", "2 tracks".
[[nodiscard]] std::string counted(std::size_t count, const std::string& singular);

/// "#rrggbb".
[[nodiscard]] std::string hex(Colour colour);

/// A section of the page: heading, introduction (HTML, may be empty) and contents (HTML).
[[nodiscard]] std::string section(const std::string& id, const std::string& title,
                                  const std::string& introduction, const std::string& contents);

/// Base 64 encoding (RFC 4648) with padding; hand-written because Boost's are not public.
[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

/// A picture as JPEG, scaled down to at most `max_width` [px].
[[nodiscard]] std::vector<std::uint8_t> jpegOf(const cv::Mat& picture, int max_width, int quality);

/// A picture file as a JPEG data URI, scaled down to at most `max_width` [px].
///
/// @throws InputError if the picture cannot be read
[[nodiscard]] std::string pictureUri(const std::filesystem::path& path, int max_width);

/// The grid of a map server (grey picture: 254 free, 205 unknown, 0 occupied) as a PNG data URI in
/// the page's colours, unknown cells transparent; and the grid's size.
///
/// @throws InputError if the picture cannot be read
struct GridPicture {
  std::string uri;  ///< at most 1600 px a side
  int width = 0;    ///< of the grid [cells]
  int height = 0;
};
[[nodiscard]] GridPicture gridPicture(const std::filesystem::path& path);

}  // namespace headway::report
