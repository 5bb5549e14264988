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

bool hasDistortion(const RawCamera& camera) {
  return std::any_of(camera.distortion.begin(), camera.distortion.end(),
                     [](double k) { return k != 0.0; });
}

bool sameIntrinsics(const RawCamera& a, const RawCamera& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy &&
         a.cx == b.cx && a.cy == b.cy;
}

cv::Matx33d cameraMatrix(const RawCamera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

cv::Mat distortionOf(const RawCamera& camera) {
  return cv::Mat(std::vector<double>(camera.distortion.begin(), camera.distortion.end()), true);
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
}

}  // namespace

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
  std::array<cv::Mat, 2> R, P;
  cv::Mat Q;
  cv::stereoRectify(cameraMatrix(raw.left), distortionOf(raw.left), cameraMatrix(raw.right),
                    distortionOf(raw.right), size, turn, shift, R[kLeft], R[kRight], P[kLeft],
                    P[kRight], Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
  for (const Side side : {kLeft, kRight}) {
    cv::initUndistortRectifyMap(cameraMatrix(lenses[side]), distortionOf(lenses[side]), R[side],
                                P[side], size, CV_16SC2, maps_[side][0], maps_[side][1]);
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
  std::vector<cv::Point2d> turned;
  cv::undistortPoints(edge, turned, cameraMatrix(raw_left_), distortionOf(raw_left_), R, P);
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
