// SPDX-License-Identifier: BSD-3-Clause
// The right camera's rotation against its calibration: its estimate by rows of matches and by the
// offset of all disparities, and images rotated back by it.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::stereo {

/// A calibration rectifies a pair to about so much in its disparities: the standard deviation of
/// their offset before anything is measured [px].
inline constexpr double kRectificationSigma_px = 0.5;
/// What focal lengths look like that are off by 0.3 %, as those of calibrations are: part of what
/// is said of an offset, not of its correction, which serves as well against it [px].
inline constexpr double kOffsetByFocalLength_px = 0.07;

/// Ratio of the information of a frame's points that counts: they share the errors of its images.
inline constexpr double kIndependentRatio = 0.05;

/// What the observations of one static point from known camera poses tell about the disparities'
/// offset, with the point's position marginalised out.
struct OffsetEvidence {
  double information = 0.0;  ///< inverse variance [1/px^2]
  double gradient = 0.0;     ///< information times the offset [1/px]
  double fit = 1.0;          ///< squared error per degree of freedom, in sigmas squared
};

/// The offset of the disparities, measured less true, as many observations together tell it.
struct OffsetEstimate {
  double px = 0.0;
  double sigma_px = 0.0;  ///< of independent observations; always positive
};

/// Error that flexing and wrong matches leave in an offset of the disparities, however much is
/// seen: standard deviation [px].
inline constexpr double kOffsetModelSigma_px = 0.03;

/// The offset of the disparities by all that a run has seen, and whether it is to be corrected.
///
/// Correcting an offset that is known to sigma leaves an error of sigma^2 in the mean, leaving it
/// alone one of offset^2 - sigma^2: it is corrected where that is more. Before it is known, it is
/// corrected as it is seen.
class OffsetRecord {
 public:
  /// Adds an estimate; three in a row that contradict the record and agree with each other start
  /// it anew, as after a knock at the camera.
  ///
  /// @param independent  ratio of the estimate's information that the record does not have yet
  void add(const OffsetEstimate& seen, double independent);

  /// With kOffsetModelSigma_px in its standard deviation.
  [[nodiscard]] OffsetEstimate estimate() const;
  [[nodiscard]] bool isCorrected() const;

 private:
  struct Gaussian {
    double px = 0.0;
    double variance = kRectificationSigma_px * kRectificationSigma_px;  ///< [px^2]

    void add(const OffsetEstimate& seen, double independent);
    /// Whether an estimate differs by more than both errors explain.
    [[nodiscard]] bool contradicts(const OffsetEstimate& seen) const;
  };
  Gaussian known_;
  Gaussian contrary_;  ///< by the latest estimates, which contradict what is known
  int contradictions_ = 0;
};

/// Estimates the offset of the disparities, measured less true, where camera poses are known.
///
/// Rectification that is off by a small angle, or images that were not taken at the same instant
/// in a turn, shift all disparities alike: near and far points then contradict each other on the
/// camera's speed. Estimated as a slow random walk. SLAM estimates poses and offset together, in
/// its bundle adjustment; this is for recordings that contain poses.
class DisparityOffset {
 public:
  /// @param static_points  of one frame; empty: no change
  /// @param seconds        since the frame before
  void update(const std::vector<OffsetEvidence>& static_points,
              double seconds = 1.0 / FrameRate::kAssumed_hz);

  [[nodiscard]] double value() const { return value_; }  ///< measured less true disparity [px]
  [[nodiscard]] OffsetEstimate estimate() const { return {value_, std::sqrt(variance_)}; }

  /// Disparities are less by so much from now on, as their cause is corrected [px].
  void subtract(double offset_px) { value_ -= offset_px; }

 private:
  double value_ = 0.0;
  double variance_ = kRectificationSigma_px * kRectificationSigma_px;  ///< [px^2]
};

