// SPDX-License-Identifier: BSD-3-Clause
#include "cell_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace headway::eval {
namespace {

constexpr int kLegendRow_px = 26;
constexpr int kMinWidth_px = 900;
constexpr int kMaxCell_px = 8;
constexpr int kPicture_px = 1600;

}  // namespace

cv::Mat cellPicture(const cv::Mat& cells, double side_m, const std::vector<Shade>& shades) {
  const int side = std::clamp(kPicture_px / std::max(1, cells.cols), 1, kMaxCell_px);
  cv::Mat enlarged;
  cv::resize(cells, enlarged, {}, side, side, cv::INTER_NEAREST);
  const int legend_px = kLegendRow_px * (static_cast<int>(shades.size()) + 1) + 10;
  cv::Mat picture(enlarged.rows + legend_px, std::max(enlarged.cols, kMinWidth_px), CV_8UC3,
                  cv::Scalar(255, 255, 255));
  enlarged.copyTo(picture(cv::Rect(0, 0, enlarged.cols, enlarged.rows)));
  int y = enlarged.rows + 10;
  const auto write = [&](const std::string& text) {
    cv::putText(picture, text, {44, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(30, 30, 30),
                1, cv::LINE_AA);
    y += kLegendRow_px;
  };
  for (const auto& shade : shades) {
    const cv::Rect box(14, y, 22, 20);
    cv::rectangle(picture, box, cv::Scalar(shade.bgr), cv::FILLED);
    cv::rectangle(picture, box, cv::Scalar(120, 120, 120), 1);
    write(shade.name);
  }
  const int ten_metres = static_cast<int>(10.0 / side_m * side);
  cv::line(picture, {14, y + 10}, {14 + ten_metres, y + 10}, cv::Scalar(30, 30, 30), 2);
  cv::putText(picture, "10 m", {24 + ten_metres, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
  return picture;
}

}  // namespace headway::eval
