// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace headway::test {

/// An upright box with painted sides, seen from the front: centre of its front face at its foot.
struct PaintedBox {
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();      ///< camera axes of the first frame [m]
  double width = 1.8;                                  ///< [m]
  double height = 1.5;                                 ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  std::uint32_t paint = 1;
};

/// A street for tests: painted ground, a painted wall at its end, boxes on it, a driving camera.
/// Ray by ray, with noise textures: exact, and nothing to install.
class PaintedStreet {
 public:
  explicit PaintedStreet(std::vector<PaintedBox> boxes) : boxes_(std::move(boxes)) {
    auto camera = std::make_shared<StereoCamera>();
    camera->width = 560;
    camera->height = 180;
    camera->fx = camera->fy = 340.0;
    camera->cx = 279.5;
    camera->cy = 75.0;
    camera->baseline_m = 0.54;
    camera_ = camera;
  }

  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const { return camera_; }
  [[nodiscard]] double timeOf(int frame) const { return 0.1 * frame; }
  [[nodiscard]] Pose T_map_robot(int frame) const {
    Pose pose = Pose::Identity();
    pose.translation().x() = kSpeed * timeOf(frame);
    return pose;
  }
  [[nodiscard]] Eigen::Vector3d placeInCamera(const PaintedBox& box, int frame) const {
    return box.foot + timeOf(frame) * box.velocity - Eigen::Vector3d(0, 0, kSpeed * timeOf(frame));
  }

  /// @param right_late_s  the right image is taken this much after the left one
  [[nodiscard]] StereoFrame frame(int index, double right_late_s = 0.0) const {
    StereoFrame result;
    result.index = static_cast<std::size_t>(index);
    result.time = timeOf(index);
    result.camera = camera_;
    result.left = picture(timeOf(index), 0.0);
    result.right = picture(timeOf(index) + right_late_s, camera_->baseline_m);
    return result;
  }

 private:
  static constexpr double kSpeed = 5.0;         // of the camera [m/s]
  static constexpr double kCameraHeight = 1.6;  // [m]
  static constexpr double kWall = 45.0;         // at the street's end [m]

  static double lattice(std::int64_t x, std::int64_t y, std::uint32_t paint) {
    std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                      static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^ paint * 0x165667B1ULL;
    h ^= h >> 29;
    h *= 0xBF58476D1CE4E5B9ULL;
    h ^= h >> 32;
    return static_cast<double>(h & 0xFFFF) / 65535.0;
  }

  static double noise(double x, double y, std::uint32_t paint) {
    const double fx = std::floor(x), fy = std::floor(y);
    const double ax = x - fx, ay = y - fy;
    const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
    return (1 - ay) * ((1 - ax) * lattice(ix, iy, paint) + ax * lattice(ix + 1, iy, paint)) +
           ay * ((1 - ax) * lattice(ix, iy + 1, paint) + ax * lattice(ix + 1, iy + 1, paint));
  }

  // Two scales: fine for near, coarse for far.
  static double paintAt(double x, double y, std::uint32_t paint) {
    return 0.5 * noise(x / 0.12, y / 0.12, paint) + 0.5 * noise(x / 0.5, y / 0.5, paint + 7);
  }

  [[nodiscard]] cv::Mat picture(double time, double camera_x) const {
    cv::Mat image(camera_->height, camera_->width, CV_8U);
    const Eigen::Vector3d origin(camera_x, 0.0, kSpeed * time);
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector3d ray((u - camera_->cx) / camera_->fx, (v - camera_->cy) / camera_->fy,
                                  1.0);
        image.at<unsigned char>(v, u) =
            cv::saturate_cast<unsigned char>(40 + 170 * seen(origin, ray, time));
      }
    }
    return image;
  }

  [[nodiscard]] double seen(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                            double time) const {
    // The nearest surface first, and only that is painted.
    double nearest = kWall - origin.z();
    const bool on_ground = ray.y() > 1e-9 && kCameraHeight / ray.y() < nearest;
    if (on_ground) nearest = kCameraHeight / ray.y();
    const PaintedBox* box_seen = nullptr;
    Eigen::Vector3d on_box = Eigen::Vector3d::Zero();
    for (const auto& box : boxes_) {
      const Eigen::Vector3d foot = box.foot + time * box.velocity;
      const double depth = foot.z() - origin.z();
      if (depth <= 0.1 || depth >= nearest) continue;
      const Eigen::Vector3d off = origin + depth * ray - foot;
      if (std::abs(off.x()) > 0.5 * box.width || off.y() > 0.0 || off.y() < -box.height) continue;
      nearest = depth;
      box_seen = &box;
      on_box = off;
    }
    if (box_seen != nullptr) return paintAt(on_box.x(), on_box.y(), box_seen->paint);
    const Eigen::Vector3d place = origin + nearest * ray;
    if (on_ground) return 0.5 + 0.3 * (paintAt(place.x(), place.z(), 91) - 0.5);
    return paintAt(place.x() / 3, place.y() / 3, 90);
  }

  std::vector<PaintedBox> boxes_;
  std::shared_ptr<const StereoCamera> camera_;
};

}  // namespace headway::test
