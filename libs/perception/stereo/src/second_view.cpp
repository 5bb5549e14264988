// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/second_view.h>

#include <Eigen/Cholesky>
#include <cmath>

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

}  // namespace headway::stereo
