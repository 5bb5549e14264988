// SPDX-License-Identifier: BSD-3-Clause
// Space that was seen to be empty, and what stands in it now.
#include "empty_space.h"

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr double kMaxReach = 8.0;   // of what is remembered [m]
constexpr double kSquare = 0.1;     // side of a voxel over the ground [m]
constexpr double kSlab = 0.4;       // height of a voxel; the lowest is half of it above ground [m]
constexpr float kProof = 0.3F;      // for which a voxel is empty before what enters it is new [s]
constexpr float kMaxFilled = 3.0F;  // that is remembered of a surface in a voxel [s]
constexpr float kStay = 30.0F;      // seconds that a newcomer stays count as one

int squareOf(double metres) { return static_cast<int>(std::floor(metres / kSquare)); }
int slabOf(double height) { return static_cast<int>(std::floor(height / kSlab - 0.5)); }

}  // namespace

/// Where the points of a frame are: over the ground in the world, and above it.
class EmptySpace::View {
 public:
  View(const StereoCamera& camera, const stereo::GroundPlane& ground, const DisparityDrift& drift,
       const CameraPath& path, const Eigen::Matrix<double, 2, 3>& ground_axes)
      : camera_(camera), drift_(drift) {
    const Pose T_world_cam = path.T_cam_world(path.newest()).inverse();
    origin << ground_axes * T_world_cam.translation(), ground.camera_height;
    axes_ << ground_axes * T_world_cam.linear(), ground.up.transpose();
  }

  /// Direction of a line of sight, for a depth of 1 m.
  [[nodiscard]] Eigen::Vector3d directionAt(double u, double v) const {
    return axes_ * headway::ray({u, v}, camera_);
  }
  /// Error that a depth hardly ever exceeds [m].
  [[nodiscard]] double marginAt(double depth) const {
    const double fb = camera_.fx * camera_.baseline_m;
    const double sigma_px = std::hypot(kCellSigma, drift_.at(fb / depth));
    return kSureSigmas * sigma_px * depth * depth / fb + kSquare;
  }
  [[nodiscard]] double depthOf(double disparity) const {
    return camera_.fx * camera_.baseline_m / disparity;
  }

  Eigen::Vector3d origin;  ///< of the lines of sight

 private:
  const StereoCamera& camera_;
  const DisparityDrift& drift_;
  Eigen::Matrix3d axes_;
};

EmptySpace::EmptySpace(const StereoCamera& camera, double reach_m)
    : camera_(camera), reach_m_(std::min(kMaxReach, reach_m)) {}

cv::Mat EmptySpace::enter(const stereo::DisparityImage& disparity, const StandingCells& standing,
                          const stereo::GroundPlane& ground, const DisparityDrift& drift,
                          const CameraPath& path, const Eigen::Vector3d& up) {
  if (stacks_.empty()) {
    stacks_.resize(static_cast<std::size_t>(kSide * kSide));
    ground_axes_.row(0) = up.unitOrthogonal().transpose();
    ground_axes_.row(1) = up.cross(up.unitOrthogonal()).transpose();
  }
  const View view(camera_, ground, drift, path, ground_axes_);
  camera_x_ = squareOf(view.origin.x());
  camera_y_ = squareOf(view.origin.y());
  cv::Mat is_new(standing.disparities.size(), CV_8U, cv::Scalar(0));
  for (int row = 0; row < is_new.rows; ++row) {
    for (int column = 0; column < is_new.cols; ++column) {
      const float d = standing.disparities.at<float>(row, column);
      if (d <= 0.0F) continue;
      const double depth = view.depthOf(d);
      const Eigen::Vector3d direction =
          view.directionAt(disparity.pixelOf(column), disparity.pixelOf(row));
      const Eigen::Vector3d place = view.origin + depth * direction;
      const int slab = slabOf(place.z());
      Stack* stack = stackAt(squareOf(place.x()), squareOf(place.y()));
      if (stack == nullptr || slab < 0 || slab >= kSlabs) continue;
      Voxel& voxel = stack->voxels[slab];
      voxel.seen = Seen::kSurface;
      if (voxel.empty > -kProof) is_new.at<unsigned char>(row, column) = kUndecided;
      if (isNewAt(place) && isNewAt(place + view.marginAt(depth) * direction)) {
        is_new.at<unsigned char>(row, column) = kNew;
      }
    }
  }
  castRays(view, disparity);
  update(static_cast<float>(path.lastStep_s()));
  return is_new;
}

