// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/camera_info.h>

#include <algorithm>
#include <cmath>

#include "text_rows.h"

namespace headway::io {
namespace {

constexpr int kMaxSide = 1 << 15;            // [px]
constexpr double kMinFocalRatio = 0.1;       // to the side of the image
constexpr double kMaxFocalRatio = 30.0;      // likewise
constexpr double kMaxCoefficient = 1e4;      // of a rational lens; others have less than 10
constexpr double kMaxTangential = 1.0;       // p1 and p2 of any lens
constexpr double kMaxBaselineOfRobot = 5.0;  // [m]
constexpr double kRotationError = 1e-3;

Eigen::Matrix3d rectifyingRotation(const CameraInfo& info) {
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.R.data());
  if (R.isZero(0.0)) return Eigen::Matrix3d::Identity();
  if (!R.allFinite() || !(R * R.transpose()).isIdentity(kRotationError) || R.determinant() < 0.0) {
    throw InputError("rectification_matrix (R) is not a rotation");
  }
  return R;
}

/// Displacement of the rectified camera along x: of P = K [I | -t], the fourth column over fx.
double displacement(const CameraInfo& info) {
  return info.P[0] > 0.0 ? -info.P[3] / info.P[0] : 0.0;
}

void setDistortion(RawCamera& lens, const CameraInfo& info) {
  const std::string& model = info.distortion_model;
  const std::size_t last =
      info.D.size() - static_cast<std::size_t>(std::find_if(info.D.rbegin(), info.D.rend(),
                                                            [](double k) { return k != 0.0; }) -
                                               info.D.rbegin());
  std::size_t most = lens.distortion.size();
  if (model == "equidistant" || model == "fisheye" || model == "kannala_brandt") {
    lens.is_fisheye = true;
    most = 4;
  } else if (model == "rational_polynomial" || model == "rational") {
    most += lens.rational.size();
  } else if (!model.empty() && model != "plumb_bob" && model != "radtan" && model != "none") {
    throw InputError("distortion_model '" + model +
                     "' is not supported; supported are plumb_bob, rational_polynomial and "
                     "equidistant: record rectified images instead");
  }
  if (last > most) {
    throw InputError("distortion_coefficients (D) has " + std::to_string(last) + " values, " +
                     std::to_string(most) + " are possible for '" + model + "'");
  }
  for (std::size_t i = 0; i < last; ++i) {
    (i < lens.distortion.size() ? lens.distortion[i] : lens.rational[i - lens.distortion.size()]) =
        info.D[i];
  }
}

std::string focalFault(const char* name, double focal, int side) {
  if (!std::isfinite(focal) || focal <= 0.0) {
    return std::string("the focal length ") + name + " is " + formatted("%g", focal);
  }
  if (focal >= kMinFocalRatio * side && focal <= kMaxFocalRatio * side) return "";
  return std::string("the focal length ") + name + " is " + formatted("%g", focal) +
         " in an image of " + std::to_string(side) + " px: in pixels?";
}

}  // namespace

RawCamera lensFrom(const CameraInfo& info, ImageKind kind) {
  RawCamera lens;
  lens.width = info.width;
  lens.height = info.height;
  if (kind == ImageKind::kRectified) {
    lens.fx = info.P[0];
    lens.fy = info.P[5];
    lens.cx = info.P[2];
    lens.cy = info.P[6];
    return lens;
  }
  lens.fx = info.K[0];
  lens.fy = info.K[4];
  lens.cx = info.K[2];
  lens.cy = info.K[5];
  setDistortion(lens, info);
  return lens;
}

std::optional<Pose> rightInLeft(const CameraInfo& left, const CameraInfo& right, ImageKind kind) {
  const double baseline = displacement(right) - displacement(left);
  if (!std::isfinite(baseline) || baseline == 0.0) return std::nullopt;
  Pose T_left_right = Pose::Identity();
  T_left_right.translation().x() = baseline;
  if (kind == ImageKind::kRectified) return T_left_right;
  const Eigen::Matrix3d R_rectified_left = rectifyingRotation(left);
  T_left_right.linear() = R_rectified_left.transpose() * rectifyingRotation(right);
  T_left_right.translation() = R_rectified_left.transpose() * T_left_right.translation();
  return T_left_right;
}

std::string lensFault(const RawCamera& lens) {
  if (lens.width <= 0 || lens.height <= 0 || lens.width > kMaxSide || lens.height > kMaxSide) {
    return "the image has " + std::to_string(lens.width) + " x " + std::to_string(lens.height) +
           " px: width and height in pixels?";
  }
  std::string fault = focalFault("fx", lens.fx, lens.width);
  if (fault.empty()) fault = focalFault("fy", lens.fy, lens.height);
  if (!fault.empty()) return fault;
  const auto is_outside = [](double value, int side) {
    return !(value >= -0.5 * side && value <= 1.5 * side);
  };
  const bool is_relative = std::abs(lens.cx) < 1.0 && std::abs(lens.cy) < 1.0;
  if (is_outside(lens.cx, lens.width) || is_outside(lens.cy, lens.height) ||
      (is_relative && lens.width > 4 && lens.height > 4)) {
    return "the principal point is " + formatted("%g, %g", lens.cx, lens.cy) + " in an image of " +
           std::to_string(lens.width) + " x " + std::to_string(lens.height) +
           " px: fx, fy, cx, cy in this order, in pixels?";
  }
  const auto is_impossible = [](double k) { return !(std::abs(k) <= kMaxCoefficient); };
  if (std::any_of(lens.distortion.begin(), lens.distortion.end(), is_impossible) ||
      std::any_of(lens.rational.begin(), lens.rational.end(), is_impossible)) {
    return "a distortion coefficient is beyond 10000";
  }
  const bool is_tangential = std::abs(lens.distortion[2]) > kMaxTangential ||
                             std::abs(lens.distortion[3]) > kMaxTangential;
  if (!lens.is_fisheye && is_tangential) {
    return "p1, p2 are " + formatted("%g, %g", lens.distortion[2], lens.distortion[3]) +
           ": k1, k2, p1, p2, k3 in this order?";
  }
  return "";
}

std::string baselineFault(double baseline_m) {
  if (baseline_m <= kMaxBaselineOfRobot) return "";
  const bool in_cm = baseline_m < 10.0 * kMaxBaselineOfRobot;
  return "in metres? " + formatted("%.6g", baseline_m * (in_cm ? 1e-2 : 1e-3)) + " if it is in " +
         (in_cm ? "centimetres" : "millimetres");
}

}  // namespace headway::io
