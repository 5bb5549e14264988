// SPDX-License-Identifier: BSD-3-Clause
// The right camera's rotation against its calibration: its estimate by rows of matches and by the
// offset of all disparities, and images rotated back by it.
#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/stereo/rectification.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

constexpr double kWalk_px = 0.03;  ///< in 0.1 s: images of different instants differ in turns
constexpr double kMaxOffset_px = 4.0;

constexpr double kRecordWalk_px = 0.003;  ///< of an OffsetRecord, from one estimate to the next

}  // namespace

void DisparityOffset::update(const std::vector<OffsetEvidence>& static_points, double seconds) {
  if (static_points.empty()) return;
  double information = 0.0;
  double gradient = 0.0;
  for (const OffsetEvidence& point : static_points) {
    const double weight = kIndependentRatio / (1.0 + point.fit);
    information += weight * point.information;
    gradient += weight * point.gradient;
  }
  variance_ += kWalk_px * kWalk_px * (seconds * FrameRate::kAssumed_hz);
  const double posterior = 1.0 / (1.0 / variance_ + information);
  value_ = std::clamp(value_ + posterior * gradient, -kMaxOffset_px, kMaxOffset_px);
  variance_ = posterior;
}

namespace {

Eigen::Vector2d pixelThrough(const Eigen::Matrix3d& rotation, const Eigen::Vector2d& uv,
                             const StereoCamera& camera) {
  const Eigen::Vector3d seen = rotation * ray(uv, camera);
  return {camera.fx * seen.x() / seen.z() + camera.cx, camera.fy * seen.y() / seen.z() + camera.cy};
}

}  // namespace

Eigen::Vector2d turnedPixel(const Eigen::Vector2d& right, const Eigen::Vector3d& angles,
                            const StereoCamera& camera) {
  return pixelThrough(expSo3(angles).transpose(), right, camera);
}

double turnedDisparity(const Eigen::Vector2d& uv, double disparity, const Eigen::Vector3d& from,
                       const Eigen::Vector3d& to, const StereoCamera& camera) {
  const Eigen::Vector2d right(uv.x() - disparity, uv.y());
  return uv.x() - pixelThrough(expSo3(to) * expSo3(from).transpose(), right, camera).x();
}

RightTurn::RightTurn(const Eigen::Vector3d& angles, const StereoCamera& camera) : angles_(angles) {
  if (angles.isZero()) return;
  const Eigen::Matrix3d rotation = expSo3(angles).transpose();
  cv::Mat_<cv::Vec2f> map(camera.height, camera.width);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2f at = pixelThrough(rotation, {u, v}, camera).cast<float>();
      map(v, u) = {at.x(), at.y()};
    }
  }
  cv::convertMaps(map, cv::noArray(), places_, fractions_, CV_16SC2);
}

cv::Mat RightTurn::undone(const cv::Mat& right) const {
  if (places_.empty() || right.empty()) return right;
  cv::Mat exact;
  cv::remap(right, exact, places_, fractions_, cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return exact;
}

namespace {

constexpr std::array<const char*, 3> kAxes = {"pitch", "yaw", "roll"};
constexpr int kYaw = 1;  ///< of the angles

/// The estimate by rows.
struct RowParams {
  std::size_t enough_matches = 200;
  double sigma_px = 0.3;                       ///< of a match
  double independent = 0.25;                   ///< ratio of information: points recur
  double prior_sigma_rad = 0.02;               ///< of each angle, of a camera that was calibrated
  double known_sigma_rad = 0.05 * kDegree;     ///< of angles found by an earlier run
  double walk = square(0.005 * kDegree) / 60;  ///< of each angle, by warmth [rad^2/s]
  double contradicts = 13.82;                  ///< chi-square, 2 degrees of freedom, 99.9 %
  int restart_frames = 3;                      ///< in a row that contradict
  std::array<double, 6> scales = {32, 16, 8, 4, 2, 1};  ///< of the loss, in sigma_px
};

/// Which errors count and are corrected.
struct CorrectionParams {
  double significance = 5.0;     ///< standard deviations
  double visible_rows_px = 0.2;  ///< half the noise of a disparity
  /// Half of what bundle adjustment assumes.
  double visible_offset_px = 0.5 * kRectificationSigma_px;
  double changed_offset_px = 0.15;  ///< smaller changes of a correction are not applied: each
  double changed_rows_px = 0.1;     ///< one converts the map
};

constexpr RowParams kRows;
constexpr CorrectionParams kCorrection;

/// Derivative of a point's row in the right image with respect to pitch, yaw and roll [px/rad].
Eigen::Vector3d rowJacobian(const Eigen::Vector2d& right, const StereoCamera& camera) {
  const double x = (right.x() - camera.cx) / camera.fx;
  const double y = (right.y() - camera.cy) / camera.fy;
  return camera.fy * Eigen::Vector3d(1.0 + y * y, -x * y, -x);
}

/// Mean over the image of the outer product of rowJacobian() [px^2/rad^2].
Eigen::Matrix3d meanSquare(const StereoCamera& camera) {
  constexpr int kSteps = 8;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector2d at(i * (camera.width - 1.0) / kSteps,
                               k * (camera.height - 1.0) / kSteps);
      const Eigen::Vector3d jacobian = rowJacobian(at, camera);
      sum += jacobian * jacobian.transpose();
    }
  }
  return sum / square(kSteps + 1);
}

