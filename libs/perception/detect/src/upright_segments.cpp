// SPDX-License-Identifier: BSD-3-Clause
// Upright segments of a person's size in the disparity image, and their flow across the line of
// sight.
#include "upright_segments.h"

#include <headway/core/statistics.h>

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

constexpr double kColumnStep = 0.5;        // of disparity between neighbouring cells [px]
constexpr double kColumnStepRatio = 0.02;  // or this ratio of it
constexpr double kMinWidth = 0.2;          // [m]
constexpr double kMinLegWidth = 0.1;      // where the upper edge of the image leaves legs alone [m]
constexpr double kMaxUprightWidth = 2.0;  // a cyclist from the side [m]

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
  if (patch.places.size() < static_cast<std::size_t>(kMinPersonCells)) return std::nullopt;
  const auto [lowest, highest] = std::minmax_element(patch.heights.begin(), patch.heights.end());
  // A segment that reaches the maximum height continues above it: a trunk, a pole, a wall.
  const bool cut = *highest > kHeadHeight - 0.1;
  const cv::Rect box = cv::boundingRect(patch.places);
  const bool cut_by_image = box.y <= kImageEdge;
  const bool low = *highest < kMinTop && !cut_by_image;
  if (cut || low || *lowest > kMinTop) return std::nullopt;
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
  return segment;
}

constexpr float kMovingSigmas = 3.5F;  // sigmas from which a cell is moving
constexpr std::size_t kMinKnown = 12;  // of a segment with measured flow
const cv::Size kFlowGaps(5, 5);        // between moving cells that are closed [cells]

// Speed across the line of sight, to the right, of a flow [m/s].
double acrossOf(double flow_px, double disparity, double seconds, const StereoCamera& camera) {
  return flow_px * camera.baseline_m / disparity / seconds;
}

std::optional<LateralSpeed> acrossSpeed(const UprightSegment& segment, const ResidualFlow& flow,
                                        const StereoCamera& camera) {
  std::vector<double> flows;
  std::vector<double> sigmas;
  for (const auto& cell : segment.cells) {
    const float residual = flow.columns.at<float>(cell.place);
    if (std::isnan(residual)) continue;
    flows.push_back(residual);
    sigmas.push_back(flow.sigmas.at<float>(cell.place));
  }
  if (flows.size() < kMinKnown) return std::nullopt;
  const double middle = median(flows);
  std::vector<double> off;
  for (const double residual : flows) off.push_back(std::abs(residual - middle));
  const double sigma = std::hypot(kSurfaceSigma_px, std::max(median(off), median(sigmas)));
  return LateralSpeed{acrossOf(middle, segment.uvd.z(), flow.seconds, camera),
                      acrossOf(sigma, segment.uvd.z(), flow.seconds, camera), flow.seconds};
}

// Cells that move to one side (+1 right, -1 left), gaps between them closed.
cv::Mat movingCells(const stereo::DisparityImage& disparity, const ResidualFlow& flow,
                    const StereoCamera& camera, float side) {
  const cv::Size size = flow.columns.size();
  cv::Mat moving(size, CV_8U);
  cv::Mat fixed(size, CV_8U);
  for (int row = 0; row < size.height; ++row) {
    const auto* residuals = flow.columns.ptr<float>(row);
    const auto* sigmas = flow.sigmas.ptr<float>(row);
    const auto* d = disparity.values.ptr<float>(row);
    auto* moves = moving.ptr<unsigned char>(row);
    auto* rests = fixed.ptr<unsigned char>(row);
    for (int column = 0; column < size.width; ++column) {
      const float residual = side * residuals[column];  // NaN: neither moving nor static
      rests[column] = residual < 2.0F * sigmas[column];
      moves[column] = residual > kMovingSigmas * sigmas[column] &&
                      acrossOf(residual, d[column], flow.seconds, camera) > kMinAcross;
    }
  }
  cv::dilate(moving, moving, cv::getStructuringElement(cv::MORPH_RECT, kFlowGaps));
  moving.setTo(0, fixed);
  return moving;
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
      if (patch.places.size() < static_cast<std::size_t>(kMinPersonCells)) continue;
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

std::vector<UprightSegment> segmentsByFlow(const stereo::DisparityImage& disparity,
                                           const ResidualFlow& flow, const StereoCamera& camera,
                                           const StandingCells& standing,
                                           std::vector<UprightSegment> segments) {
  StandingCells rest{standing.disparities.clone(), standing.heights};
  for (const auto& segment : segments) {
    for (const auto& cell : segment.cells) rest.disparities.at<float>(cell.place) = 0.0F;
  }
  for (auto& segment : uprightSegments(rest, disparity, camera)) {
    segments.push_back(std::move(segment));
  }
  if (flow.empty()) return segments;
  cv::Mat claimed(flow.columns.size(), CV_8U, cv::Scalar(0));
  for (auto& segment : segments) {
    segment.across = acrossSpeed(segment, flow, camera);
    const bool is_sure =
        segment.across && std::abs(segment.across->speed) > kMovingSigmas * segment.across->sigma;
    if (!is_sure && !segment.is_new) continue;
    for (const auto& cell : segment.cells) claimed.at<unsigned char>(cell.place) = 1;
  }
  for (const float side : {1.0F, -1.0F}) {
    StandingCells moving{{}, standing.heights};
    standing.disparities.copyTo(moving.disparities, movingCells(disparity, flow, camera, side));
    for (auto& segment : uprightSegments(moving, disparity, camera)) {
      const auto taken = std::count_if(
          segment.cells.begin(), segment.cells.end(),
          [&](const ObjectCell& cell) { return claimed.at<unsigned char>(cell.place) != 0; });
      if (2 * static_cast<std::size_t>(taken) > segment.cells.size()) {
        continue;
      }
      segment.across = acrossSpeed(segment, flow, camera);
      segment.cut_by_flow = true;
      segments.push_back(std::move(segment));
    }
  }
  return segments;
}

}  // namespace headway::detect
