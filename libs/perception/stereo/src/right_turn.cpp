// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/right_turn.h>

#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

Eigen::Vector2d pixelThrough(const Eigen::Matrix3d& rotation, const Eigen::Vector2d& uv,
                             const StereoCamera& camera) {
  const Eigen::Vector3d seen = rotation * ray(uv, camera);
  return {camera.fx * seen.x() / seen.z() + camera.cx, camera.fy * seen.y() / seen.z() + camera.cy};
}

}  // namespace

Eigen::Vector2d turnedPixel(const Eigen::Vector2d& right, const Eigen::Vector3d& angles,
                            const StereoCamera& camera) {
  return pixelThrough(expSo3(angles).transpose(), right, camera);
}

double turnedDisparity(const Eigen::Vector2d& uv, double disparity, const Eigen::Vector3d& from,
                       const Eigen::Vector3d& to, const StereoCamera& camera) {
  const Eigen::Vector2d right(uv.x() - disparity, uv.y());
  return uv.x() - pixelThrough(expSo3(to) * expSo3(from).transpose(), right, camera).x();
}

RightTurn::RightTurn(const Eigen::Vector3d& angles, const StereoCamera& camera) : angles_(angles) {
  if (angles.isZero()) return;
  const Eigen::Matrix3d rotation = expSo3(angles).transpose();
  cv::Mat_<cv::Vec2f> map(camera.height, camera.width);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2f at = pixelThrough(rotation, {u, v}, camera).cast<float>();
      map(v, u) = {at.x(), at.y()};
    }
  }
  cv::convertMaps(map, cv::noArray(), places_, fractions_, CV_16SC2);
}

cv::Mat RightTurn::undone(const cv::Mat& right) const {
  if (places_.empty() || right.empty()) return right;
  cv::Mat exact;
  cv::remap(right, exact, places_, fractions_, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return exact;
}

}  // namespace headway::stereo
