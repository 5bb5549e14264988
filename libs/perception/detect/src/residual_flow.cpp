// SPDX-License-Identifier: BSD-3-Clause
// Flow of the image against that of a static scene: where something moves across the line of sight.
#include "residual_flow.h"

#include <headway/core/parallel_rows.h>
#include <headway/core/pose.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/disparity.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "object_extent.h"

namespace headway::detect {
namespace {

/// Positions of a row's static cells in the previous frame, by their disparities.
class StaticRow {
 public:
  StaticRow(const Eigen::Matrix3f& turn, const Eigen::Vector3f& shift, int row, int reduce)
      : reduce_(static_cast<float>(reduce)),
        begin_(turn.col(1) * pixelOf(row) + turn.col(2)),
        step_(turn.col(0)),
        shift_(shift) {}

  /// Column and row of the grid.
  [[nodiscard]] cv::Point2f before(int column, float disparity) const {
    const Eigen::Vector3f there = step_ * pixelOf(column) + begin_ + shift_ * disparity;
    return {cellOf(there.x() / there.z()), cellOf(there.y() / there.z())};
  }

 private:
  [[nodiscard]] float pixelOf(int cell) const {
    return (static_cast<float>(cell) + 0.5F) * reduce_ - 0.5F;
  }
  [[nodiscard]] float cellOf(float pixel) const { return (pixel + 0.5F) / reduce_ - 0.5F; }

  float reduce_;
  Eigen::Vector3f begin_, step_, shift_;
};

/// Image motion of a static scene from the previous frame to this one.
class StaticScene {
 public:
  StaticScene(const Pose& T_before_now, const StereoCamera& camera, int reduce) : reduce_(reduce) {
    Eigen::Matrix3d K;
    K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
    turn_ = (K * T_before_now.linear() * K.inverse()).cast<float>();
    shift_ = (K * T_before_now.translation() / (camera.fx * camera.baseline_m)).cast<float>();
  }

  [[nodiscard]] StaticRow row(int row) const { return {turn_, shift_, row, reduce_}; }

