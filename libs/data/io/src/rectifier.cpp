// SPDX-License-Identifier: BSD-3-Clause
#include "rectifier.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::io {
namespace {

// Tolerance for poses rounded in text files: 1e-5 rad displaces a pixel by 0.01 px at f = 1000 px.
constexpr double kParallelTolerance = 1e-5;
constexpr double kMinBaseline = 1e-4;  // [m]
constexpr int kPointsPerEdge = 5;

bool isRational(const RawCamera& camera) {
  return std::any_of(camera.rational.begin(), camera.rational.end(),
                     [](double k) { return k != 0.0; });
}

/// A fisheye is none of a pinhole even if all its coefficients are zero.
bool hasDistortion(const RawCamera& camera) {
  return camera.is_fisheye || isRational(camera) ||
         std::any_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return k != 0.0; });
}

bool sameIntrinsics(const RawCamera& a, const RawCamera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy &&
         a.cx == b.cx && a.cy == b.cy;
}

cv::Matx33d cameraMatrix(const RawCamera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

/// In OpenCV's order: 4 coefficients of a fisheye, 5, or 8 of a rational lens.
cv::Mat distortionOf(const RawCamera& camera) {
  std::vector<double> values(camera.distortion.begin(), camera.distortion.end());
  if (camera.is_fisheye) {
    values.resize(4);
  } else if (isRational(camera)) {
    values.insert(values.end(), camera.rational.begin(), camera.rational.end());
  }
  return cv::Mat(values, true);
}

/// Rotations and projections of a rectified pair, as cv::stereoRectify() returns them.
struct Rectification {
  std::array<cv::Mat, 2> R, P;
};

/// Of lenses that OpenCV's model of a pinhole describes.
Rectification pinholeRectification(const RawStereoCamera& raw, const cv::Mat& turn,
                                   const cv::Mat& shift) {
  const cv::Size size(raw.left.width, raw.left.height);
  Rectification result;
  cv::Mat Q;
  cv::stereoRectify(cameraMatrix(raw.left), distortionOf(raw.left), cameraMatrix(raw.right),
                    distortionOf(raw.right), size, turn, shift, result.R[0], result.R[1],
                    result.P[0], result.P[1], Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
  return result;
}

/// Of pairs with a fisheye: the rotations depend on the poses alone. The focal length is that of
/// the lenses, the principal point the centre of the image: the middle of the image keeps its
/// resolution, and what a pinhole of this size cannot see is cut off.
Rectification fisheyeRectification(const RawStereoCamera& raw, const cv::Mat& turn,
                                   const cv::Mat& shift) {
  const cv::Size size(raw.left.width, raw.left.height);
  const double focal = 0.25 * (raw.left.fx + raw.left.fy + raw.right.fx + raw.right.fy);
  const cv::Matx33d K(focal, 0, 0.5 * (size.width - 1), 0, focal, 0.5 * (size.height - 1), 0, 0, 1);
  const cv::Mat none = cv::Mat::zeros(1, 5, CV_64F);
  Rectification result;
  cv::Mat Q;
  cv::stereoRectify(K, none, K, none, size, turn, shift, result.R[0], result.R[1], result.P[0],
                    result.P[1], Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
  const cv::Matx34d P(focal, 0, K(0, 2), 0, 0, focal, K(1, 2), 0, 0, 0, 1, 0);
  result.P = {cv::Mat(P), cv::Mat(P)};
  return result;
}

void initMaps(const RawCamera& lens, const cv::Mat& R, const cv::Mat& P, const cv::Size& size,
              std::array<cv::Mat, 2>& maps) {
  if (lens.is_fisheye) {
    cv::fisheye::initUndistortRectifyMap(cameraMatrix(lens), distortionOf(lens), R, P, size,
                                         CV_16SC2, maps[0], maps[1]);
  } else {
    cv::initUndistortRectifyMap(cameraMatrix(lens), distortionOf(lens), R, P, size, CV_16SC2,
                                maps[0], maps[1]);
  }
}

/// Removes the distortion from pixels; those that no pinhole sees are far outside.
std::vector<cv::Point2d> undistorted(const std::vector<cv::Point2d>& pixels, const RawCamera& lens,
                                     const cv::Mat& R, const cv::Matx33d& P) {
  std::vector<cv::Point2d> result;
  if (lens.is_fisheye) {
    cv::fisheye::undistortPoints(pixels, result, cameraMatrix(lens), distortionOf(lens), R, P);
  } else {
    cv::undistortPoints(pixels, result, cameraMatrix(lens), distortionOf(lens), R, P);
  }
  return result;
}

[[noreturn]] void refuse(const std::string& reason) {
  throw InputError("stereo calibration: " + reason);
}

void validateLens(const RawCamera& camera, const std::string& side) {
  const auto require = [&side](bool is_valid, const std::string& what, double value) {
    if (!is_valid) refuse(side + " " + what + " is " + std::to_string(value));
  };
  require(camera.width > 0, "image width", camera.width);
  require(camera.height > 0, "image height", camera.height);
  require(std::isfinite(camera.fx) && camera.fx > 0.0, "focal length fx", camera.fx);
  require(std::isfinite(camera.fy) && camera.fy > 0.0, "focal length fy", camera.fy);
  require(std::isfinite(camera.cx), "principal point cx", camera.cx);
  require(std::isfinite(camera.cy), "principal point cy", camera.cy);
  for (const double k : camera.distortion) {
    require(std::isfinite(k), "distortion coefficient", k);
  }
  for (const double k : camera.rational) require(std::isfinite(k), "distortion coefficient", k);
}

}  // namespace

std::vector<cv::Point2d> raysOf(const std::vector<cv::Point2d>& pixels, const RawCamera& lens) {
  return undistorted(pixels, lens, cv::Mat::eye(3, 3, CV_64F), cv::Matx33d::eye());
}

bool isRectified(const RawStereoCamera& camera) {
  const Eigen::Vector3d t = camera.T_left_right.translation();
  const double off_axis = std::max(std::abs(t.y()), std::abs(t.z()));
  return !hasDistortion(camera.left) && !hasDistortion(camera.right) &&
         sameIntrinsics(camera.left, camera.right) &&
         camera.T_left_right.linear().isIdentity(kParallelTolerance) &&
         off_axis <= kParallelTolerance * t.norm();
}

void validate(const RawStereoCamera& camera) {
  validateLens(camera.left, "left");
  validateLens(camera.right, "right");
  if (camera.left.width != camera.right.width || camera.left.height != camera.right.height) {
    refuse("left and right images differ in size");
  }
  if (!camera.T_left_right.matrix().allFinite() || !camera.T_robot_left.matrix().allFinite()) {
    refuse("a camera's pose is not finite");
  }
  const Eigen::Vector3d t = camera.T_left_right.translation();
  const std::string baseline = "the right camera is at x = " + std::to_string(t.x()) +
                               " m, y = " + std::to_string(t.y()) +
                               " m, z = " + std::to_string(t.z()) + " m in the left camera: ";
  if (t.norm() < kMinBaseline) refuse(baseline + "the baseline is zero");
  if (std::abs(t.x()) < std::max(std::abs(t.y()), std::abs(t.z()))) {
    refuse(baseline + "the cameras are not displaced horizontally");
  }
  if (t.x() < 0.0) refuse(baseline + "the baseline is negative, left and right are swapped");
}

Rectifier::Rectifier(const RawStereoCamera& raw) : raw_left_(raw.left) {
  io::validate(raw);
  camera_.width = raw.left.width;
  camera_.height = raw.left.height;
  if (isRectified(raw)) {
    camera_.fx = raw.left.fx;
    camera_.fy = raw.left.fy;
    camera_.cx = raw.left.cx;
    camera_.cy = raw.left.cy;
    camera_.baseline_m = raw.T_left_right.translation().x();
    camera_.T_robot_cam = raw.T_robot_left;
    headway::validate(camera_);
    return;
  }
  const Pose T_right_left = raw.T_left_right.inverse();
  cv::Mat turn, shift;
  cv::eigen2cv(Eigen::Matrix3d(T_right_left.linear()), turn);
  cv::eigen2cv(Eigen::Vector3d(T_right_left.translation()), shift);
  const std::array<RawCamera, 2> lenses = {raw.left, raw.right};
  const cv::Size size(camera_.width, camera_.height);
  const auto [R, P] = raw.left.is_fisheye || raw.right.is_fisheye
                          ? fisheyeRectification(raw, turn, shift)
                          : pinholeRectification(raw, turn, shift);
  for (const Side side : {kLeft, kRight}) {
    initMaps(lenses[side], R[side], P[side], size, maps_[side]);
  }
  camera_.fx = P[kLeft].at<double>(0, 0);
  camera_.fy = P[kLeft].at<double>(1, 1);
  camera_.cx = P[kLeft].at<double>(0, 2);
  camera_.cy = P[kLeft].at<double>(1, 2);
  camera_.baseline_m = raw.T_left_right.translation().norm();
  cv::cv2eigen(R[kLeft], R_rectified_raw_);
  camera_.T_robot_cam = raw.T_robot_left;
  camera_.T_robot_cam.linear() = raw.T_robot_left.linear() * R_rectified_raw_.transpose();
  headway::validate(camera_);
}

cv::Mat Rectifier::rectify(Side side, const cv::Mat& image) const {
  if (passesThrough()) return image;
  cv::Mat result;
  cv::remap(image, result, maps_[side][0], maps_[side][1], cv::INTER_LINEAR);
  return result;
}

Box2d Rectifier::rectify(const Box2d& box) const {
  const bool is_finite = std::isfinite(box.left) && std::isfinite(box.top) &&
                         std::isfinite(box.right) && std::isfinite(box.bottom);
  if (passesThrough() || !is_finite) return box;
  std::vector<cv::Point2d> edge;
  for (int i = 0; i < kPointsPerEdge; ++i) {
    const double ratio = static_cast<double>(i) / (kPointsPerEdge - 1);
    const double u = box.left + ratio * box.width();
    const double v = box.top + ratio * box.height();
    edge.insert(edge.end(), {{u, box.top}, {u, box.bottom}, {box.left, v}, {box.right, v}});
  }
  cv::Mat R;
  cv::eigen2cv(R_rectified_raw_, R);
  const cv::Matx33d P(camera_.fx, 0, camera_.cx, 0, camera_.fy, camera_.cy, 0, 0, 1);
  const std::vector<cv::Point2d> turned = undistorted(edge, raw_left_, R, P);
  Box2d result{turned[0].x, turned[0].y, turned[0].x, turned[0].y};
  for (const auto& point : turned) {
    result.left = std::min(result.left, point.x);
    result.top = std::min(result.top, point.y);
    result.right = std::max(result.right, point.x);
    result.bottom = std::max(result.bottom, point.y);
  }
  return result;
}

}  // namespace headway::io
