#include "residual_flow.h"

#include <headway/core/statistics.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr int kReach = 16;               // sought to either side [cells]
constexpr int kBlock = 9;                // matched [cells]
constexpr int kUniqueness = 10;          // how much better the best match must be [%]
constexpr int kLeastSpeckle = 20;        // smaller islands are dropped [cells]
constexpr int kSubpixels = 16;           // OpenCV's fixed-point disparities
constexpr int kBorder = 2 * kReach;      // columns without which OpenCV matches nothing [cells]
const cv::Size kSkirt(17, 5);            // around near things they keep their depth [cells]
constexpr double kSigmaDisparity = 0.4;  // [px]
constexpr double kLeastSigma = 0.15;     // [px]
constexpr double kTail = 1.0;            // residual from which a cell weighs half [px]
constexpr int kEach = 3;                 // cell looked at for what all have in common
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

// Fills a row's holes with the lesser of the disparities beside them: what is behind.
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

// Disparities without holes, in which near things have a skirt: what moves is looked for in front
// of what is still, and must not be torn at its own outline.
cv::Mat smoothed(const cv::Mat& disparities) {
  cv::Mat result;
  cv::dilate(disparities, result, cv::getStructuringElement(cv::MORPH_RECT, kSkirt));
  for (int row = 0; row < result.rows; ++row) fillRow(result.ptr<float>(row), result.cols);
  return result;
}

// Where a still cell was in the frame before, by its disparity.
class StillWorld {
 public:
  StillWorld(const Pose& T_before_now, const StereoCamera& camera, int reduce) : reduce_(reduce) {
    Eigen::Matrix3d K;
    K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
    turn_ = (K * T_before_now.linear() * K.inverse()).cast<float>();
    shift_ = (K * T_before_now.translation() / (camera.fx * camera.baseline_m)).cast<float>();
  }

  // Column and row of the grid.
  [[nodiscard]] cv::Point2f before(int column, int row, float disparity) const {
    const Eigen::Vector3f pixel(pixelOf(column), pixelOf(row), 1.0F);
    const Eigen::Vector3f there = turn_ * pixel + shift_ * disparity;
    return {cellOf(there.x() / there.z()), cellOf(there.y() / there.z())};
  }

 private:
  [[nodiscard]] float pixelOf(int cell) const {
    return (static_cast<float>(cell) + 0.5F) * static_cast<float>(reduce_) - 0.5F;
  }
  [[nodiscard]] float cellOf(float pixel) const {
    return (pixel + 0.5F) / static_cast<float>(reduce_) - 0.5F;
  }

  int reduce_;
  Eigen::Matrix3f turn_;
  Eigen::Vector3f shift_;
};

struct Warp {
  cv::Mat columns, rows;  ///< of the frame before, 32-bit, for each cell
};

Warp warpOf(const cv::Mat& disparities, const StillWorld& world) {
  Warp warp{cv::Mat(disparities.size(), CV_32F), cv::Mat(disparities.size(), CV_32F)};
  for (int row = 0; row < disparities.rows; ++row) {
    for (int column = 0; column < disparities.cols; ++column) {
      const cv::Point2f there = world.before(column, row, disparities.at<float>(row, column));
      warp.columns.at<float>(row, column) = there.x;
      warp.rows.at<float>(row, column) = there.y;
    }
  }
  return warp;
}

