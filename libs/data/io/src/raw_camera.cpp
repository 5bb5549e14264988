// SPDX-License-Identifier: BSD-3-Clause
// Cameras as recorded: lenses and rigs, ROS' and MRPT's descriptions of them, and what is
// impossible.
#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/raw_camera.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <algorithm>
#include <cmath>

#include "text_rows.h"

namespace headway::io {
namespace {

// Errors of structured light and of stereo cameras, see equivalentBaseline().
constexpr double kDepthNoise = 0.0025;     // error of a depth by its square [1/m]
constexpr double kSigmaDisparityPx = 0.4;  // as assumed of stereo cameras

constexpr int kMaxSide = 1 << 15;        // [px]
constexpr double kMaxCoefficient = 1e4;  // of a rational lens; others have less than 10
constexpr double kMaxTangential = 1.0;   // p1 and p2 of any lens

Eigen::Matrix3d rectifyingRotation(const CameraInfo& info) {
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.R.data());
  if (R.isZero(0.0)) return Eigen::Matrix3d::Identity();
  if (!isRotation(R)) throw InputError("rectification_matrix (R) is not a rotation");
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

double equivalentBaseline(double focal_px) { return kSigmaDisparityPx / (kDepthNoise * focal_px); }

std::string baselineFault(double baseline_m) {
  if (baseline_m <= kMaxBaseline_m) return "";
  const bool in_cm = baseline_m < 10.0 * kMaxBaseline_m;
  return "in metres? " + formatted("%.6g", baseline_m * (in_cm ? 1e-2 : 1e-3)) + " if it is in " +
         (in_cm ? "centimetres" : "millimetres");
}

RawStereoCamera rawFrom(const StereoCamera& camera) {
  RawStereoCamera raw;
  raw.left.width = camera.width;
  raw.left.height = camera.height;
  raw.left.fx = camera.fx;
  raw.left.fy = camera.fy;
  raw.left.cx = camera.cx;
  raw.left.cy = camera.cy;
  raw.right = raw.left;
  raw.T_robot_left = camera.T_robot_cam;
  raw.T_left_right.translation().x() = camera.baseline_m;
  return raw;
}

RawCamera rawCamera(const mrpt::img::TCamera& camera) {
  using mrpt::img::DistortionModel;
  RawCamera raw;
  raw.width = static_cast<int>(camera.ncols);
  raw.height = static_cast<int>(camera.nrows);
  raw.fx = camera.fx();
  raw.fy = camera.fy();
  raw.cx = camera.cx();
  raw.cy = camera.cy();
  if (camera.distortion == DistortionModel::plumb_bob) {
    const auto rational = camera.dist.begin() + raw.distortion.size();
    std::copy(camera.dist.begin(), rational, raw.distortion.begin());
    std::copy(rational, camera.dist.end(), raw.rational.begin());
  } else if (camera.distortion == DistortionModel::kannala_brandt) {
    raw.is_fisheye = true;
    raw.distortion = {camera.k1(), camera.k2(), camera.k3(), camera.k4(), 0.0};
  }
  return raw;
}

mrpt::img::TCamera mrptCamera(const RawCamera& camera, const std::string& name) {
  mrpt::img::TCamera result;
  result.ncols = static_cast<uint32_t>(camera.width);
  result.nrows = static_cast<uint32_t>(camera.height);
  result.cameraName = name;
  result.setIntrinsicParamsFromValues(camera.fx, camera.fy, camera.cx, camera.cy);
  const auto is_set = [](double k) { return k != 0.0; };
  const auto& d = camera.distortion;
  const auto& more = camera.rational;
  if (camera.is_fisheye) {
    result.setDistortionKannalaBrandt(d[0], d[1], d[2], d[3]);
  } else if (std::any_of(d.begin(), d.end(), is_set) ||
             std::any_of(more.begin(), more.end(), is_set)) {
    result.setDistortionPlumbBob(d[0], d[1], d[2], d[3], d[4]);
    std::copy(more.begin(), more.end(), result.dist.begin() + d.size());
  }
  return result;
}

void setCalibration(const RawStereoCamera& camera,
                    mrpt::obs::CObservationStereoImages& observation) {
  observation.leftCamera = mrptCamera(camera.left, "left");
  observation.rightCamera = mrptCamera(camera.right, "right");
  observation.cameraPose = toMrptQuat(camera.T_robot_left);
  observation.rightCameraPose = toMrptQuat(camera.T_left_right);
  // MRPT's driver for image folders does not set it.
  observation.hasImageRight = observation.hasImageRight || !observation.imageRight.isEmpty();
}

void setCalibration(const RawStereoCamera& camera, bool is_left,
                    mrpt::obs::CObservationImage& observation) {
  observation.cameraParams =
      is_left ? mrptCamera(camera.left, "left") : mrptCamera(camera.right, "right");
  observation.cameraPose =
      toMrpt(is_left ? camera.T_robot_left : Pose(camera.T_robot_left * camera.T_left_right));
}

cv::Mat halfOf(const cv::Mat& image, bool is_right) {
  const int width = image.cols / 2;
  return image.colRange(is_right ? width : 0, is_right ? 2 * width : width).clone();
}

std::shared_ptr<mrpt::obs::CObservation> splitSideBySide(
    const std::shared_ptr<mrpt::obs::CObservation>& observation) {
  const auto both = std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(observation);
  if (both == nullptr) return observation;
  auto pair = mrpt::obs::CObservationStereoImages::Create();
  pair->timestamp = both->timestamp;
  pair->sensorLabel = both->sensorLabel;
  pair->cameraPose = mrpt::poses::CPose3DQuat(both->cameraPose);
  pair->leftCamera = pair->rightCamera = both->cameraParams;
  pair->hasImageRight = true;
  if (both->image.isEmpty()) return pair;
  const cv::Mat& image = both->image.asCvMatRef();
  pair->imageLeft = mrpt::img::CImage(halfOf(image, false), mrpt::img::SHALLOW_COPY);
  pair->imageRight = mrpt::img::CImage(halfOf(image, true), mrpt::img::SHALLOW_COPY);
  return pair;
}

std::shared_ptr<mrpt::obs::CObservation3DRangeScan> depthObservation(const mrpt::img::CImage& image,
                                                                     const cv::Mat& depth,
                                                                     const RawDepthCamera& camera) {
  auto scan = mrpt::obs::CObservation3DRangeScan::Create();
  // MRPT's sensor has x forward, and stands in the depth camera; its cameras have optical axes.
  const Pose T_sensor_color = robotFromOptical() * camera.T_color_depth.inverse();
  scan->sensorPose = toMrpt(Pose(camera.T_robot_color * T_sensor_color.inverse()));
  scan->relativePoseIntensityWRTDepth = toMrpt(T_sensor_color);
  scan->cameraParams = mrptCamera(camera.depth, "depth");
  scan->cameraParamsIntensity = mrptCamera(camera.color, "color");
  scan->hasIntensityImage = true;
  scan->intensityImage = image;
  scan->hasRangeImage = true;
  scan->range_is_depth = camera.ranges_are_depths;
  scan->rangeUnits = static_cast<float>(camera.metres_per_unit);
  scan->maxRange = static_cast<float>(camera.max_range_m);
  scan->rangeImage_setSize(depth.rows, depth.cols);
  for (int row = 0; row < depth.rows; ++row) {
    const auto* ranges = depth.ptr<std::uint16_t>(row);
    std::copy(ranges, ranges + depth.cols, &scan->rangeImage(row, 0));
  }
  return scan;
}

}  // namespace headway::io
