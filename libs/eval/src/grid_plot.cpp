// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/plots.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <string>

namespace headway::eval {
namespace {

constexpr int kLegendRow_px = 26;
constexpr int kMinWidth_px = 900;
constexpr int kMaxCell_px = 8;

struct Shade {
  const char* name;
  cv::Vec3b bgr;
};

const std::array<Shade, 7> kShades = {
    {{"free, correct", {246, 246, 246}},
     {"occupied, correct", {40, 40, 40}},
     {"occupied, truly free", {60, 120, 255}},
     {"occupied, truly free, on a moving object's path", {200, 0, 200}},
     {"free, truly occupied", {220, 120, 20}},
     {"observed, truth unknown", {214, 204, 190}},
     {"not observed", {176, 176, 176}}}};

cv::Vec3b shadeOf(CellState truth, CellState estimate, bool swept) {
  if (estimate == CellState::kUnknown) return kShades[6].bgr;
  if (truth == CellState::kUnknown) return kShades[5].bgr;
  if (truth == estimate) return kShades[truth == CellState::kFree ? 0 : 1].bgr;
  if (truth == CellState::kOccupied) return kShades[4].bgr;
  return kShades[swept ? 3 : 2].bgr;
}

}  // namespace

cv::Mat gridPlot(const GridCells& truth, const GridCells& estimate,
                 const std::vector<std::uint8_t>& swept) {
  cv::Mat cells(truth.rows, truth.columns, CV_8UC3);
  for (int row = 0; row < truth.rows; ++row) {
    for (int column = 0; column < truth.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * truth.columns + column);
      cells.at<cv::Vec3b>(truth.rows - 1 - row, column) =
          shadeOf(truth.states[i], estimate.states[i], swept[i] != 0);
    }
  }
  const int side = std::clamp(1600 / std::max(1, truth.columns), 1, kMaxCell_px);
  cv::resize(cells, cells, {}, side, side, cv::INTER_NEAREST);
  const int legend_px = kLegendRow_px * (static_cast<int>(kShades.size()) + 1) + 10;
  cv::Mat picture(cells.rows + legend_px, std::max(cells.cols, kMinWidth_px), CV_8UC3,
                  cv::Scalar(255, 255, 255));
  cells.copyTo(picture(cv::Rect(0, 0, cells.cols, cells.rows)));
  int y = cells.rows + 10;
  const auto write = [&](const std::string& text) {
    cv::putText(picture, text, {44, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(30, 30, 30),
                1, cv::LINE_AA);
    y += kLegendRow_px;
  };
  for (const auto& shade : kShades) {
    const cv::Rect box(14, y, 22, 20);
    cv::rectangle(picture, box, cv::Scalar(shade.bgr), cv::FILLED);
    cv::rectangle(picture, box, cv::Scalar(120, 120, 120), 1);
    write(shade.name);
  }
  const int ten_metres = static_cast<int>(10.0 / truth.resolution_m * side);
  cv::line(picture, {14, y + 10}, {14 + ten_metres, y + 10}, cv::Scalar(30, 30, 30), 2);
  cv::putText(picture, "10 m", {24 + ten_metres, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
  return picture;
}

}  // namespace headway::eval