/// Where a turned right camera sees the points that an exactly mounted one sees.
///
/// A rotation about the projection centre moves pixels independently of depth (Hartley & Zisserman
/// 2004, Sec. 8.4.2), so images of a turned camera can be turned back without knowing the scene.
///
/// @param right   pixel of the exact right camera [px]
/// @param angles  rotation vector from the exact to the turned camera: pitch, yaw, roll along x, y,
///                z of the right camera [rad]
/// @return        pixel of the turned camera [px]
[[nodiscard]] Eigen::Vector2d turnedPixel(const Eigen::Vector2d& right,
                                          const Eigen::Vector3d& angles,
                                          const StereoCamera& camera);

/// The disparity by another estimate of the right camera's turn.
///
/// @param uv         left pixel [px]
/// @param disparity  measured in right images that were turned back by `from` [px]
/// @param from, to   as the angles of turnedPixel() [rad]
/// @return           the disparity in images turned back by `to` [px]
[[nodiscard]] double turnedDisparity(const Eigen::Vector2d& uv, double disparity,
                                     const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     const StereoCamera& camera);

/// Turns the images of a turned right camera back to those of an exactly mounted one.
class RightTurn {
 public:
  /// No turn: images stay as they are.
  RightTurn() = default;
  /// @param angles  as those of turnedPixel(); zero: images stay as they are [rad]
  RightTurn(const Eigen::Vector3d& angles, const StereoCamera& camera);

  [[nodiscard]] const Eigen::Vector3d& angles() const { return angles_; }

  /// Bicubic, because a linear interpolation blurs the right image alone. Pixels that the camera
  /// does not see repeat those of the border.
  ///
  /// @param right  8-bit grey, of the camera's size
  [[nodiscard]] cv::Mat undone(const cv::Mat& right) const;

 private:
  Eigen::Vector3d angles_ = Eigen::Vector3d::Zero();
  cv::Mat places_, fractions_;  ///< of each pixel in the turned image; empty: no turn
};

/// A point matched between left and right image without the condition that rows are equal.
struct RowMatch {
  Eigen::Vector2d right = Eigen::Vector2d::Zero();  ///< in the right image [px]
  double rows = 0.0;  ///< row in the right image minus row in the left one [px]
};

/// Rotation of the right camera against its calibration, by the rows of matched points.
struct RectificationError {
  /// Pitch, yaw and roll: rotation vector along the right camera's x, y and z axis [rad].
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  Eigen::Vector3d sigmas = Eigen::Vector3d::Zero();  ///< [rad]
  double offset_px = 0.0;  ///< of the rows at the principal point, right minus left
  double offset_sigma_px = 0.0;
  double rows_rms_px = 0.0;  ///< of the row differences that pitch and roll cause, over the image
  double rows_rms_sigma_px = 0.0;
  /// Of the disparities, by yaw, as the camera's motion shows it; nullopt: unknown.
  std::optional<OffsetEstimate> disparities;
};

/// The yaw of the right camera that shifts disparities by so much in the mean over the image [rad].
///
/// A yaw shifts the disparity at x in the normalised image by f * yaw * (1 + x^2).
[[nodiscard]] double yawOfOffset(double offset_px, const StereoCamera& camera);

/// Row in the right image less that of an exactly mounted camera, by its rotation [px].
[[nodiscard]] double rowShift(const Eigen::Vector2d& right, const Eigen::Vector3d& angles,
                              const StereoCamera& camera);

/// RMS over the image of the row differences that these angles cause [px].
[[nodiscard]] double rowsRms(const Eigen::Vector3d& angles, const StereoCamera& camera);