struct Angles {
  Eigen::Vector3d angles, sigmas;  ///< [rad]
};

/// Pitch and roll by rows, yaw by disparities.
Angles withYaw(const RectificationError& error, const StereoCamera& camera) {
  Angles result{error.angles, error.sigmas};
  result.angles[kYaw] = error.disparities ? yawOfOffset(error.disparities->px, camera) : 0.0;
  result.sigmas[kYaw] = error.disparities ? yawOfOffset(error.disparities->sigma_px, camera) : 0.0;
  return result;
}

/// Whether an offset of the disparities is significant and, less some standard deviations, does
/// visible harm.
bool isVisible(const std::optional<OffsetEstimate>& offset, double margin_sigmas = 0.0) {
  return offset && std::abs(offset->px) >
                       std::max(kCorrection.visible_offset_px + margin_sigmas * offset->sigma_px,
                                kCorrection.significance * offset->sigma_px);
}

Eigen::Matrix3d priorInformation() {
  return Eigen::Matrix3d::Identity() / square(kRows.prior_sigma_rad);
}

}  // namespace

void OffsetRecord::Gaussian::add(const OffsetEstimate& seen, double independent) {
  variance += square(kRecordWalk_px);
  const double gain = variance / (variance + square(seen.sigma_px) / independent);
  px += gain * (seen.px - px);
  variance *= 1.0 - gain;
}

bool OffsetRecord::Gaussian::contradicts(const OffsetEstimate& seen) const {
  return square(seen.px - px) >
         chiSquare99(1) * (square(seen.sigma_px) + variance + square(kOffsetModelSigma_px));
}

void OffsetRecord::add(const OffsetEstimate& seen, double independent) {
  if (!known_.contradicts(seen)) {
    contradictions_ = 0;
    return known_.add(seen, independent);
  }
  if (contradictions_ == 0 || contrary_.contradicts(seen)) {
    contrary_ = Gaussian{};
    contradictions_ = 0;
  }
  contrary_.add(seen, independent);
  if (++contradictions_ < kRows.restart_frames) return;
  known_ = contrary_;
  contradictions_ = 0;
}

OffsetEstimate OffsetRecord::estimate() const {
  return {known_.px, std::hypot(std::sqrt(known_.variance), kOffsetModelSigma_px)};
}

bool OffsetRecord::isCorrected() const {
  const bool is_known = known_.variance < square(kOffsetModelSigma_px);
  const OffsetEstimate now = estimate();
  return !is_known || square(now.px) > 2.0 * square(now.sigma_px);
}

double rowShift(const Eigen::Vector2d& right, const Eigen::Vector3d& angles,
                const StereoCamera& camera) {
  return rowJacobian(right, camera).dot(angles);
}

double rowsRms(const Eigen::Vector3d& angles, const StereoCamera& camera) {
  return std::sqrt(std::max(0.0, angles.dot(meanSquare(camera) * angles)));
}

RectificationEstimator::RectificationEstimator(const StereoCamera& camera,
                                               const Eigen::Vector3d& known)
    : camera_(camera) {
  if (known.isZero()) return;
  estimate_.information.diagonal() << 1.0, 0.0, 1.0;
  estimate_.information /= square(kRows.known_sigma_rad);
  estimate_.gradient = estimate_.information * known;
  estimate_.matches = kRows.enough_matches;
  estimate_.frames = 1;
}

Eigen::Matrix3d RectificationEstimator::Estimate::covariance() const {
  return (information + priorInformation()).inverse();
}

