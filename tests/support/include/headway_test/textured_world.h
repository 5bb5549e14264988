// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace headway::test {

/// A flat textured board: origin + a * u + b * v, 0 <= a <= width, 0 <= b <= height.
struct Board {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();          ///< map frame [m]
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();              ///< unit vector along its width
  Eigen::Vector3d v = Eigen::Vector3d::UnitZ();              ///< unit vector along its height
  double width = 1.0;                                        ///< [m]
  double height = 1.0;                                       ///< [m]
  Eigen::Vector2d texture_offset = Eigen::Vector2d::Zero();  ///< [m]
};

/// Boards with a noise texture, seen by a stereo camera by casting a ray through every pixel.
class TexturedWorld {
 public:
  explicit TexturedWorld(const StereoCamera& camera, int seed = 1)
      : camera_(std::make_shared<StereoCamera>(camera)) {
    cv::Mat texture(kSide, kSide, CV_32F, cv::Scalar(0));
    cv::RNG random(static_cast<std::uint64_t>(seed));
    for (int cells = 16; cells <= kSide; cells *= 2) {
      cv::Mat octave(cells, cells, CV_32F), scaled;
      random.fill(octave, cv::RNG::UNIFORM, -1.0, 1.0);
      cv::resize(octave, scaled, texture.size(), 0, 0, cv::INTER_CUBIC);
      texture += scaled;
    }
    cv::Mat grey;
    texture.convertTo(grey, CV_8U, 32.0, 128.0);
    for (int level = 0; level < 6; ++level) {
      mipmaps_.push_back(grey.clone());
      cv::resize(grey, grey, cv::Size(), 0.5, 0.5, cv::INTER_AREA);
    }
  }

  std::vector<Board> boards;
  /// Rotation vector of the right camera against its calibration, along its axes [rad].
  Eigen::Vector3d right_turn = Eigen::Vector3d::Zero();

  /// Floor, ceiling and four walls, all seen from inside [m].
  void addRoom(double length, double width, double height) {
    using V = Eigen::Vector3d;
    const V low(-length / 2, -width / 2, -height / 2);
    const V x = V::UnitX(), y = V::UnitY(), z = V::UnitZ();
    boards.push_back({low, x, y, length, width, {0.0, 0.0}});
    boards.push_back({low + height * z, x, y, length, width, {3.1, 1.7}});
    boards.push_back({low, x, z, length, height, {5.3, 0.3}});
    boards.push_back({low + width * y, x, z, length, height, {1.9, 4.1}});
    boards.push_back({low, y, z, width, height, {7.7, 2.3}});
    boards.push_back({low + length * x, y, z, width, height, {0.7, 6.1}});
  }

  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const { return camera_; }

  /// A frame of the covered camera.
  [[nodiscard]] StereoFrame covered() const {
    StereoFrame frame;
    frame.left = frame.right = cv::Mat(camera_->height, camera_->width, CV_8U, cv::Scalar(9));
    frame.camera = camera_;
    return frame;
  }

  /// The pair that a robot sees from a pose.
  [[nodiscard]] StereoFrame frame(std::size_t index, Time time, const Pose& T_map_robot) const {
    StereoFrame result;
    result.index = index;
    result.time = time;
    result.camera = camera_;
    const Pose T_map_left = T_map_robot * camera_->T_robot_cam;
    Pose T_map_right = T_map_left;
    T_map_right.translation() = T_map_left * Eigen::Vector3d(camera_->baseline_m, 0.0, 0.0);
    T_map_right.linear() = T_map_left.linear() * expSo3(right_turn);
    result.left = view(T_map_left);
    result.right = view(T_map_right);
    return result;
  }

 private:
  static constexpr int kSide = 512;        ///< of the texture, which repeats [px]
  static constexpr double kTexelM = 0.02;  ///< [m]

  /// A board as one camera sees it: what does not depend on the pixel is computed once.
  struct SeenBoard {
    Eigen::Vector3d normal, u, v;
    double distance = 0.0;                             ///< of the camera to its plane [m]
    Eigen::Vector2d camera = Eigen::Vector2d::Zero();  ///< above the board, along u and v [m]
    Eigen::Vector2d size = Eigen::Vector2d::Zero();    ///< [m]
    Eigen::Vector2d texture_offset = Eigen::Vector2d::Zero();  ///< [m]
  };

