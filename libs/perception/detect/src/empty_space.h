// SPDX-License-Identifier: BSD-3-Clause
// Space that was seen to be empty, and what stands in it now.
#pragma once

#include <headway/core/stereo_camera.h>

#include <array>
#include <vector>

#include "camera_path.h"
#include "disparity_drift.h"
#include "upright_segments.h"

namespace headway::detect {

/// Remembers which space near the camera was empty, so that what enters it is found however it
/// moves: head-on too, and when it has stopped.
///
/// Every line of sight passes through empty space, up to three standard deviations before the
/// surface that ends it: of a cell's disparity and of its drift, which is measured. Voxels of 0.1 x
/// 0.1 x 0.4 m, in the world of the camera's path, count the seconds for which they were empty,
/// less those for which a surface was in them, so that single wrong matches prove nothing. What
/// stands in a voxel that was proved to be empty is new there, and remains so for about 20 s, until
/// it belongs to the scene.
///
/// @see  Azim & Aycard 2012, "Detection, classification and tracking of moving objects in a 3D
///       environment" (changes of occupancy)
class EmptySpace {
 public:
  static constexpr unsigned char kNew = 255, kUndecided = 128;

  /// @param reach_m  distance over the ground up to which space is remembered, at most 8 m
  EmptySpace(const StereoCamera& camera, double reach_m);

  /// Enters the newest frame of the path.
  ///
  /// @param up  unit normal of the ground, world of the path
  /// @return    for each cell of the disparity image kNew if it stands where space was empty before
  ///            this frame, kUndecided where neither that is known nor a surface was before, else 0
  [[nodiscard]] cv::Mat enter(const stereo::DisparityImage& disparity,
                              const StandingCells& standing, const stereo::GroundPlane& ground,
                              const DisparityDrift& drift, const CameraPath& path,
                              const Eigen::Vector3d& up);

  /// Distance over the ground up to which space is remembered [m].
  [[nodiscard]] double reach() const { return reach_m_; }
  /// Forgets everything.
  void clear() { stacks_.clear(); }

 private:
  static constexpr int kSlabs = 5;
  static constexpr int kSide = 256;  ///< squares to a side of the remembered ground, a power of two
  enum class Seen : unsigned char { kNothing, kEmpty, kSurface };
  enum class Newness : unsigned char { kUnknown, kNew, kOld };
  struct Voxel {
    float empty = 0.0F;                   ///< for how long it was empty, less occupied [s]
    Seen seen = Seen::kNothing;           ///< in this frame
    Newness newness = Newness::kUnknown;  ///< on what stands there in this frame
  };
  /// Voxels above one square of the ground.
  struct Stack {
    int x = 0, y = 0;  ///< of the square that it stands for
    std::array<Voxel, kSlabs> voxels;
  };
  class View;

  [[nodiscard]] Stack* stackAt(int x, int y);
  [[nodiscard]] bool isNewAt(const Eigen::Vector3d& place);
  [[nodiscard]] bool isNew(int x, int y, int slab);
  void castRays(const View& view, const stereo::DisparityImage& disparity);
  void update(float seconds);

  StereoCamera camera_;
  double reach_m_;
  std::vector<Stack> stacks_;        ///< that of square (x, y) is at (x, y), both modulo kSide
  int camera_x_ = 0, camera_y_ = 0;  ///< square that the camera is above
  Eigen::Matrix<double, 2, 3> ground_axes_ = Eigen::Matrix<double, 2, 3>::Zero();  ///< in the world
};

}  // namespace headway::detect