bool RectificationEstimator::Estimate::contradicts(const Estimate& other) const {
  const Eigen::Vector3d between = angles() - other.angles();
  const Eigen::Matrix3d covariances = covariance() + other.covariance();
  const Eigen::Vector2d difference(between.x(), between.z());
  Eigen::Matrix2d expected;
  expected << covariances(0, 0), covariances(0, 2), covariances(2, 0), covariances(2, 2);
  return difference.dot(expected.inverse() * difference) > kRows.contradicts;
}

void RectificationEstimator::Estimate::add(const Estimate& other) {
  information += other.information;
  gradient += other.gradient;
  matches += other.matches;
  frames += other.frames;
}

void RectificationEstimator::Estimate::walk(double seconds) {
  const Eigen::Vector3d mean = angles();
  const Eigen::Matrix3d walked =
      (covariance() + kRows.walk * seconds * Eigen::Matrix3d::Identity()).inverse();
  information = walked - priorInformation();
  gradient = walked * mean;
}

RectificationEstimator::Estimate RectificationEstimator::estimateOf(
    const std::vector<RowMatch>& matches) const {
  std::vector<double> rows;
  for (const RowMatch& match : matches) rows.push_back(match.rows);
  Eigen::Vector3d angles(median(rows) / camera_.fy, 0.0, 0.0);
  Estimate result;
  for (const double scale : kRows.scales) {  // from a loss that is almost quadratic
    result = Estimate{};
    for (const RowMatch& match : matches) {
      const Eigen::Vector3d jacobian = rowJacobian(match.right, camera_);
      const double residual = (match.rows - jacobian.dot(angles)) / (scale * kRows.sigma_px);
      const double weight =
          kRows.independent / square(kRows.sigma_px) / square(1.0 + square(residual) / 4.0);
      result.information += weight * jacobian * jacobian.transpose();
      result.gradient += weight * match.rows * jacobian;
    }
    angles = result.angles();
  }
  result.matches = matches.size();
  result.frames = 1;
  return result;
}

void RectificationEstimator::add(const std::vector<RowMatch>& matches, Time time) {
  if (last_ && estimate_.frames > 0) estimate_.walk(std::max(0.0, time - *last_));
  last_ = last_ ? std::max(*last_, time) : time;
  if (matches.empty()) return;
  const Estimate frame = estimateOf(matches);
  if (estimate_.frames == 0 || !frame.contradicts(estimate_)) {
    estimate_.add(frame);
    contrary_.reset();
  } else if (!contrary_ || frame.contradicts(*contrary_)) {
    contrary_ = frame;
  } else {
    contrary_->add(frame);
    if (contrary_->frames < kRows.restart_frames) return;
    estimate_ = *contrary_;
    has_moved_ = true;
    contrary_.reset();
  }
}

std::optional<RectificationError> RectificationEstimator::error() const {
  if (estimate_.matches < kRows.enough_matches) return std::nullopt;
  const Eigen::Matrix3d covariance = estimate_.covariance();
  RectificationError error;
  error.angles = estimate_.angles();
  error.sigmas = covariance.diagonal().cwiseSqrt();
  error.offset_px = camera_.fy * error.angles.x();
  error.offset_sigma_px = camera_.fy * error.sigmas.x();
  Eigen::Vector3d without_yaw = error.angles;
  without_yaw[kYaw] = 0.0;
  error.rows_rms_px = rowsRms(without_yaw, camera_);
  Eigen::Matrix3d spread = meanSquare(camera_);
  spread.row(kYaw).setZero();
  spread.col(kYaw).setZero();
  error.rows_rms_sigma_px = std::sqrt((spread * covariance).trace());
  return error;
}

Eigen::Vector3d significantAngles(const RectificationError& error, const StereoCamera& camera,
                                  double margin_sigmas) {
  Eigen::Vector3d angles = error.angles;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::abs(error.angles[axis]);
    Eigen::Vector3d at_least = Eigen::Vector3d::Zero();
    at_least[axis] = std::max(0.0, size - margin_sigmas * error.sigmas[axis]);
    const bool is_significant = size > kCorrection.significance * error.sigmas[axis];
    if (axis == kYaw || !is_significant ||
        rowsRms(at_least, camera) < kCorrection.visible_rows_px) {
      angles[axis] = 0.0;
    }
  }
  return angles;
}

