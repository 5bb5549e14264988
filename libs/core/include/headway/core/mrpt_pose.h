#pragma once

#include <headway/core/pose.h>
#include <mrpt/poses/CPose3D.h>

namespace headway {

// The one pair of conversions between the poses inside and those at the MRPT boundary. Header
// only: whoever includes it links mrpt::poses.

/// Exact up to rounding; the rotation must be orthonormal.
[[nodiscard]] inline mrpt::poses::CPose3D toMrpt(const Pose& pose) {
  mrpt::math::CMatrixDouble44 matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) matrix(row, column) = pose(row, column);
  }
  return mrpt::poses::CPose3D(matrix);
}

/// Inverse of toMrpt.
[[nodiscard]] inline Pose fromMrpt(const mrpt::poses::CPose3D& pose) {
  const auto matrix = pose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>();
  Pose result = Pose::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) result(row, column) = matrix(row, column);
  }
  return result;
}

}  // namespace headway