// Columns in the warped image that match the cells [cells]; NaN where there are none.
cv::Mat matchedColumns(const cv::Mat& now, const cv::Mat& warped) {
  auto matcher = cv::StereoBM::create(2 * kReach, kBlock);
  matcher->setMinDisparity(-kReach);
  matcher->setUniquenessRatio(kUniqueness);
  matcher->setTextureThreshold(12);
  matcher->setPreFilterCap(31);
  matcher->setDisp12MaxDiff(1);
  matcher->setSpeckleRange(2);
  matcher->setSpeckleWindowSize(kLeastSpeckle);
  cv::Mat a, b, fixed;
  cv::copyMakeBorder(now, a, 0, 0, kBorder, kBorder, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(warped, b, 0, 0, kBorder, kBorder, cv::BORDER_REPLICATE);
  matcher->compute(a, b, fixed);
  cv::Mat columns(now.size(), CV_32F, cv::Scalar(kUnknown));
  for (int row = 0; row < now.rows; ++row) {
    for (int column = 0; column < now.cols; ++column) {
      const int match = fixed.at<short>(row, column + kBorder);
      if (match < -kReach * kSubpixels) continue;
      columns.at<float>(row, column) =
          static_cast<float>(column) - static_cast<float>(match) / kSubpixels;
    }
  }
  return columns;
}

float between(const float* row, int columns, float place) {
  const int first = static_cast<int>(std::floor(place));
  if (first < 0 || first + 1 >= columns) return kUnknown;
  const float share = place - static_cast<float>(first);
  return (1.0F - share) * row[first] + share * row[first + 1];
}

// Takes off what the camera's motion left: a turn moves all cells alike, a shift by disparity.
// @return  what is left of a still cell, standard deviation [px]
double takeOffCommon(const cv::Mat& disparities, cv::Mat& columns) {
  std::vector<Eigen::Vector3d> still;  // 1, disparity, residual
  for (int row = 0; row < columns.rows; row += kEach) {
    for (int column = 0; column < columns.cols; column += kEach) {
      const float residual = columns.at<float>(row, column);
      if (std::isnan(residual)) continue;
      still.emplace_back(1.0, disparities.at<float>(row, column), residual);
    }
  }
  if (still.empty()) return kTail;
  Eigen::Vector2d common = Eigen::Vector2d::Zero();
  const Eigen::Vector2d prior(1.0, 100.0);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix2d A = prior.asDiagonal();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    for (const auto& cell : still) {
      const double off = (cell.z() - common.dot(cell.head<2>())) / kTail;
      const double weight = 1.0 / (1.0 + off * off);
      A += weight * cell.head<2>() * cell.head<2>().transpose();
      b += weight * cell.z() * cell.head<2>();
    }
    common = A.inverse() * b;
  }
  std::vector<double> rest;
  for (const auto& cell : still) rest.push_back(std::abs(cell.z() - common.dot(cell.head<2>())));
  for (int row = 0; row < columns.rows; ++row) {
    for (int column = 0; column < columns.cols; ++column) {
      columns.at<float>(row, column) -=
          static_cast<float>(common.x() + common.y() * disparities.at<float>(row, column));
    }
  }
  return std::max(kLeastSigma, 1.4826 * median(rest));
}

}  // namespace

ResidualFlow ResidualFlowMeter::measure(const cv::Mat& image, const DisparityImage& disparity,
                                        const CameraPath& path) {
  const cv::Mat before = before_;
  before_ = image.clone();
  ResidualFlow flow;
  if (before.empty() || path.newest() == path.oldest()) return flow;
  const int newest = path.newest();
  flow.seconds = path.timeOf(newest) - path.timeOf(newest - 1);
  const StillWorld world(path.T_cam_world(newest - 1) * path.T_cam_world(newest).inverse(), camera_,
                         disparity.reduce);
  const Warp warp = warpOf(smoothed(disparity.values), world);
  cv::Mat warped;
  cv::remap(before, warped, warp.columns, warp.rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  flow.columns = matchedColumns(before_, warped);
  flow.sigmas = cv::Mat(flow.columns.size(), CV_32F, cv::Scalar(0));
  const auto scale = static_cast<float>(disparity.reduce);
  for (int row = 0; row < flow.columns.rows; ++row) {
    for (int column = 0; column < flow.columns.cols; ++column) {
      float& cell = flow.columns.at<float>(row, column);
      const float d = disparity.values.at<float>(row, column);
      if (d <= 0.0F) cell = kUnknown;
      if (std::isnan(cell)) continue;
      const float still = world.before(column, row, d).x;
      const float shifted = world.before(column, row, d + float(kSigmaDisparity)).x;
      cell = scale * (still - between(warp.columns.ptr<float>(row), warp.columns.cols, cell));
      flow.sigmas.at<float>(row, column) = scale * (shifted - still);
    }
  }
  const double noise = takeOffCommon(disparity.values, flow.columns);
  cv::Mat squared = flow.sigmas.mul(flow.sigmas) + noise * noise;
  cv::sqrt(squared, flow.sigmas);
  return flow;
}

}  // namespace headway::detect
