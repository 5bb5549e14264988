// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_frame.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace headway::test {

/// What the front of a box shows.
enum class Surface {
  kPaint,    ///< noise of two scales
  kPickets,  ///< pickets, all alike, with gaps between them
  kRails,    ///< thin upright rods at larger distances, with a bar above
  kLeaves,   ///< two layers of fine leaves with holes
  kWindows,  ///< a house front of windows, all alike
  kGlass,    ///< reflects what is before it: an image as far behind it
};

/// An upright box, seen from the front: centre of its front face at its foot.
struct PaintedBox {
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();      ///< camera axes of the first frame [m]
  double width = 1.8;                                  ///< [m]
  double height = 1.5;                                 ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  std::uint32_t paint = 1;
  Surface surface = Surface::kPaint;
};

/// A dark patch that moves over the ground, as of somebody who walks beside the image.
struct PaintedShadow {
  Eigen::Vector2d centre =
      Eigen::Vector2d::Zero();  ///< x and z, camera axes of the first frame [m]
  double radius = 0.8;          ///< [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [m/s]
};

/// A street for tests: painted ground, a painted wall at its end, boxes on it, a driving camera.
/// Ray by ray, with noise textures: exact, and nothing to install.
class PaintedStreet {
 public:
  /// @param turn_rate_radps  of the camera, to the left
  explicit PaintedStreet(std::vector<PaintedBox> boxes, double turn_rate_radps = 0.0,
                         std::vector<PaintedShadow> shadows = {})
      : boxes_(std::move(boxes)), shadows_(std::move(shadows)), turn_rate_(turn_rate_radps) {
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
    pose.linear() = expSo3({0.0, 0.0, turn_rate_ * timeOf(frame)});
    const Eigen::Vector3d place = cameraAt(timeOf(frame)).translation();
    pose.translation() << place.z(), -place.x(), 0.0;
    return pose;
  }
  [[nodiscard]] Eigen::Vector3d placeInCamera(const PaintedBox& box, int frame) const {
    return cameraAt(timeOf(frame)).inverse() * (box.foot + timeOf(frame) * box.velocity);
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
  static constexpr double kReflected = 4.0;     // from glass to what it reflects [m]

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

  /// Pose of the left camera, in its axes of the first frame: it drives along a circle.
  [[nodiscard]] Pose cameraAt(double time) const {
    const double angle = turn_rate_ * time;
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0.0, -angle, 0.0});
    const double chord =
        std::abs(angle) < 1e-9 ? kSpeed * time : 2.0 * kSpeed / turn_rate_ * std::sin(0.5 * angle);
    pose.translation() =
        chord * Eigen::Vector3d(-std::sin(0.5 * angle), 0.0, std::cos(0.5 * angle));
    return pose;
  }

  [[nodiscard]] cv::Mat picture(double time, double camera_x) const {
    cv::Mat image(camera_->height, camera_->width, CV_8U);
    const Pose T = cameraAt(time);
    const Eigen::Vector3d origin = T * Eigen::Vector3d(camera_x, 0.0, 0.0);
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector3d ray((u - camera_->cx) / camera_->fx, (v - camera_->cy) / camera_->fy,
                                  1.0);
        image.at<unsigned char>(v, u) =
            cv::saturate_cast<unsigned char>(40 + 170 * seen(origin, T.linear() * ray, time));
      }
    }
    return image;
  }

  /// Grey of a point of a box's front, from its foot; nullopt in a gap.
  static std::optional<double> greyOf(const PaintedBox& box, const Eigen::Vector3d& off,
                                      const Eigen::Vector3d& ray) {
    const auto within = [](double place, double period) {
      return place / period - std::floor(place / period);
    };
    switch (box.surface) {
      case Surface::kPickets:
        if (within(off.x(), 0.2) > 0.5) return std::nullopt;
        return 0.8 + 0.05 * paintAt(off.x(), off.y(), box.paint);
      case Surface::kRails:
        if (within(off.x(), 0.5) > 0.12 && off.y() > 0.1 - box.height) return std::nullopt;
        return 0.15;
      case Surface::kLeaves:
        if (noise(off.x() / 0.1, off.y() / 0.1, box.paint + 3) > 0.6) return std::nullopt;
        return paintAt(2.0 * off.x(), 2.0 * off.y(), box.paint);
      case Surface::kWindows: {
        const bool window = within(off.x(), 1.5) < 0.6 && within(off.y(), 1.4) < 0.6;
        return (window ? 0.1 : 0.7) + 0.1 * paintAt(off.x(), off.y(), box.paint);
      }
      case Surface::kGlass: {
        const Eigen::Vector3d image = off + ray * (kReflected / ray.z());
        return 0.3 + 0.5 * paintAt(image.x(), image.y(), box.paint);
      }
      case Surface::kPaint:
        break;
    }
    return paintAt(off.x(), off.y(), box.paint);
  }

  [[nodiscard]] double seen(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray,
                            double time) const {
    // Distances in lengths of the ray; the nearest surface first, and only that is painted.
    double nearest = ray.z() > 0.0 ? (kWall - origin.z()) / ray.z() : 1e9;
    const bool on_ground = ray.y() > 1e-9 && kCameraHeight / ray.y() < nearest;
    if (on_ground) nearest = kCameraHeight / ray.y();
    std::optional<double> grey;
    for (const auto& box : boxes_) {
      const Eigen::Vector3d foot = box.foot + time * box.velocity;
      const double distance = (foot.z() - origin.z()) / ray.z();
      if (distance <= 0.1 || distance >= nearest) continue;
      const Eigen::Vector3d off = origin + distance * ray - foot;
      if (std::abs(off.x()) > 0.5 * box.width || off.y() > 0.0 || off.y() < -box.height) continue;
      const auto of_box = greyOf(box, off, ray);
      if (!of_box) continue;
      nearest = distance;
      grey = of_box;
    }
    if (grey) return *grey;
    const Eigen::Vector3d place = origin + nearest * ray;
    if (!on_ground) return paintAt(place.x() / 3, place.y() / 3, 90);
    const double light = 0.5 + 0.3 * (paintAt(place.x(), place.z(), 91) - 0.5);
    const bool in_shadow = std::any_of(shadows_.begin(), shadows_.end(), [&](const auto& shadow) {
      const Eigen::Vector2d off(place.x() - shadow.centre.x() - time * shadow.velocity.x(),
                                place.z() - shadow.centre.y() - time * shadow.velocity.y());
      return off.norm() < shadow.radius;
    });
    return in_shadow ? 0.4 * light : light;
  }

  std::vector<PaintedBox> boxes_;
  std::vector<PaintedShadow> shadows_;
  double turn_rate_;  ///< to the left [rad/s]
  std::shared_ptr<const StereoCamera> camera_;
};

}  // namespace headway::test
