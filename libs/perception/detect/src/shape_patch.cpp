// SPDX-License-Identifier: BSD-3-Clause
// What the disparities show of whatever stands at one place, as a classifier of shapes sees it.
#include "shape_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "point_motion.h"
#include "upright_segments.h"

namespace headway::detect {
namespace {

/// The ground from above, in cells.
struct GroundCells {
  double cell_m = 0.1;
  double smoothing_m = 0.12;
  int apart = 2;               ///< minimum distance of maxima
  float min_area_m2 = 0.004F;  ///< visible above a maximum, after smoothing
};
constexpr GroundCells kGround{};

// Area that is seen above each cell of the ground, ahead of the camera [m^2].
cv::Mat areasFromAbove(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                       const stereo::GroundPlane& ground, double range_m) {
  const StandingCells standing = standingCells(disparity, camera, ground, range_m);
  const auto [right, forward] = axesAt(Eigen::Vector3d::UnitZ(), ground);
  const int reach = static_cast<int>(std::ceil(range_m / kGround.cell_m));
  cv::Mat areas(reach + 1, 2 * reach + 1, CV_32F, cv::Scalar(0));
  const cv::Rect inside({0, 0}, areas.size());
  const double cell_at_1m = disparity.reduce / camera.fx;
  for (int row = 0; row < standing.disparities.rows; ++row) {
    const double down = (disparity.pixelOf(row) - camera.cy) / camera.fy;
    const auto* disparities = standing.disparities.ptr<float>(row);
    for (int column = 0; column < standing.disparities.cols; ++column) {
      if (disparities[column] <= 0.0F) continue;
      const double depth = camera.fx * camera.baseline_m / disparities[column];
      const Eigen::Vector3d point =
          depth * Eigen::Vector3d((disparity.pixelOf(column) - camera.cx) / camera.fx, down, 1.0);
      const cv::Point at(reach + static_cast<int>(std::lround(point.dot(right) / kGround.cell_m)),
                         static_cast<int>(std::lround(point.dot(forward) / kGround.cell_m)));
      const double side = depth * cell_at_1m;
      if (inside.contains(at)) areas.at<float>(at) += static_cast<float>(side * side);
    }
  }
  return areas;
}

}  // namespace

std::vector<Eigen::Vector3d> standingPlaces(const stereo::DisparityImage& disparity,
                                            const StereoCamera& camera,
                                            const stereo::GroundPlane& ground, double range_m) {
  cv::Mat areas = areasFromAbove(disparity, camera, ground, range_m);
  cv::GaussianBlur(areas, areas, {}, kGround.smoothing_m / kGround.cell_m, 0.0,
                   cv::BORDER_CONSTANT);
  cv::Mat highest;
  const int around = 2 * kGround.apart + 1;
  cv::dilate(areas, highest, cv::Mat::ones(around, around, CV_8U));
  const auto [right, forward] = axesAt(Eigen::Vector3d::UnitZ(), ground);
  const int reach = areas.rows - 1;
  std::vector<Eigen::Vector3d> places;
  for (int row = 1; row < areas.rows; ++row) {
    for (int column = 0; column < areas.cols; ++column) {
      const float area = areas.at<float>(row, column);
      if (area < kGround.min_area_m2 || area < highest.at<float>(row, column)) continue;
      places.emplace_back(kGround.cell_m * ((column - reach) * right + row * forward) -
                          ground.camera_height * ground.up);
    }
  }
  return places;
}

ShapePatchAxes axesAt(const Eigen::Vector3d& place, const stereo::GroundPlane& ground) {
  const Eigen::Vector3d away = overGround(place, ground.up).normalized();
  return {away.cross(ground.up), away};
}

namespace {

/// What samples of a cell show.
struct CellCounts {
  int samples = 0, seen = 0, nearer = 0, farther = 0, outside = 0;
  double depths = 0.0;  ///< sum over those seen, relative to the place [m]
};

unsigned char levelOf(double ratio) { return cv::saturate_cast<unsigned char>(255.0 * ratio); }

}  // namespace

cv::Mat shapePatch(const Eigen::Vector3d& place, const stereo::DisparityImage& disparity,
                   const StereoCamera& camera, const stereo::GroundPlane& ground) {
  const ShapePatchAxes axes = axesAt(place, ground);
  const ShapePatchLayout& size = kShapePatch;
  const double fb = camera.fx * camera.baseline_m;
  const double place_depth = place.dot(axes.away);
  const auto sample = [&](double right_m, double up_m, CellCounts& cell) {
    ++cell.samples;
    const auto at = project(place + right_m * axes.across + up_m * ground.up, camera);
    if (!at || at->x() < 0.0 || at->y() < 0.0 || at->x() > camera.width - 1.0 ||
        at->y() > camera.height - 1.0) {
      ++cell.outside;
      return;
    }
    const double d = disparity.at(at->x(), at->y());
    if (d <= 0.0) return;
    const Eigen::Vector3d point = fb / d * ray(at->head<2>(), camera);
    const double behind = point.dot(axes.away) - place_depth;
    if (behind < -size.depth_m) {
      ++cell.nearer;
    } else if (behind > size.depth_m || ground.isGround(point)) {
      ++cell.farther;
    } else {
      ++cell.seen;
      cell.depths += behind;
    }
  };
  cv::Mat patch(size.channels * size.rows, size.columns, CV_8U);
  for (int row = 0; row < size.rows; ++row) {
    for (int column = 0; column < size.columns; ++column) {
      CellCounts cell;
      for (const double v : {0.25, 0.75}) {
        for (const double u : {0.25, 0.75}) {
          sample((column + u - 0.5 * size.columns) * size.cell_m,
                 (size.rows - row - v) * size.cell_m, cell);
        }
      }
      const double depth = cell.seen > 0 ? cell.depths / cell.seen / size.depth_m : 0.0;
      const double all = cell.samples;
      const std::array<double, 5> shown = {0.5 + 0.5 * depth, cell.seen / all, cell.nearer / all,
                                           cell.farther / all, cell.outside / all};
      for (int channel = 0; channel < size.channels; ++channel) {
        patch.at<unsigned char>(channel * size.rows + row, column) =
            levelOf(shown[static_cast<std::size_t>(channel)]);
      }
    }
  }
  return patch;
}

}  // namespace headway::detect
