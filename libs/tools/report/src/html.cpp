// SPDX-License-Identifier: BSD-3-Clause
// Pieces of HTML.
#include "html.h"

#include <headway/core/error.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::report {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string grouped(std::size_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, "\u202f");
  return digits;
}

std::string counted(std::size_t count, const std::string& singular) {
  return grouped(count) + " " + singular + (count == 1 ? "" : "s");
}

std::string hex(Colour colour) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", colour.red, colour.green, colour.blue);
  return text.data();
}

std::string section(const std::string& id, const std::string& title,
                    const std::string& introduction, const std::string& contents) {
  return "<section id=\"" + id + "\"><h2>" + escaped(title) + "</h2>" +
         (introduction.empty() ? "" : "<p class=\"lead\">" + introduction + "</p>") + contents +
         "</section>\n";
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t j) { return j < bytes.size() ? std::uint32_t{bytes[j]} : 0u; };
    const std::uint32_t triple = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
    for (std::size_t digit = 0; digit < 4; ++digit) {
      const bool padding = i + digit > bytes.size();
      text += padding ? '=' : kDigits[triple >> (18 - 6 * digit) & 63];
    }
  }
  return text;
}

std::vector<std::uint8_t> jpegOf(const cv::Mat& picture, int max_width, int quality) {
  cv::Mat small = picture;
  if (picture.cols > max_width) {
    const double scale = static_cast<double>(max_width) / picture.cols;
    cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return bytes;
}

std::string pictureUri(const std::filesystem::path& path, int max_width) {
  const cv::Mat picture = io::loadImage(path.string());
  if (picture.empty()) throw InputError(path.string() + ": is not a readable picture");
  return "data:image/jpeg;base64," + base64(jpegOf(picture, max_width, 88));
}

GridPicture gridPicture(const std::filesystem::path& path) {
  const cv::Mat grey = io::loadGreyImage(path.string());
  if (grey.empty()) throw InputError(path.string() + ": is not a readable picture");
  cv::Mat free = grey > 230, occupied = grey < 100;
  const double scale = 1600.0 / std::max(grey.cols, grey.rows);  // [px], as of the live page
  if (scale < 1.0) {
    for (cv::Mat* cells : {&free, &occupied}) {
      cv::resize(*cells, *cells, {}, scale, scale, cv::INTER_AREA);
    }
  }
  cv::Mat picture(free.size(), CV_8UC4, cv::Scalar::all(0));
  picture.setTo(cv::Scalar(132, 168, 96, 110), free > 127);
  picture.setTo(cv::Scalar(72, 92, 226, 235), occupied > 0);  // a single cell remains
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {"data:image/png;base64," + base64(bytes), grey.cols, grey.rows};
}

}  // namespace headway::report