  [[nodiscard]] std::vector<SeenBoard> seenFrom(const Eigen::Vector3d& centre) const {
    std::vector<SeenBoard> seen;
    for (const Board& board : boards) {
      const Eigen::Vector3d normal = board.u.cross(board.v);
      const Eigen::Vector3d offset = centre - board.origin;
      seen.push_back({normal,
                      board.u,
                      board.v,
                      -normal.dot(offset),
                      {board.u.dot(offset), board.v.dot(offset)},
                      {board.width, board.height},
                      board.texture_offset});
    }
    return seen;
  }

  [[nodiscard]] cv::Mat view(const Pose& T_map_cam) const {
    const auto seen = seenFrom(T_map_cam.translation());
    cv::Mat image(camera_->height, camera_->width, CV_8U);
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector3d direction = T_map_cam.linear() * ray(Eigen::Vector2d(u, v), *camera_);
        image.at<std::uint8_t>(v, u) = cast(seen, direction);
      }
    }
    return image;
  }

  [[nodiscard]] std::uint8_t cast(const std::vector<SeenBoard>& seen,
                                  const Eigen::Vector3d& direction) const {
    double nearest = std::numeric_limits<double>::max();
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    for (const SeenBoard& board : seen) {
      const double slope = board.normal.dot(direction);
      if (std::abs(slope) < 1e-9) continue;
      const double depth = board.distance / slope;
      if (depth < 0.05 || depth >= nearest) continue;
      const double x = board.camera.x() + depth * board.u.dot(direction);
      const double y = board.camera.y() + depth * board.v.dot(direction);
      if (x < 0.0 || y < 0.0 || x > board.size.x() || y > board.size.y()) continue;
      nearest = depth;
      at = Eigen::Vector2d(x, y) + board.texture_offset;
    }
    if (nearest == std::numeric_limits<double>::max()) return 0;
    return texel(at, nearest / camera_->fx);
  }

  /// The mipmap whose texels are nearest in size to a pixel, in powers of two.
  [[nodiscard]] std::size_t levelOf(double pixel_m) const {
    std::size_t level = 0;
    double limit = kTexelM * M_SQRT2;
    while (level + 1 < mipmaps_.size() && pixel_m >= limit) {
      ++level;
      limit *= 2.0;
    }
    return level;
  }

  /// Bilinear sample of the mipmap that fits a pixel of this size [m].
  [[nodiscard]] std::uint8_t texel(const Eigen::Vector2d& at, double pixel_m) const {
    const std::size_t level = levelOf(pixel_m);
    const cv::Mat& texture = mipmaps_[level];
    const double scale = 1.0 / (kTexelM * static_cast<double>(1 << level));
    const double x = at.x() * scale - 0.5;
    const double y = at.y() * scale - 0.5;
    const double x0 = std::floor(x), y0 = std::floor(y);
    const int mask = texture.cols - 1;  // the sides are powers of two, and the texture repeats
    const int left = static_cast<int>(x0) & mask;
    const int right = (left + 1) & mask;
    const auto* upper_row = texture.ptr<std::uint8_t>(static_cast<int>(y0) & mask);
    const auto* lower_row = texture.ptr<std::uint8_t>((static_cast<int>(y0) + 1) & mask);
    const double fx = x - x0, fy = y - y0;
    const double upper = (1 - fx) * upper_row[left] + fx * upper_row[right];
    const double lower = (1 - fx) * lower_row[left] + fx * lower_row[right];
    return static_cast<std::uint8_t>(std::lround((1 - fy) * upper + fy * lower));
  }

  std::shared_ptr<StereoCamera> camera_;
  std::vector<cv::Mat> mipmaps_;
};

/// A small rectified pair that faces along the robot's x axis.
inline StereoCamera smallCamera() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 240.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  camera.baseline_m = 0.2;
  return camera;
}

}  // namespace headway::test
