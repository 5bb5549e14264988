#include "residual_flow.h"

#include <headway/core/statistics.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr int kReach = 16;           // sought to either side [cells]
constexpr int kBlock = 9;            // matched [cells]
constexpr int kUniqueness = 10;      // how much better the best match must be [%]
constexpr int kOverlap = 6;          // rows about a block; even, as OpenCV filters pairs of them
constexpr int kLeastSpeckle = 20;    // smaller islands are dropped [cells]
constexpr int kSpeckleRange = 2;     // between neighbours in an island
constexpr int kSubpixels = 16;       // OpenCV's fixed-point disparities
constexpr int kBorder = 2 * kReach;  // columns without which OpenCV matches nothing [cells]
const cv::Size kSkirt(17, 5);        // around near things they keep their depth [cells]
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

// Does something with each row, in some threads: rows must not depend on each other.
template <class Work>
void forEachRow(int rows, const Work& work) {
  cv::parallel_for_({0, rows}, [&](const cv::Range& some) {
    for (int row = some.start; row < some.end; ++row) work(row);
  });
}

// Where a row's still cells were in the frame before, by their disparities.
class StillRow {
 public:
  StillRow(const Eigen::Matrix3f& turn, const Eigen::Vector3f& shift, int row, int reduce)
      : reduce_(static_cast<float>(reduce)),
        begin_(turn.col(1) * pixelOf(row) + turn.col(2)),
        step_(turn.col(0)),
        shift_(shift) {}

  // Column and row of the grid.
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

// How a still world moves through the image from the frame before to this one.
class StillWorld {
 public:
  StillWorld(const Pose& T_before_now, const StereoCamera& camera, int reduce) : reduce_(reduce) {
    Eigen::Matrix3d K;
    K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
    turn_ = (K * T_before_now.linear() * K.inverse()).cast<float>();
    shift_ = (K * T_before_now.translation() / (camera.fx * camera.baseline_m)).cast<float>();
  }

  [[nodiscard]] StillRow row(int row) const { return {turn_, shift_, row, reduce_}; }

 private:
  int reduce_;
  Eigen::Matrix3f turn_;
  Eigen::Vector3f shift_;
};

struct Warp {
  cv::Mat columns, rows;  ///< of the frame before, 32-bit, for each cell
};

Warp warpOf(const cv::Mat& disparities, const StillWorld& world) {
  Warp warp{cv::Mat(disparities.size(), CV_32F), cv::Mat(disparities.size(), CV_32F)};
  forEachRow(disparities.rows, [&](int row) {
    const StillRow still = world.row(row);
    const auto* d = disparities.ptr<float>(row);
    auto* columns = warp.columns.ptr<float>(row);
    auto* rows = warp.rows.ptr<float>(row);
    for (int column = 0; column < disparities.cols; ++column) {
      const cv::Point2f there = still.before(column, d[column]);
      columns[column] = there.x;
      rows[column] = there.y;
    }
  });
  return warp;
}

// Fills in what is matched in some rows, just as if the whole images were matched.
void matchRows(const cv::Mat& now, const cv::Mat& warped, const cv::Range& rows, cv::Mat& matches) {
  auto matcher = cv::StereoBM::create(2 * kReach, kBlock);
  matcher->setMinDisparity(-kReach);
  matcher->setUniquenessRatio(kUniqueness);
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
  cv::Mat a, b;
  cv::copyMakeBorder(now, a, 0, 0, kBorder, kBorder, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(warped, b, 0, 0, kBorder, kBorder, cv::BORDER_REPLICATE);
  // OpenCV matches images as small as these in one thread.
  cv::Mat matches(a.size(), CV_16S);
  const int half = now.rows / 4 * 2;
  const std::array<cv::Range, 2> halves{cv::Range(0, half), cv::Range(half, now.rows)};
  forEachRow(2, [&](int i) { matchRows(a, b, halves[i], matches); });
  constexpr int kNone = (-kReach - 1) * kSubpixels;
  cv::filterSpeckles(matches, kNone, kLeastSpeckle, kSpeckleRange);
  cv::Mat columns(now.size(), CV_32F);
  for (int row = 0; row < now.rows; ++row) {
    const short* match = matches.ptr<short>(row) + kBorder;
    auto* place = columns.ptr<float>(row);
    for (int column = 0; column < now.cols; ++column) {
      place[column] =
          match[column] < -kReach * kSubpixels
              ? kUnknown
              : static_cast<float>(column) - static_cast<float>(match[column]) / kSubpixels;
    }
  }
  return columns;
}

float between(const float* row, int columns, float place) {
  const int first = cvFloor(place);
  if (first < 0 || first + 1 >= columns) return kUnknown;
  const float share = place - static_cast<float>(first);
  return (1.0F - share) * row[first] + share * row[first + 1];
}

// Takes off what the camera's motion left: a turn moves all cells alike, a shift by disparity.
// @return  what is left of a still cell, standard deviation [px]
double takeOffCommon(const cv::Mat& disparities, cv::Mat& columns) {
  std::vector<Eigen::Vector3d> still;  // 1, disparity, residual
  for (int row = 0; row < columns.rows; row += kEach) {
    const auto* d = disparities.ptr<float>(row);
    const auto* residuals = columns.ptr<float>(row);
    for (int column = 0; column < columns.cols; column += kEach) {
      if (!std::isnan(residuals[column])) still.emplace_back(1.0, d[column], residuals[column]);
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
    const auto* d = disparities.ptr<float>(row);
    auto* residuals = columns.ptr<float>(row);
    for (int column = 0; column < columns.cols; ++column) {
      residuals[column] -= static_cast<float>(common.x() + common.y() * d[column]);
    }
  }
  return std::max(kLeastSigma, 1.4826 * median(rest));
}

}  // namespace

ResidualFlow ResidualFlowMeter::measure(const cv::Mat& image,
                                        const stereo::DisparityImage& disparity,
                                        const CameraPath& path) {
  const cv::Mat before = before_;
  before_ = image;
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
  flow.sigmas = cv::Mat(flow.columns.size(), CV_32F);
  const auto scale = static_cast<float>(disparity.reduce);
  const int columns = flow.columns.cols;
  forEachRow(flow.columns.rows, [&](int row) {
    const StillRow still_row = world.row(row);
    const auto* d = disparity.values.ptr<float>(row);
    const auto* warped_columns = warp.columns.ptr<float>(row);
    auto* cells = flow.columns.ptr<float>(row);
    auto* sigmas = flow.sigmas.ptr<float>(row);
    std::vector<float> still(columns);
    for (int column = 0; column < columns; ++column) {
      still[column] = still_row.before(column, d[column]).x;
      const float shifted = still_row.before(column, d[column] + float(kSigmaDisparity)).x;
      sigmas[column] = scale * (shifted - still[column]);
    }
    for (int column = 0; column < columns; ++column) {
      const bool known = d[column] > 0.0F && !std::isnan(cells[column]);
      cells[column] =
          known ? scale * (still[column] - between(warped_columns, columns, cells[column]))
                : kUnknown;
    }
  });
  const double noise = takeOffCommon(disparity.values, flow.columns);
  cv::multiply(flow.sigmas, flow.sigmas, flow.sigmas);
  cv::add(flow.sigmas, noise * noise, flow.sigmas);
  cv::sqrt(flow.sigmas, flow.sigmas);
  return flow;
}

}  // namespace headway::detect
