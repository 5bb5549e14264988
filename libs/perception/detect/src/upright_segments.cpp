// SPDX-License-Identifier: BSD-3-Clause
#include "upright_segments.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "heads.h"

namespace headway::detect {
namespace {

constexpr double kColumnStep = 0.5;        // of disparity between neighbouring cells [px]
constexpr double kColumnStepRatio = 0.02;  // or this ratio of it
constexpr double kHeadHeight = 2.4;        // higher cells are not a person's [m]
constexpr double kMinTop = 0.9;            // [m], unless the image cuts it
constexpr int kImageEdge = 6;              // rows below the upper edge without disparities [cells]
constexpr double kMaxFloat = 0.9;          // of the lowest part [m]
constexpr double kMinWidth = 0.2;          // [m]
constexpr double kMinLegWidth = 0.1;      // where the upper edge of the image leaves legs alone [m]
constexpr double kMaxUprightWidth = 2.0;  // a cyclist from the side [m]
constexpr std::size_t kMinUprightCells = 20;
constexpr double kNearer = 2.0;       // disparity by which an occluder is nearer [px]
constexpr double kHiddenRows = 0.25;  // ratio of rows with an occluder beside them

using Cells = std::vector<ObjectCell>;

// Connected cells.
struct Patch {
  std::vector<cv::Point> places;
  std::vector<float> disparities;
  std::vector<double> heights;  ///< above the ground [m]
};

// Removes the cells connected to one from the image. cv::floodFill has no tolerance relative to the
// value.
Patch takeConnected(cv::Mat& image, const cv::Point& first) {
  Patch patch{{first}, {image.at<float>(first)}, {}};
  image.at<float>(first) = 0.0F;
  const cv::Rect inside({0, 0}, image.size());
  for (std::size_t next = 0; next < patch.places.size(); ++next) {
    const float d = patch.disparities[next];
    const double max_step = std::max(kColumnStep, kColumnStepRatio * d);
    for (const auto& step :
         {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point place = patch.places[next] + step;
      if (!inside.contains(place)) continue;
      const float other = image.at<float>(place);
      if (other <= 0.0F || std::abs(other - d) > max_step) continue;
      image.at<float>(place) = 0.0F;
      patch.places.push_back(place);
      patch.disparities.push_back(other);
    }
  }
  return patch;
}

// Whether an occluder or the edge of the image borders the segment on its left or right.
bool isHidden(const Cells& cells, double segment_disparity, const cv::Rect& box,
              const stereo::DisparityImage& disparity) {
  if (box.x < 2 || box.br().x > disparity.values.cols - 2) return true;
  std::vector<int> first(box.height, box.br().x);
  std::vector<int> last(box.height, box.x);
  for (const auto& cell : cells) {
    const int row = cell.place.y - box.y;
    first[row] = std::min(first[row], cell.place.x);
    last[row] = std::max(last[row], cell.place.x);
  }
  const auto nearerAt = [&](int column, int row) {
    return column >= 0 && column < disparity.values.cols &&
           disparity.values.at<float>(row + box.y, column) > segment_disparity + kNearer;
  };
  int beside_left = 0;
  int beside_right = 0;
  for (int row = 0; row < box.height; ++row) {
    bool left = false;
    bool right = false;
    for (int off = 1; off <= 4; ++off) {
      left = left || nearerAt(first[row] - off, row);
      right = right || nearerAt(last[row] + off, row);
    }
    beside_left += left ? 1 : 0;
    beside_right += right ? 1 : 0;
  }
  return std::max(beside_left, beside_right) > kHiddenRows * box.height;
}

std::vector<Patch> byPerson(Patch&& patch, const stereo::DisparityImage& disparity,
                            const StereoCamera& camera) {
  // Where the upper edge of the image cuts the heads off, the highest cells are not of heads.
  if (cv::boundingRect(patch.places).y <= kImageEdge) return {std::move(patch)};
  const double d = median({patch.disparities.begin(), patch.disparities.end()});
  const auto persons =
      personOfCells(patch.places, patch.heights, disparity.reduce * camera.baseline_m / d);
  std::vector<Patch> patches(1 + *std::max_element(persons.begin(), persons.end()));
  if (patches.size() == 1) {
    patches.front() = std::move(patch);
    return patches;
  }
  for (std::size_t i = 0; i < persons.size(); ++i) {
    Patch& own = patches[persons[i]];
    own.places.push_back(patch.places[i]);
    own.disparities.push_back(patch.disparities[i]);
    own.heights.push_back(patch.heights[i]);
  }
  return patches;
}

Cells cellsOf(const Patch& patch, const stereo::DisparityImage& disparity,
              const StereoCamera& camera) {
  Cells cells;
  for (std::size_t i = 0; i < patch.places.size(); ++i) {
    const cv::Point& place = patch.places[i];
    const Eigen::Vector3d uvd(disparity.pixelOf(place.x), disparity.pixelOf(place.y),
                              patch.disparities[i]);
    cells.push_back({place, *triangulate(uvd, camera)});
  }
  return cells;
}

std::optional<UprightSegment> segmentOf(const Patch& patch, const stereo::DisparityImage& disparity,
                                        const StereoCamera& camera) {
  if (patch.places.size() < kMinUprightCells) return std::nullopt;
  const auto [lowest, highest] = std::minmax_element(patch.heights.begin(), patch.heights.end());
  // A segment that reaches the maximum height continues above it: a trunk, a pole, a wall.
  const bool cut = *highest > kHeadHeight - 0.1;
  const cv::Rect box = cv::boundingRect(patch.places);
  const bool cut_by_image = box.y <= kImageEdge;
  const bool low = *highest < kMinTop && !cut_by_image;
  if (cut || low || *lowest > kMaxFloat) return std::nullopt;
  const double d = median({patch.disparities.begin(), patch.disparities.end()});
  const double metres_per_px = camera.baseline_m / d;  // z / f
  const double width = box.width * disparity.reduce * metres_per_px;
  const bool legs = *highest < kMinTop && cut_by_image;
  if (width < (legs ? kMinLegWidth : kMinWidth) || width > kMaxUprightWidth) return std::nullopt;
  std::vector<double> columns;
  for (const auto& place : patch.places) {
    if (place.y <= box.y + box.height / 2) columns.push_back(disparity.pixelOf(place.x));
  }
  UprightSegment segment;
  segment.cells = cellsOf(patch, disparity, camera);
  segment.uvd = {median(columns), disparity.pixelOf(box.y) + 0.5 * box.height * disparity.reduce,
                 d};
  segment.width_px = box.width * disparity.reduce;
  segment.hidden = isHidden(segment.cells, d, box, disparity);
  return segment;
}

}  // namespace

StandingCells standingCells(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                            const stereo::GroundPlane& ground, double range_m) {
  const double fb = camera.fx * camera.baseline_m;
  const float min_disparity = static_cast<float>(fb / range_m);
  const cv::Size size = disparity.values.size();
  StandingCells cells{cv::Mat(size, CV_32F, cv::Scalar(0)), cv::Mat(size, CV_64F)};
  std::vector<double> across(size.width);
  for (int column = 0; column < size.width; ++column) {
    across[column] = (disparity.pixelOf(column) - camera.cx) / camera.fx;
  }
  for (int row = 0; row < size.height; ++row) {
    const double down = (disparity.pixelOf(row) - camera.cy) / camera.fy;
    const auto* disparities = disparity.values.ptr<float>(row);
    auto* standing = cells.disparities.ptr<float>(row);
    auto* heights = cells.heights.ptr<double>(row);
    for (int column = 0; column < size.width; ++column) {
      const float d = disparities[column];
      if (d < min_disparity) continue;
      const double depth = fb / d;
      heights[column] = ground.heightOf(Eigen::Vector3d(across[column], down, 1.0) * depth);
      if (heights[column] > ground.clearance(depth) && heights[column] < kHeadHeight) {
        standing[column] = d;
      }
    }
  }
  return cells;
}

std::vector<UprightSegment> uprightSegments(const StandingCells& standing,
                                            const stereo::DisparityImage& disparity,
                                            const StereoCamera& camera) {
  cv::Mat left = standing.disparities.clone();
  std::vector<UprightSegment> segments;
  for (int row = 0; row < left.rows; ++row) {
    for (int column = 0; column < left.cols; ++column) {
      if (left.at<float>(row, column) <= 0.0F) continue;
      Patch patch = takeConnected(left, {column, row});
      if (patch.places.size() < kMinUprightCells) continue;
      for (const auto& place : patch.places) {
        patch.heights.push_back(standing.heights.at<double>(place));
      }
      for (const Patch& person : byPerson(std::move(patch), disparity, camera)) {
        auto segment = segmentOf(person, disparity, camera);
        if (segment) segments.push_back(std::move(*segment));
      }
    }
  }
  return segments;
}

std::vector<UprightSegment> uprightSegments(const stereo::DisparityImage& disparity,
                                            const StereoCamera& camera,
                                            const stereo::GroundPlane& ground, double range_m) {
  return uprightSegments(standingCells(disparity, camera, ground, range_m), disparity, camera);
}

}  // namespace headway::detect
