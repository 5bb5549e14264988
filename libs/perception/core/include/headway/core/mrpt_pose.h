// SPDX-License-Identifier: BSD-3-Clause
// Poses to and from those of MRPT.
#pragma once

#include <headway/core/pose.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DQuat.h>

namespace headway {

// Conversions between the poses used inside and those at the MRPT boundary. Header only: code that
// includes it links mrpt::poses.

/// The pose's rotation, made orthonormal.
[[nodiscard]] inline mrpt::math::CQuaternionDouble toMrptQuaternion(const Pose& pose) {
  const Eigen::Quaterniond turn = quaternionOf(pose);
  return {turn.w(), turn.x(), turn.y(), turn.z()};
}

/// The pose with its rotation made orthonormal.
[[nodiscard]] inline mrpt::poses::CPose3D toMrpt(const Pose& pose) {
  const auto& t = pose.translation();
  return {toMrptQuaternion(pose), t.x(), t.y(), t.z()};
}

/// The same as a CPose3DQuat, the type of camera poses in stereo observations.
[[nodiscard]] inline mrpt::poses::CPose3DQuat toMrptQuat(const Pose& pose) {
  const auto& t = pose.translation();
  return {t.x(), t.y(), t.z(), toMrptQuaternion(pose)};
}

/// Inverse of toMrpt.
[[nodiscard]] inline Pose fromMrpt(const mrpt::poses::CPose3D& pose) {
  Pose result = Pose::Identity();
  result.linear() = pose.getRotationMatrix().asEigen();
  result.translation() << pose.x(), pose.y(), pose.z();
  return result;
}

/// Inverse of toMrptQuat.
[[nodiscard]] inline Pose fromMrpt(const mrpt::poses::CPose3DQuat& pose) {
  const auto& q = pose.quat();
  Pose result = Pose::Identity();
  result.linear() = Eigen::Quaterniond(q.r(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
  result.translation() << pose.x(), pose.y(), pose.z();
  return result;
}

}  // namespace headway