EmptySpace::Stack* EmptySpace::stackAt(int x, int y) {
  if (2 * std::max(std::abs(x - camera_x_), std::abs(y - camera_y_)) >= kSide) return nullptr;
  Stack& stack = stacks_[(y & (kSide - 1)) * kSide + (x & (kSide - 1))];
  if (stack.x != x || stack.y != y) stack = {x, y, {}};
  return &stack;
}

bool EmptySpace::isNewAt(const Eigen::Vector3d& place) {
  const int x = squareOf(place.x()), y = squareOf(place.y());
  const int slab = std::clamp(slabOf(place.z()), 0, kSlabs - 1);
  Stack* stack = stackAt(x, y);
  if (stack == nullptr) return false;
  Newness& newness = stack->voxels[slab].newness;
  if (newness == Newness::kUnknown) newness = isNew(x, y, slab) ? Newness::kNew : Newness::kOld;
  return newness == Newness::kNew;
}

// The voxel was empty, and no voxel beside it has a surface of the scene: edges of what is near
// appear up to half a block beside it.
bool EmptySpace::isNew(int x, int y, int slab) {
  if (stackAt(x, y)->voxels[slab].empty < kProof) return false;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const Stack* beside = stackAt(x + dx, y + dy);
      if (beside != nullptr && beside->voxels[slab].empty < 0.0F) return false;
    }
  }
  return true;
}

void EmptySpace::castRays(const View& view, const stereo::DisparityImage& disparity) {
  // Two lines of sight through each voxel within reach.
  const double cell_m = reach_m_ * disparity.reduce / camera_.fx;
  const int columns = std::max(1, static_cast<int>(0.5 * kSquare / cell_m));
  const int rows = std::max(1, static_cast<int>(0.5 * kSlab / cell_m));
  for (int row = rows / 2; row < disparity.values.rows; row += rows) {
    for (int column = columns / 2; column < disparity.values.cols; column += columns) {
      const float d = disparity.values.at<float>(row, column);
      if (d <= 0.0F) continue;
      const Eigen::Vector3d direction =
          view.directionAt(disparity.pixelOf(column), disparity.pixelOf(row));
      const double depth = view.depthOf(d);
      const double over_ground = direction.head<2>().norm();
      const double end = std::min(depth - view.marginAt(depth), reach_m_ / over_ground);
      const double step = kSquare / over_ground;
      for (double at = 0.5 * step; at < end; at += step) {
        const Eigen::Vector3d place = view.origin + at * direction;
        const int slab = slabOf(place.z());
        if (slab < 0 || slab >= kSlabs) continue;
        Stack* stack = stackAt(squareOf(place.x()), squareOf(place.y()));
        if (stack == nullptr) break;
        Seen& seen = stack->voxels[slab].seen;
        if (seen == Seen::kNothing) seen = Seen::kEmpty;
      }
    }
  }
}

void EmptySpace::update(float seconds) {
  for (Stack& stack : stacks_) {
    for (Voxel& voxel : stack.voxels) {
      if (voxel.seen == Seen::kEmpty) {
        voxel.empty = std::min(1.0F, voxel.empty + seconds);
      } else if (voxel.seen == Seen::kSurface) {
        voxel.empty =
            std::max(-kMaxFilled, voxel.empty - (voxel.empty < kProof ? seconds : seconds / kStay));
      }
      voxel.seen = Seen::kNothing;
      voxel.newness = Newness::kUnknown;
    }
  }
}

}  // namespace headway::detect
