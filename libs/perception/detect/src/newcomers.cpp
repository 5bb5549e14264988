// SPDX-License-Identifier: BSD-3-Clause
// People and things that stand where space was empty, each as one segment.
#include "newcomers.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "empty_space.h"
#include "shape_patch.h"

namespace headway::detect {
namespace {

constexpr double kBin = 0.05;        // of the density, smoothed by a Gaussian of two of these [m]
constexpr double kRadius = 0.6;      // of a leg from the centre of a person [m]
constexpr double kMinSurface = 0.1;  // that is visible [m^2]

/// A cell and where it stands over the ground, seen from the camera [m].
struct Standing {
  ObjectCell cell;
  float disparity;
  cv::Point2d at;
  float surface;  ///< [m^2]
};

std::vector<Standing> standingOf(const cv::Mat& is_new, unsigned char wanted,
                                 const StandingCells& standing,
                                 const stereo::DisparityImage& disparity,
                                 const StereoCamera& camera, const stereo::GroundPlane& ground) {
  const auto [right, ahead] = axesAt(Eigen::Vector3d::UnitZ(), ground);
  std::vector<Standing> cells;
  for (int row = 0; row < is_new.rows; ++row) {
    for (int column = 0; column < is_new.cols; ++column) {
      if (is_new.at<unsigned char>(row, column) != wanted) continue;
      const float d = standing.disparities.at<float>(row, column);
      const auto point =
          triangulate({disparity.pixelOf(column), disparity.pixelOf(row), d}, camera);
      const double side = disparity.reduce * point->z() / camera.fx;
      cells.push_back({{{column, row}, *point},
                       d,
                       {right.dot(*point), ahead.dot(*point)},
                       static_cast<float>(side * side)});
    }
  }
  return cells;
}

int squares(double metres) { return static_cast<int>(std::ceil(metres / kBin)); }

/// Visible surface by where it stands over the ground.
class Density {
 public:
  explicit Density(const std::vector<Standing>& cells) {
    cv::Point2d least = cells.front().at, greatest = least;
    for (const Standing& cell : cells) {
      least = {std::min(least.x, cell.at.x), std::min(least.y, cell.at.y)};
      greatest = {std::max(greatest.x, cell.at.x), std::max(greatest.y, cell.at.y)};
    }
    origin_ = least - cv::Point2d(kRadius, kRadius);
    const cv::Point2d size = greatest - origin_;
    values_.create(squares(size.y + kRadius) + 1, squares(size.x + kRadius) + 1, CV_32F);
    values_.setTo(0);
    for (const Standing& cell : cells) values_.at<float>(squareOf(cell.at)) += cell.surface;
    cv::GaussianBlur(values_, values_, {}, 2.0);
  }

  [[nodiscard]] std::vector<cv::Point2d> maxima() const {
    cv::Mat greatest;
    const int apart = 2 * squares(0.5 * kRadius) - 1;
    cv::dilate(values_, greatest, cv::getStructuringElement(cv::MORPH_ELLIPSE, {apart, apart}));
    std::vector<cv::Point2d> places;
    for (int y = 0; y < values_.rows; ++y) {
      for (int x = 0; x < values_.cols; ++x) {
        const float here = values_.at<float>(y, x);
        if (here <= 0.0F || here < greatest.at<float>(y, x)) continue;
        places.push_back(origin_ + kBin * cv::Point2d(x + 0.5, y + 0.5));
      }
    }
    return places;
  }

 private:
  [[nodiscard]] cv::Point squareOf(const cv::Point2d& place) const {
    return {static_cast<int>((place.x - origin_.x) / kBin),
            static_cast<int>((place.y - origin_.y) / kBin)};
  }

  cv::Point2d origin_;
  cv::Mat values_;
};

/// Cells around one maximum.
struct Group {
  cv::Point2d centre;
  double surface = 0.0;  ///< [m^2]
  double top = 0.0;      ///< above the ground [m]
  std::vector<const Standing*> cells;
};

void add(const Standing& cell, const StandingCells& standing, Group& group) {
  group.surface += cell.surface;
  group.top = std::max(group.top, standing.heights.at<double>(cell.cell.place));
  group.cells.push_back(&cell);
}

/// The group that a cell is nearest to; null beyond a distance.
Group* nearestTo(const Standing& cell, double within, std::vector<Group>& groups) {
  const auto nearest =
      std::min_element(groups.begin(), groups.end(), [&](const Group& a, const Group& b) {
        return cv::norm(a.centre - cell.at) < cv::norm(b.centre - cell.at);
      });
  if (nearest == groups.end() || cv::norm(nearest->centre - cell.at) > within) return nullptr;
  return &*nearest;
}

std::vector<Group> groupsOf(const std::vector<Standing>& cells, const Density& density,
                            const StandingCells& standing) {
  std::vector<Group> groups;
  for (const auto& centre : density.maxima()) groups.push_back({centre, 0.0, 0.0, {}});
  for (const Standing& cell : cells) {
    if (Group* group = nearestTo(cell, kRadius, groups)) add(cell, standing, *group);
  }
  return groups;
}

std::optional<UprightSegment> segmentOf(const Group& group,
                                        const stereo::DisparityImage& disparity) {
  if (group.cells.size() < static_cast<std::size_t>(kMinPersonCells)) return std::nullopt;
  std::vector<double> disparities, columns;
  UprightSegment segment;
  Range u, v;
  for (const Standing* one : group.cells) {
    disparities.push_back(one->disparity);
    columns.push_back(disparity.pixelOf(one->cell.place.x));
    u.add(one->cell.place.x);
    v.add(one->cell.place.y);
    segment.cells.push_back(one->cell);
  }
  const bool is_cut = v.min <= kImageEdge;
  const bool is_low = group.top < kMinTop && !is_cut;
  if (is_low || group.surface < (is_cut ? 0.5 : 1.0) * kMinSurface) return std::nullopt;
  segment.uvd = {median(columns), disparity.pixelOf(static_cast<int>(0.5 * (v.min + v.max))),
                 median(disparities)};
  segment.width_px = (u.size() + 1.0) * disparity.reduce;
  segment.is_new = true;
  return segment;
}

}  // namespace

std::vector<UprightSegment> newcomers(const cv::Mat& is_new, const StandingCells& standing,
                                      const stereo::DisparityImage& disparity,
                                      const StereoCamera& camera,
                                      const stereo::GroundPlane& ground) {
  const auto cells = standingOf(is_new, EmptySpace::kNew, standing, disparity, camera, ground);
  if (cells.empty()) return {};
  const Density density(cells);
  auto groups = groupsOf(cells, density, standing);
  const auto undecided =
      standingOf(is_new, EmptySpace::kUndecided, standing, disparity, camera, ground);
  for (const Standing& cell : undecided) {
    if (Group* group = nearestTo(cell, 0.5 * kRadius, groups)) add(cell, standing, *group);
  }
  std::vector<UprightSegment> segments;
  for (const Group& group : groups) {
    if (auto segment = segmentOf(group, disparity)) segments.push_back(std::move(*segment));
  }
  return segments;
}

}  // namespace headway::detect
