// SPDX-License-Identifier: BSD-3-Clause
// From recorded images to a rectified pair, and from depth images to its disparities.
#include "rectifier.h"

#include <headway/core/error.h>
#include <headway/io/raw_camera.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace headway::io {
namespace {

// Tolerance for poses rounded in text files: 1e-5 rad displaces a pixel by 0.01 px at f = 1000 px.
constexpr double kParallelTolerance = 1e-5;
constexpr double kMinBaseline = 1e-4;  // of a pair [m]
constexpr int kPointsPerEdge = 5;      // of a box, which a lens bends

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
Rectification pinholeRectification(const RawStereoCamera& raw, const cv::Mat& rotation,
                                   const cv::Mat& shift) {
  const cv::Size size(raw.left.width, raw.left.height);
  Rectification result;
  cv::Mat Q;
  cv::stereoRectify(cameraMatrix(raw.left), distortionOf(raw.left), cameraMatrix(raw.right),
                    distortionOf(raw.right), size, rotation, shift, result.R[0], result.R[1],
                    result.P[0], result.P[1], Q, cv::CALIB_ZERO_DISPARITY, 0.0, size);
  return result;
}

/// Of pairs with a fisheye: the rotations depend on the poses alone. The focal length is that of
/// the lenses, the principal point the centre of the image: the middle of the image keeps its
/// resolution, and what a pinhole of this size cannot see is cut off.
Rectification fisheyeRectification(const RawStereoCamera& raw, const cv::Mat& rotation,
                                   const cv::Mat& shift) {
  const cv::Size size(raw.left.width, raw.left.height);
  const double focal = 0.25 * (raw.left.fx + raw.left.fy + raw.right.fx + raw.right.fy);
  const cv::Matx33d K(focal, 0, 0.5 * (size.width - 1), 0, focal, 0.5 * (size.height - 1), 0, 0, 1);
  const cv::Mat none = cv::Mat::zeros(1, 5, CV_64F);
  Rectification result;
  cv::Mat Q;
  cv::stereoRectify(K, none, K, none, size, rotation, shift, result.R[0], result.R[1], result.P[0],
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

constexpr float kNearestM = 0.05F;  // nearer is nothing [m]
// Between depth and intensity camera: beyond it, ground beside an obstacle that the depth camera
// does not measure would appear in the obstacle's place.
constexpr double kMaxOffsetM = 0.15;
constexpr double kMinUnitM = 1e-6, kMaxUnitM = 0.1;
// Between the pixels of one surface:
constexpr float kStep = 3.0F;              // [px]
constexpr float kStepRatio = 0.06F;        // or this ratio of the disparity
constexpr float kMaxTriangleSide = 64.0F;  // of a triangle between neighbouring pixels [px]
constexpr double kMaxParallax_px = 0.05;   // of what is nearest, for cameras in one place
constexpr float kRounding = 1e-3F;         // of a pixel on an edge, relative to a triangle

bool isSameLens(const RawCamera& lens, const StereoCamera& camera) {
  const auto is_set = [](double k) { return k != 0.0; };
  return lens.width == camera.width && lens.height == camera.height && lens.fx == camera.fx &&
         lens.fy == camera.fy && lens.cx == camera.cx && lens.cy == camera.cy && !lens.is_fisheye &&
         std::none_of(lens.distortion.begin(), lens.distortion.end(), is_set) &&
         std::none_of(lens.rational.begin(), lens.rational.end(), is_set);
}

/// A depth pixel in the intensity image.
using Point = cv::Vec3f;  // u, v, disparity [px]; disparity 0: nothing was measured

/// Pixels of an image that may be in a polygon with these corners; empty: first > last.
struct PixelRange {
  int first = 0, last = -1;
};

/// @param size  of the image along this axis
PixelRange pixelsBetween(float least, float most, int size) {
  // Pixels at the edge of a lens may be anywhere.
  if (!(most >= 0.0F) || !(least <= static_cast<float>(size)) || most - least > kMaxTriangleSide) {
    return {};
  }
  const float from = std::max(0.0F, least - kRounding);
  int first = static_cast<int>(from);  // not std::ceil(): most of the time went into it
  if (static_cast<float>(first) < from) ++first;
  return {first, std::min(size - 1, static_cast<int>(most + kRounding))};
}

/// A triangle of depth pixels of one surface: disparities are linear in the image on a plane.
class Triangle {
 public:
  Triangle(const Point& a, const Point& b, const Point& c)
      : a_(a), ab_(b - a), ac_(c - a), area_(ab_[0] * ac_[1] - ac_[0] * ab_[1]) {
    is_surface_ = isSurface(a[2], b[2], c[2]);
  }
  /// Whether three disparities are of one surface.
  [[nodiscard]] static bool isSurface(float a, float b, float c) {
    const auto [least, most] = std::minmax({a, b, c});
    return least > 0.0F && most - least <= std::max(kStep, kStepRatio * most);
  }
  /// Weights of the second and third corner at a pixel; nullopt outside and if seen from behind.
  [[nodiscard]] std::optional<std::array<float, 2>> weightsAt(int u, int v) const {
    if (!(area_ > 0.0F)) return std::nullopt;
    const float du = static_cast<float>(u) - a_[0], dv = static_cast<float>(v) - a_[1];
    const float of_b = du * ac_[1] - ac_[0] * dv, of_c = ab_[0] * dv - du * ab_[1];  // times area_
    const float rounding = kRounding * area_;
    if (of_b < -rounding || of_c < -rounding || of_b + of_c > area_ + rounding) return std::nullopt;
    return std::array<float, 2>{of_b / area_, of_c / area_};
  }
  /// Whether it is of one surface, seen from ahead.
  [[nodiscard]] bool isSeen() const { return is_surface_ && area_ > 0.0F; }
  /// The disparity at a pixel; 0 outside.
  [[nodiscard]] float at(int u, int v) const {
    const float du = static_cast<float>(u) - a_[0], dv = static_cast<float>(v) - a_[1];
    const float of_b = du * ac_[1] - ac_[0] * dv, of_c = ab_[0] * dv - du * ab_[1];  // times area_
    const float rounding = kRounding * area_;
    if (of_b < -rounding || of_c < -rounding || of_b + of_c > area_ + rounding) return 0.0F;
    return a_[2] + (of_b * ab_[2] + of_c * ac_[2]) / area_;
  }

 private:
  Point a_, ab_, ac_;
  float area_ = 0.0F;  ///< twice that of the triangle; negative: seen from behind
  bool is_surface_ = false;
};

/// Fills what four neighbouring depth pixels cover, in two triangles. The nearest surface counts.
void fill(const Point& a, const Point& b, const Point& c, const Point& d, cv::Mat& disparities) {
  if (!(b[2] > 0.0F) || !(c[2] > 0.0F)) return;  // of both triangles
  const auto [left, right] = std::minmax({a[0], b[0], c[0], d[0]});
  const auto [top, bottom] = std::minmax({a[1], b[1], c[1], d[1]});
  const auto columns = pixelsBetween(left, right, disparities.cols);
  const auto rows = pixelsBetween(top, bottom, disparities.rows);
  if (columns.first > columns.last || rows.first > rows.last) return;
  const Triangle upper(a, b, c), lower(b, d, c);
  for (int v = rows.first; v <= rows.last; ++v) {
    auto* row = disparities.ptr<float>(v);
    for (int u = columns.first; u <= columns.last; ++u) {
      float disparity = upper.isSeen() ? upper.at(u, v) : 0.0F;
      if (disparity == 0.0F && lower.isSeen()) disparity = lower.at(u, v);
      row[u] = std::max(row[u], disparity);
    }
  }
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
  cv::Mat rotation, shift;
  cv::eigen2cv(Eigen::Matrix3d(T_right_left.linear()), rotation);
  cv::eigen2cv(Eigen::Vector3d(T_right_left.translation()), shift);
  const std::array<RawCamera, 2> lenses = {raw.left, raw.right};
  const cv::Size size(camera_.width, camera_.height);
  const auto [R, P] = raw.left.is_fisheye || raw.right.is_fisheye
                          ? fisheyeRectification(raw, rotation, shift)
                          : pinholeRectification(raw, rotation, shift);
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
  const std::vector<cv::Point2d> rectified = undistorted(edge, raw_left_, R, P);
  Box2d result{rectified[0].x, rectified[0].y, rectified[0].x, rectified[0].y};
  for (const auto& point : rectified) {
    result.left = std::min(result.left, point.x);
    result.top = std::min(result.top, point.y);
    result.right = std::max(result.right, point.x);
    result.bottom = std::max(result.bottom, point.y);
  }
  return result;
}

void validate(const RawDepthCamera& camera) {
  const auto refuse = [](const std::string& reason) {
    throw InputError("calibration of the depth camera: " + reason);
  };
  if (const auto fault = lensFault(camera.color); !fault.empty()) {
    refuse("the intensity image (cameraParamsIntensity): " + fault);
  }
  if (const auto fault = lensFault(camera.depth); !fault.empty()) {
    refuse("the depth image (cameraParams): " + fault);
  }
  const double offset = camera.T_color_depth.translation().norm();
  if (!camera.T_color_depth.matrix().allFinite() || offset > kMaxOffsetM) {
    refuse("both cameras are " + std::to_string(offset) +
           " m apart (relativePoseIntensityWRTDepth): in metres?");
  }
  if (camera.T_color_depth.linear()(2, 2) < 0.5) {
    refuse(
        "both cameras look in different directions: relativePoseIntensityWRTDepth is that of "
        "optical axes (x right, y down, z forward) in a sensor with x forward");
  }
  if (!(camera.metres_per_unit >= kMinUnitM && camera.metres_per_unit <= kMaxUnitM)) {
    refuse("a unit of the depth image is " + std::to_string(camera.metres_per_unit) +
           " m (rangeUnits); it is 0.001 as a rule");
  }
}

DepthRegistration::DepthRegistration(const RawDepthCamera& recorded, const StereoCamera& target)
    : recorded_(recorded), target_(target) {
  is_registered_ = isSameLens(recorded.depth, target) &&
                   recorded.T_color_depth.matrix().isIdentity(kParallelTolerance);
  std::vector<cv::Point2d> pixels;
  pixels.reserve(static_cast<std::size_t>(size().area()));
  for (int v = 0; v < size().height; ++v) {
    for (int u = 0; u < size().width; ++u) pixels.emplace_back(u, v);
  }
  const auto rays = raysOf(pixels, recorded.depth);
  cv::Mat(rays, true).reshape(2, size().height).convertTo(rays_, CV_32F);
  const double parallax_px =
      target.fx * recorded.T_color_depth.translation().norm() / static_cast<double>(kNearestM);
  if (!is_registered_ && parallax_px < kMaxParallax_px) coverOnce();
}

/// Finds which depth pixels cover which pixel, which does not depend on ranges if there is no
/// parallax.
void DepthRegistration::coverOnce() {
  constexpr double kMostUnits = 60'000.0;  // fewer than a hole has
  const double units =  // any range that is measured
      std::floor(std::min(kMostUnits, farthest() / recorded_.metres_per_unit));
  const cv::Mat points = projected(cv::Mat(size(), CV_16U, cv::Scalar(units)));
  cv::extractChannel(points, unit_disparities_, 2);
  unit_disparities_ *= units;
  for (int place = 0; place + points.cols + 1 < static_cast<int>(points.total()); ++place) {
    if (place % points.cols == points.cols - 1) continue;
    const std::array<int, 4> quad = {place, place + 1, place + points.cols,
                                     place + points.cols + 1};
    const auto* all = points.ptr<Point>();
    const Point &a = all[quad[0]], &b = all[quad[1]], &c = all[quad[2]], &d = all[quad[3]];
    const auto columns = pixelsBetween(std::min({a[0], b[0], c[0], d[0]}),
                                       std::max({a[0], b[0], c[0], d[0]}), target_.width);
    const auto rows = pixelsBetween(std::min({a[1], b[1], c[1], d[1]}),
                                    std::max({a[1], b[1], c[1], d[1]}), target_.height);
    const Triangle upper(a, b, c), lower(b, d, c);
    for (int v = rows.first; v <= rows.last; ++v) {
      for (int u = columns.first; u <= columns.last; ++u) {
        const int pixel = v * target_.width + u;
        if (const auto weights = upper.weightsAt(u, v)) {
          covers_.push_back({pixel, {quad[0], quad[1], quad[2]}, (*weights)[0], (*weights)[1]});
        }
        if (const auto weights = lower.weightsAt(u, v)) {
          covers_.push_back({pixel, {quad[1], quad[3], quad[2]}, (*weights)[0], (*weights)[1]});
        }
      }
    }
  }
}

/// Depth beyond which nothing is measured, in which rounding to units is left room [m].
float DepthRegistration::farthest() const {
  if (!target_.isDepthCamera()) return std::numeric_limits<float>::infinity();
  return static_cast<float>(target_.depth_reach_m + recorded_.metres_per_unit);
}

cv::Mat DepthRegistration::disparitiesByCovers(const cv::Mat& ranges) const {
  cv::Mat measured(size(), CV_32F);
  const auto max_disparity =
      static_cast<float>(target_.fx * target_.baseline_m / static_cast<double>(kNearestM));
  const float min_disparity = static_cast<float>(target_.fx * target_.baseline_m) / farthest();
  for (int v = 0; v < measured.rows; ++v) {
    const auto* range = ranges.ptr<std::uint16_t>(v);
    const auto* unit = unit_disparities_.ptr<float>(v);
    auto* disparity = measured.ptr<float>(v);
    for (int u = 0; u < measured.cols; ++u) {
      const float value = unit[u] / static_cast<float>(std::max<int>(range[u], 1));
      const bool is_hole = range[u] == 0 || range[u] == std::numeric_limits<std::uint16_t>::max();
      const bool is_measured = value < max_disparity && value >= min_disparity;
      disparity[u] = is_hole || !is_measured ? 0.0F : value;
    }
  }
  cv::Mat result(target_.height, target_.width, CV_32F, cv::Scalar(0));
  const auto* from = measured.ptr<float>();
  auto* to = result.ptr<float>();
  for (const Cover& cover : covers_) {
    const float a = from[cover.corners[0]], b = from[cover.corners[1]], c = from[cover.corners[2]];
    if (!Triangle::isSurface(a, b, c)) continue;
    to[cover.pixel] = std::max(to[cover.pixel], a + cover.of_b * (b - a) + cover.of_c * (c - a));
  }
  return result;
}

cv::Mat DepthRegistration::disparities(const cv::Mat& ranges) const {
  if (!covers_.empty()) return disparitiesByCovers(ranges);
  const cv::Mat points = projected(ranges);
  cv::Mat result(target_.height, target_.width, CV_32F, cv::Scalar(0));
  if (is_registered_) {
    cv::extractChannel(points, result, 2);
    return result;
  }
  for (int v = 0; v + 1 < points.rows; ++v) {
    const auto* upper = points.ptr<Point>(v);
    const auto* lower = points.ptr<Point>(v + 1);
    for (int u = 0; u + 1 < points.cols; ++u) {
      fill(upper[u], upper[u + 1], lower[u], lower[u + 1], result);
    }
  }
  return result;
}

/// The depth pixels in the rectified intensity image.
cv::Mat DepthRegistration::projected(const cv::Mat& ranges) const {
  cv::Mat points(ranges.size(), CV_32FC3, cv::Scalar::all(0));
  const Eigen::Matrix3f R = recorded_.T_color_depth.linear().cast<float>();
  const Eigen::Vector3f t = recorded_.T_color_depth.translation().cast<float>();
  const auto unit = static_cast<float>(recorded_.metres_per_unit);
  const auto fx = static_cast<float>(target_.fx), fy = static_cast<float>(target_.fy);
  const auto cx = static_cast<float>(target_.cx), cy = static_cast<float>(target_.cy);
  const auto focal_baseline = static_cast<float>(target_.fx * target_.baseline_m);
  const float reach = farthest();
  for (int v = 0; v < ranges.rows; ++v) {
    const auto* range = ranges.ptr<std::uint16_t>(v);
    const auto* ray = rays_.ptr<cv::Vec2f>(v);
    auto* point = points.ptr<Point>(v);
    for (int u = 0; u < ranges.cols; ++u) {
      if (range[u] == 0 || range[u] == std::numeric_limits<std::uint16_t>::max()) continue;
      const Eigen::Vector3f direction(ray[u][0], ray[u][1], 1.0F);
      float depth = unit * static_cast<float>(range[u]);
      if (!recorded_.ranges_are_depths) depth /= direction.norm();
      const Eigen::Vector3f seen = R * (depth * direction) + t;
      if (!(seen.z() > kNearestM) || seen.z() > reach) continue;
      point[u] = {fx * seen.x() / seen.z() + cx, fy * seen.y() / seen.z() + cy,
                  focal_baseline / seen.z()};
    }
  }
  return points;
}

}  // namespace headway::io