 private:
  int reduce_;
  Eigen::Matrix3f turn_;
  Eigen::Vector3f shift_;
};

/// Where cells of this frame are in the frame before.
struct Warp {
  cv::Mat columns, rows;  ///< of the frame before, 32-bit, for each cell
};

const cv::Size kNearMargin(17, 5);  // by which near objects are dilated [cells]

// Fills a row's holes with the smaller of the disparities beside them, the background's.
void fillRow(float* row, int columns) {
  float left = 0.0F;
  for (int begin = 0; begin < columns;) {
    if (row[begin] > 0.0F) {
      left = row[begin++];
      continue;
    }
    int end = begin;
    while (end < columns && row[end] <= 0.0F) ++end;
    const float right = end < columns ? row[end] : left;
    const float fill = left > 0.0F ? std::min(left, right) : right;
    std::fill(row + begin, row + end, fill);
    begin = end;
  }
}

// Disparities without holes, near objects dilated so that the warp does not tear at outlines.
cv::Mat smoothed(const cv::Mat& disparities) {
  cv::Mat result;
  cv::dilate(disparities, result, cv::getStructuringElement(cv::MORPH_RECT, kNearMargin));
  for (int row = 0; row < result.rows; ++row) fillRow(result.ptr<float>(row), result.cols);
  return result;
}

/// The warp of a static scene. Holes of the disparities are filled with those of the background
/// beside them, and near objects are dilated, so that the warp does not tear at outlines.
///
/// @param disparities  32-bit, of each cell of a grid; 0 where unknown
Warp warpOf(const cv::Mat& disparities, const StaticScene& scene) {
  const cv::Mat filled = smoothed(disparities);
  Warp warp{cv::Mat(disparities.size(), CV_32F), cv::Mat(disparities.size(), CV_32F)};
  forEachRow(disparities.rows, [&](int row) {
    const StaticRow static_row = scene.row(row);
    const auto* d = filled.ptr<float>(row);
    auto* columns = warp.columns.ptr<float>(row);
    auto* rows = warp.rows.ptr<float>(row);
    for (int column = 0; column < disparities.cols; ++column) {
      const cv::Point2f there = static_row.before(column, d[column]);
      columns[column] = there.x;
      rows[column] = there.y;
    }
  });
  return warp;
}

constexpr int kSearchReach = 16;  // search range to either side [cells]
constexpr int kMatchedBlock = 9;  // side of a matched block [cells]
constexpr int kOverlap = 6;       // rows around a block; even, because OpenCV filters pairs of rows
constexpr int kSpeckleRange = 2;  // between neighbours in a region
constexpr double kMinSigma = 0.15;       // [px]
constexpr int kStride = 3;               // of the cells that estimate the common flow
constexpr double kMinFlowTime_s = 0.06;  // in less, a walk is within the noise
constexpr double kFastWalk_mps = 2.0;    // across the line of sight, of a walker
constexpr int kMaxCoarse = 4;            // reduction of the images for near walkers
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// Matches some rows with the same result as matching the whole images.
void matchRows(const cv::Mat& now, const cv::Mat& warped, const cv::Range& rows, cv::Mat& matches) {
  auto matcher = cv::StereoBM::create(2 * kSearchReach, kMatchedBlock);
  matcher->setMinDisparity(-kSearchReach);
  matcher->setUniquenessRatio(10);
  matcher->setTextureThreshold(12);
  matcher->setPreFilterCap(31);
  matcher->setDisp12MaxDiff(1);
  const cv::Range seen(std::max(0, rows.start - kOverlap), std::min(now.rows, rows.end + kOverlap));
  cv::Mat found;
  matcher->compute(now.rowRange(seen), warped.rowRange(seen), found);
  found.rowRange(rows.start - seen.start, rows.end - seen.start).copyTo(matches.rowRange(rows));
}

// Columns in the warped image that match the cells [cells]; NaN where there are none.
cv::Mat matchedColumns(const cv::Mat& now, const cv::Mat& warped) {
  const int border = 2 * kSearchReach;  // columns that OpenCV leaves unmatched
  cv::Mat a, b;
  cv::copyMakeBorder(now, a, 0, 0, border, border, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(warped, b, 0, 0, border, border, cv::BORDER_REPLICATE);
  // OpenCV matches images as small as these in one thread.
  cv::Mat matches(a.size(), CV_16S);
  const int half = now.rows / 4 * 2;
  const std::array<cv::Range, 2> halves{cv::Range(0, half), cv::Range(half, now.rows)};
  forEachRow(2, [&](int i) { matchRows(a, b, halves[i], matches); });
  cv::filterSpeckles(matches, (-kSearchReach - 1) * cv::StereoMatcher::DISP_SCALE, kMinPersonCells,
                     kSpeckleRange);
  cv::Mat columns(now.size(), CV_32F);
  for (int row = 0; row < now.rows; ++row) {
    const short* match = matches.ptr<short>(row) + border;
    auto* place = columns.ptr<float>(row);
    for (int column = 0; column < now.cols; ++column) {
      place[column] = match[column] < -kSearchReach * cv::StereoMatcher::DISP_SCALE
                          ? kUnknown
                          : static_cast<float>(column) -
                                static_cast<float>(match[column]) / cv::StereoMatcher::DISP_SCALE;
    }
  }
  return columns;
}

float between(const float* row, int columns, float place) {
  const int first = cvFloor(place);
  if (first < 0 || first + 1 >= columns) return kUnknown;
  const float fraction = place - static_cast<float>(first);
  return (1.0F - fraction) * row[first] + fraction * row[first + 1];
}

// Subtracts the flow left by errors of the camera's motion: a rotation moves all cells alike, a
// translation in proportion to their disparity.
// @return  standard deviation of the remaining flow of static cells [px]
double subtractCommonFlow(const cv::Mat& disparities, cv::Mat& columns) {
  std::vector<Eigen::Vector3d> static_cells;  // 1, disparity, residual
  for (int row = 0; row < columns.rows; row += kStride) {
    const auto* d = disparities.ptr<float>(row);
    const auto* residuals = columns.ptr<float>(row);
    for (int column = 0; column < columns.cols; column += kStride) {
      if (!std::isnan(residuals[column]))
        static_cells.emplace_back(1.0, d[column], residuals[column]);
    }
  }
  if (static_cells.empty()) return 1.0;
  Eigen::Vector2d common = Eigen::Vector2d::Zero();
  const Eigen::Vector2d prior(1.0, 100.0);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix2d A = prior.asDiagonal();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (const auto& cell : static_cells) {
      const double off = cell.z() - common.dot(cell.head<2>());  // 1 px: half the weight
      const double weight = 1.0 / (1.0 + off * off);
      A += weight * cell.head<2>() * cell.head<2>().transpose();
      b += weight * cell.z() * cell.head<2>();
    }
    common = A.inverse() * b;
  }
  std::vector<double> rest;
  for (const auto& cell : static_cells)
    rest.push_back(std::abs(cell.z() - common.dot(cell.head<2>())));
  for (int row = 0; row < columns.rows; ++row) {
    const auto* d = disparities.ptr<float>(row);
    auto* residuals = columns.ptr<float>(row);
    for (int column = 0; column < columns.cols; ++column) {
      residuals[column] -= static_cast<float>(common.x() + common.y() * d[column]);
    }
  }
  return std::max(kMinSigma, 1.4826 * median(rest));
}

// Turns matched columns of the warped image into flow relative to static cells, with its error by
// the disparity's [px].
void subtractStaticFlow(const stereo::DisparityImage& disparity, const StaticScene& scene,
                        const Warp& warp, ResidualFlow& flow) {
  const auto scale = static_cast<float>(disparity.reduce);
  const int columns = flow.columns.cols;
  forEachRow(flow.columns.rows, [&](int row) {
    const StaticRow static_row = scene.row(row);
    const auto* d = disparity.values.ptr<float>(row);
    const auto* warped_columns = warp.columns.ptr<float>(row);
    auto* cells = flow.columns.ptr<float>(row);
    auto* sigmas = flow.sigmas.ptr<float>(row);
    std::vector<float> before(columns);
    for (int column = 0; column < columns; ++column) {
      before[column] = static_row.before(column, d[column]).x;
      const float shifted = static_row.before(column, d[column] + float(kCellSigma)).x;
      sigmas[column] = scale * (shifted - before[column]);
    }
    for (int column = 0; column < columns; ++column) {
      const bool known = d[column] > 0.0F && !std::isnan(cells[column]);
      cells[column] =
          known ? scale * (before[column] - between(warped_columns, columns, cells[column]))
                : kUnknown;
    }
  });
}

// Flow at the resolution of the disparities, up to the search range.
ResidualFlow flowOf(const cv::Mat& previous, const cv::Mat& image,
                    const stereo::DisparityImage& disparity, const Pose& T_before_now,
                    const StereoCamera& camera) {
  ResidualFlow flow;
  const StaticScene scene(T_before_now, camera, disparity.reduce);
  const Warp warp = warpOf(disparity.values, scene);
  cv::Mat warped;
  cv::remap(previous, warped, warp.columns, warp.rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  flow.columns = matchedColumns(image, warped);
  const cv::Mat nearest = stereo::nearestAround(disparity.values, kMatchedBlock / 4);
  flow.columns.setTo(kUnknown, nearest > stereo::nearerThan(disparity.values));
  flow.sigmas = cv::Mat(flow.columns.size(), CV_32F);
  subtractStaticFlow(disparity, scene, warp, flow);
  const double noise = subtractCommonFlow(disparity.values, flow.columns);
  cv::multiply(flow.sigmas, flow.sigmas, flow.sigmas);
  cv::add(flow.sigmas, noise * noise, flow.sigmas);
  cv::sqrt(flow.sigmas, flow.sigmas);
  return flow;
}

// Half the resolution, with the nearest of each four disparities.
stereo::DisparityImage halved(const stereo::DisparityImage& fine) {
  stereo::DisparityImage half;
  half.reduce = 2 * fine.reduce;
  half.values = cv::Mat(fine.values.rows / 2, fine.values.cols / 2, CV_32F);
  for (int row = 0; row < half.values.rows; ++row) {
    const auto* upper = fine.values.ptr<float>(2 * row);
    const auto* lower = fine.values.ptr<float>(2 * row + 1);
    auto* values = half.values.ptr<float>(row);
    for (int column = 0; column < half.values.cols; ++column) {
      const int c = 2 * column;
      values[column] = std::max({upper[c], upper[c + 1], lower[c], lower[c + 1]});
    }
  }
  return half;
}

// Disparity of a walker who moves by the search range between the frames.
double maxDisparity(int reduce, double seconds, const StereoCamera& camera) {
  return kSearchReach * reduce * camera.baseline_m / (kFastWalk_mps * seconds);
}

// Takes the flow of cells with a greater disparity from a coarser flow.
void replaceNear(const ResidualFlow& coarse, int factor, const cv::Mat& disparities,
                 double max_disparity, ResidualFlow& flow) {
  for (int row = 0; row < factor * coarse.columns.rows; ++row) {
    const auto* d = disparities.ptr<float>(row);
    for (int column = 0; column < factor * coarse.columns.cols; ++column) {
      if (d[column] <= max_disparity) continue;
      flow.columns.at<float>(row, column) = coarse.columns.at<float>(row / factor, column / factor);
      flow.sigmas.at<float>(row, column) = coarse.sigmas.at<float>(row / factor, column / factor);
    }
  }
}

}  // namespace

ResidualFlow ResidualFlowMeter::measure(const cv::Mat& image,
                                        const stereo::DisparityImage& disparity,
                                        const CameraPath& path) {
  const int newest = path.newest();
  images_.push_back({newest, image});
  while (images_.front().frame < path.oldest()) images_.pop_front();
  const auto ageOf = [&](const Image& one) { return path.timeOf(newest) - path.timeOf(one.frame); };
  while (images_.size() > 2 && ageOf(images_[1]) >= kMinFlowTime_s) images_.pop_front();
  const int before = images_.front().frame;
  const double seconds = ageOf(images_.front());
  if (seconds < kMinFlowTime_s) return {};
  cv::Mat previous = images_.front().image;
  const Pose T_before_now = path.T_cam_world(before) * path.T_cam_world(newest).inverse();
  ResidualFlow flow = flowOf(previous, image, disparity, T_before_now, camera_);
  flow.seconds = seconds;
  cv::Mat now = image;
  stereo::DisparityImage coarse = disparity;
  for (int factor = 2; factor <= kMaxCoarse; factor *= 2) {
    const double max_disparity = maxDisparity(coarse.reduce, seconds, camera_);
    if (cv::countNonZero(coarse.values > max_disparity) < kMinPersonCells) break;
    coarse = halved(coarse);
    previous = stereo::reducedImage(previous, 2);
    now = stereo::reducedImage(now, 2);
    const ResidualFlow near = flowOf(previous, now, coarse, T_before_now, camera_);
    replaceNear(near, factor, disparity.values, max_disparity, flow);
  }
  return flow;
}

}  // namespace headway::detect