double yawOfOffset(double offset_px, const StereoCamera& camera) {
  return offset_px / (camera.fx * (1.0 + square(camera.width / camera.fx) / 12.0));
}

std::optional<std::string> excessiveTurn(const RectificationError& error,
                                         const StereoCamera& camera) {
  const auto [angles, sigmas] = withYaw(error, camera);
  for (int axis = 0; axis < 3; ++axis) {
    const double angle = angles[axis] / kDegree;
    const double sigma = sigmas[axis] / kDegree;
    if (std::abs(angle) - kCorrection.significance * sigma < kMaxTurn_deg) continue;
    return formatted(
        "the right camera is turned by %.2f +- %.2f degrees in %s against its calibration, more "
        "than the %.1f degrees that are corrected; calibrate the cameras",
        angle, sigma, kAxes[static_cast<std::size_t>(axis)], kMaxTurn_deg);
  }
  return std::nullopt;
}

Eigen::Vector3d correctionFor(const RectificationError& error, const Eigen::Vector3d& present,
                              const StereoCamera& camera, double margin_sigmas) {
  if (excessiveTurn(error, camera)) return Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = present;
  Eigen::Vector3d rows(error.angles.x(), 0.0, error.angles.z());
  const bool is_corrected = present.x() != 0.0 || present.z() != 0.0;
  const double least_px = std::max(kCorrection.changed_rows_px, 3.0 * error.rows_rms_sigma_px);
  rows[kYaw] = present[kYaw];
  if ((is_corrected || !significantAngles(error, camera, margin_sigmas).isZero()) &&
      rowsRms(rows - present, camera) > least_px) {
    turn = rows;
  }
  if (!error.disparities) return turn;
  const double present_px = present[kYaw] / yawOfOffset(1.0, camera);
  const auto& [offset_px, sigma_px] = *error.disparities;
  const OffsetEstimate left{offset_px - present_px, sigma_px};
  const bool has_changed = std::abs(left.px) > std::max(kCorrection.changed_offset_px,
                                                        kCorrection.significance * left.sigma_px);
  if (present[kYaw] == 0.0 ? isVisible(left, margin_sigmas) : has_changed) {
    turn[kYaw] = yawOfOffset(offset_px, camera);
  }
  return turn;
}

std::string describe(const RectificationError& error, const StereoCamera& camera,
                     const Eigen::Vector3d& corrected) {
  const Angles all = withYaw(error, camera);
  const Eigen::Vector3d angles = error.angles / kDegree, sigmas = error.sigmas / kDegree;
  const Eigen::Vector3d significant = significantAngles(error, camera);
  std::string axes, disparities;
  if (error.disparities) {
    const double sigma_px = std::hypot(error.disparities->sigma_px, kOffsetByFocalLength_px);
    disparities =
        formatted("; disparities %+.2f +- %.2f px, yaw %.3f +- %.3f deg", error.disparities->px,
                  sigma_px, all.angles[kYaw] / kDegree, yawOfOffset(sigma_px, camera) / kDegree);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_visible = axis == kYaw ? isVisible(error.disparities) : significant[axis] != 0.0;
    const bool is_sure = std::abs(all.angles[axis]) > kCorrection.significance * all.sigmas[axis];
    if (!is_visible && !(is_sure && corrected[axis] != 0.0)) continue;
    axes += (axes.empty() ? "" : ", ") + std::string(kAxes[static_cast<std::size_t>(axis)]);
  }
  const char* correction = !corrected.isZero() ? ", corrected"
                           : axes.empty()      ? ""
                                               : ", not corrected";
  const std::string text = formatted(
      "rectification off by %.2f +- %.2f px%s (vertical offset %+.2f +- %.2f px; pitch %.3f +- "
      "%.3f, roll %.3f +- %.3f deg%s): ",
      error.rows_rms_px, error.rows_rms_sigma_px, correction, error.offset_px,
      error.offset_sigma_px, angles.x(), sigmas.x(), angles.z(), sigmas.z(), disparities.c_str());
  if (axes.empty()) return text + "not significant";
  RectificationError left = error;  // by the correction: what is undone needs no calibration
  left.angles -= corrected;
  if (left.disparities) left.disparities->px -= corrected[kYaw] / yawOfOffset(1.0, camera);
  const bool matters = !significantAngles(left, camera).isZero() || isVisible(left.disparities);
  return text + axes + " of the right camera" + (matters ? "; calibrate the cameras" : "");
}

}  // namespace headway::stereo
