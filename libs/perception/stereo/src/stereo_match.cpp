// SPDX-License-Identifier: BSD-3-Clause
// Disparities of single points, by matching or from a depth camera.
#include <headway/stereo/patch.h>
#include <headway/stereo/stereo_match.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/core/utility.hpp>

namespace headway::stereo {
namespace {

constexpr int kWindowRadius = 2;      // of the pixels that a plane is fitted to
constexpr double kMaxSlope = 2.0;     // between neighbouring pixels; steeper is an edge [px]
constexpr double kMaxResidual = 1.2;  // of the pixels from the plane, RMS [px]
constexpr int kMinPixels = 15;        // of 25

}  // namespace

std::optional<double> givenDisparity(const cv::Mat& disparities, const Eigen::Vector2d& uv) {
  const int u = static_cast<int>(std::lround(uv.x()));
  const int v = static_cast<int>(std::lround(uv.y()));
  if (u < kWindowRadius || v < kWindowRadius || u >= disparities.cols - kWindowRadius ||
      v >= disparities.rows - kWindowRadius) {
    return std::nullopt;
  }
  if (!(disparities.at<float>(v, u) > 0.0F)) return std::nullopt;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0.0;
  int pixels = 0;
  for (int row = v - kWindowRadius; row <= v + kWindowRadius; ++row) {
    const auto* values = disparities.ptr<float>(row);
    for (int column = u - kWindowRadius; column <= u + kWindowRadius; ++column) {
      const auto d = static_cast<double>(values[column]);
      if (!(d > 0.0)) continue;
      const Eigen::Vector3d place(column - uv.x(), row - uv.y(), 1.0);
      normal += place * place.transpose();
      sum += d * place;
      squares += d * d;
      ++pixels;
    }
  }
  if (pixels < kMinPixels) return std::nullopt;
  const Eigen::Vector3d plane = normal.ldlt().solve(sum);
  const double residual = (squares - plane.dot(sum)) / pixels;  // squared
  const bool is_surface = plane.head<2>().cwiseAbs().maxCoeff() <= kMaxSlope &&
                          residual <= kMaxResidual * kMaxResidual && plane.z() > 0.0;
  return is_surface ? std::optional(plane.z()) : std::nullopt;
}

namespace {

constexpr int kSearchLevel = 1;  ///< pyramid level of the search over all disparities
constexpr int kBlockRadius = 4;  ///< the blocks compared are 9 x 9
constexpr int kBlockSide = 2 * kBlockRadius + 1;
constexpr int kBlockArea = kBlockSide * kBlockSide;

/// Squared differences of two blocks less the square of their mean difference, times the area.
int blockCost(const cv::Mat& a, int ua, const cv::Mat& b, int ub, int v) {
  int sum = 0;
  int squares = 0;
  for (int r = v - kBlockRadius; r <= v + kBlockRadius; ++r) {
    const auto* pa = a.ptr<std::uint8_t>(r) + ua - kBlockRadius;
    const auto* pb = b.ptr<std::uint8_t>(r) + ub - kBlockRadius;
    for (int c = 0; c < kBlockSide; ++c) {
      const int difference = pa[c] - pb[c];
      sum += difference;
      squares += difference * difference;
    }
  }
  return kBlockArea * squares - sum * sum;
}

/// Column in [first, last] of `b` most similar to column u of `a`; nullopt if not unique.
std::optional<int> bestColumn(const cv::Mat& a, int u, const cv::Mat& b, int first, int last,
                              int v) {
  constexpr double kUniqueness = 0.8;  ///< best cost / best cost elsewhere, at most
  if (last < first) return std::nullopt;
  cv::AutoBuffer<int> costs(static_cast<std::size_t>(last - first + 1));  // on the stack
  int best = first;
  int lowest = std::numeric_limits<int>::max();
  for (int candidate = first; candidate <= last; ++candidate) {
    const int cost = blockCost(a, u, b, candidate, v);
    costs[static_cast<std::size_t>(candidate - first)] = cost;
    if (cost < lowest) {
      lowest = cost;
      best = candidate;
    }
  }
  for (int candidate = first; candidate <= last; ++candidate) {
    const bool elsewhere = std::abs(candidate - best) > 2;
    if (elsewhere && lowest > kUniqueness * costs[static_cast<std::size_t>(candidate - first)])
      return std::nullopt;
  }
  return best;
}

}  // namespace

std::optional<double> StereoMatcher::search(const ImagePyramid& left, const SecondView& second,
                                            const Eigen::Vector2d& uv) const {
  if (second.isDepth()) return givenDisparity(second.disparities, uv);
  const ImagePyramid& right = second.image;
  const int level = std::min({kSearchLevel, left.count() - 1, right.count() - 1});
  const cv::Mat& a = left.levels[level];
  const cv::Mat& b = right.levels[level];
  const int scale = 1 << level;
  const int u = static_cast<int>(std::lround(uv.x() / scale));
  const int v = static_cast<int>(std::lround(uv.y() / scale));
  const int low = kBlockRadius;
  const int high = a.cols - 1 - kBlockRadius;
  if (u < low || u > high || v < low || v > a.rows - 1 - kBlockRadius) return std::nullopt;
  const int range = max_disparity_ / scale;
  const auto match = bestColumn(a, u, b, std::max(low, u - range), std::min(high, u + 1), v);
  if (!match) return std::nullopt;
  const auto back =
      bestColumn(b, *match, a, std::max(low, *match - 1), std::min(high, *match + range), v);
  if (!back || std::abs(*back - u) > 1) return std::nullopt;
  const auto coarse = refine(left, second, uv, static_cast<double>(u - *match) * scale, level);
  if (!coarse) return std::nullopt;
  return refine(left, second, uv, *coarse, 0);
}

std::optional<double> StereoMatcher::refine(const ImagePyramid& left, const SecondView& second,
                                            const Eigen::Vector2d& uv, double expected,
                                            int level) const {
  if (second.isDepth()) return givenDisparity(second.disparities, uv);
  const double scale = 1 << level;
  const auto patch = cutPatch(left.levels[level], uv / scale);
  if (!patch) return std::nullopt;
  const Eigen::Vector2d start(uv.x() - expected, uv.y());
  const auto found = align(*patch, second.image.levels[level], start / scale, AlignmentAxes::kRow);
  if (!found || !found->converged || found->zncc < min_zncc_) return std::nullopt;
  const double disparity = uv.x() - scale * found->uv.x();
  if (!(disparity > 0.0) || disparity > max_disparity_) return std::nullopt;
  return disparity;
}

}  // namespace headway::stereo
