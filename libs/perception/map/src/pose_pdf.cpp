// SPDX-License-Identifier: BSD-3-Clause
#include "pose_pdf.h"

#include <headway/core/mrpt_pose.h>

#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

/// d(yaw, pitch, roll) / d(rotation in body axes), rotation = Rz(yaw) Ry(pitch) Rx(roll).
/// @see Diebel 2006, "Representing Attitude", eq. 78 for this order of rotations
Eigen::Matrix3d eulerRates(double pitch, double roll) {
  const double cos_pitch =
      std::copysign(std::max(std::abs(std::cos(pitch)), 1e-6), std::cos(pitch));
  const double tan_pitch = std::sin(pitch) / cos_pitch;
  Eigen::Matrix3d rates;
  rates << 0.0, std::sin(roll) / cos_pitch, std::cos(roll) / cos_pitch,  //
      0.0, std::cos(roll), -std::sin(roll),                              //
      1.0, std::sin(roll) * tan_pitch, std::cos(roll) * tan_pitch;
  return rates;
}

}  // namespace

mrpt::poses::CPose3DPDFGaussian toMrptPdf(const Pose& T_map_robot,
                                          const PoseCovariance& covariance) {
  mrpt::poses::CPose3DPDFGaussian pdf;
  pdf.mean = toMrpt(T_map_robot);
  PoseCovariance jacobian = PoseCovariance::Zero();
  jacobian.topLeftCorner<3, 3>() = T_map_robot.linear();
  jacobian.bottomRightCorner<3, 3>() = eulerRates(pdf.mean.pitch(), pdf.mean.roll());
  const PoseCovariance mapped = jacobian * covariance * jacobian.transpose();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) pdf.cov(row, column) = mapped(row, column);
  }
  return pdf;
}

}  // namespace headway::map