/// Estimates the rotation of the right camera from the rows of stereo matches over many frames.
///
/// For a point at (x, y) in the right camera's normalised image, a small rotation (pitch, yaw,
/// roll) shifts the row by f * (pitch * (1 + y^2) - yaw * x * y - roll * x). A translation along
/// the rows is not told apart from pitch, which is exact for distant points. Rows tell yaw only by
/// a second-order term that residual lens distortion has as well (0.4 degrees in KITTI's rectified
/// images): it is estimated for the sake of the others and never significant.
///
/// A Kalman filter whose angles walk by 0.005 degrees per root minute, as a mounting that warms up
/// does. Frames that contradict it are left out; three in a row that agree with each other start it
/// anew, as after a knock at the camera.
///
/// @see  Hartley & Zisserman 2004, Sec. 9.3; Dang, Hoffmann & Stiller 2009, "Continuous stereo
///       self-calibration by camera parameter tracking"
class RectificationEstimator {
 public:
  /// @param known  pitch, yaw and roll as an earlier run found them; zero: nothing is known [rad]
  explicit RectificationEstimator(const StereoCamera& camera,
                                  const Eigen::Vector3d& known = Eigen::Vector3d::Zero());

  /// Adds the matches of one frame; robust against wrong ones.
  ///
  /// @param time  of the frame; earlier ones than the last count as the last [s]
  void add(const std::vector<RowMatch>& matches, Time time);

  /// Whether it was started anew: the camera has moved on the rig.
  [[nodiscard]] bool hasMoved() const { return has_moved_; }

  /// The estimate so far; nullopt with too few matches.
  [[nodiscard]] std::optional<RectificationError> error() const;

 private:
  /// Gaussian of pitch, yaw and roll, in information form and without the prior.
  struct Estimate {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< [1/rad^2]
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();     ///< information times angles
    std::size_t matches = 0;
    int frames = 0;

    [[nodiscard]] Eigen::Matrix3d covariance() const;  ///< with the prior [rad^2]
    [[nodiscard]] Eigen::Vector3d angles() const { return covariance() * gradient; }
    /// Whether pitch and roll differ more than both covariances explain.
    [[nodiscard]] bool contradicts(const Estimate& other) const;
    void add(const Estimate& other);
    void walk(double seconds);
  };
  [[nodiscard]] Estimate estimateOf(const std::vector<RowMatch>& matches) const;

  StereoCamera camera_;
  Estimate estimate_;
  std::optional<Estimate> contrary_;  ///< by the latest frames, which contradict `estimate_`
  std::optional<Time> last_;
  bool has_moved_ = false;
};

/// The angles of pitch and roll that are significant and, less some standard deviations, shift rows
/// by a visible amount; 0 the others [rad].
[[nodiscard]] Eigen::Vector3d significantAngles(const RectificationError& error,
                                                const StereoCamera& camera,
                                                double margin_sigmas = 0.0);

constexpr double kMaxTurn_deg = 0.6;  ///< that is corrected: more is a wrong calibration [deg]

/// The first axis by which the camera is turned, surely, by more than kMaxTurn_deg: "pitch", "yaw"
/// or "roll" with the angle, its uncertainty and what to do; nullopt: none.
[[nodiscard]] std::optional<std::string> excessiveTurn(const RectificationError& error,
                                                       const StereoCamera& camera);

/// The turn to be undone: pitch and roll once one of them is significant, and yaw likewise; the
/// present turn as long as the estimate does not differ visibly from it; zero where it is
/// excessive.
///
/// @param margin_sigmas  standard deviations by which an error must exceed what is visible before
///                       it is undone
[[nodiscard]] Eigen::Vector3d correctionFor(const RectificationError& error,
                                            const Eigen::Vector3d& present,
                                            const StereoCamera& camera, double margin_sigmas = 0.0);

/// One line: offset of the rows and angles with their uncertainties, and the axes that are
/// significantly off.
///
/// @param corrected  the turn by which right images are turned back, as of correctionFor() [rad]
[[nodiscard]] std::string describe(const RectificationError& error, const StereoCamera& camera,
                                   const Eigen::Vector3d& corrected = Eigen::Vector3d::Zero());

}  // namespace headway::stereo
