// SPDX-License-Identifier: BSD-3-Clause
#include "heads.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr double kHeadRatio = 0.8;  // of the greatest height, from which cells are of a head
constexpr double kGap = 0.15;       // between heads [m]
constexpr int kMinGap = 2;          // [cells]
constexpr int kMinHead = 4;         // [cells]

// Cells of heads in each column of their bounding box.
std::vector<int> headCells(const std::vector<cv::Point>& cells, const std::vector<double>& heights,
                           const cv::Rect& box) {
  const double min_height = kHeadRatio * *std::max_element(heights.begin(), heights.end());
  std::vector<int> count(box.width, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (heights[i] > min_height) ++count[cells[i].x - box.x];
  }
  return count;
}

// Middle columns of the runs of columns with cells of heads.
std::vector<double> headColumns(const std::vector<int>& count, int gap) {
  std::vector<double> columns;
  const int width = static_cast<int>(count.size());
  for (int first = 0; first < width; ++first) {
    if (count[first] == 0) continue;
    int last = first;
    int cells = 0;
    for (int column = first; column < width && column - last <= gap; ++column) {
      if (count[column] == 0) continue;
      last = column;
      cells += count[column];
    }
    if (cells >= kMinHead) columns.push_back(0.5 * (first + last));
    first = last;
  }
  return columns;
}

}  // namespace

std::vector<int> personOfCells(const std::vector<cv::Point>& cells,
                               const std::vector<double>& heights, double metres_per_cell) {
  std::vector<int> persons(cells.size(), 0);
  if (cells.empty()) return persons;
  const cv::Rect box = cv::boundingRect(cells);
  const int gap = std::max(kMinGap, static_cast<int>(std::lround(kGap / metres_per_cell)));
  const auto heads = headColumns(headCells(cells, heights, box), gap);
  if (heads.size() < 2) return persons;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double column = cells[i].x - box.x;
    const auto nearest = std::min_element(heads.begin(), heads.end(), [&](double a, double b) {
      return std::abs(column - a) < std::abs(column - b);
    });
    persons[i] = static_cast<int>(nearest - heads.begin());
  }
  return persons;
}

}  // namespace headway::detect
