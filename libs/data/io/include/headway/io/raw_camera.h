// SPDX-License-Identifier: BSD-3-Clause
// Cameras as recorded: lenses and rigs, ROS' and MRPT's descriptions of them, and what is
// impossible.
#pragma once

#include <headway/core/stereo_camera.h>

#include <array>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mrpt::img {
class CImage;
class TCamera;
}  // namespace mrpt::img
namespace mrpt::obs {
class CObservation;
class CObservation3DRangeScan;
class CObservationImage;
class CObservationStereoImages;
}  // namespace mrpt::obs

namespace headway::io {

// What no robot's camera has.
inline constexpr double kMaxBaseline_m = 5.0;
inline constexpr double kMinFocalRatio = 0.1, kMaxFocalRatio = 30.0;  ///< to the side of the image
inline constexpr double kMaxSensorOffset_m = 1e3;                     ///< of a sensor on its robot

/// Lens of a recorded image: intrinsics and OpenCV's distortion, zeros if rectified.
struct RawCamera {
  int width = 0;                                  ///< [px]
  int height = 0;                                 ///< [px]
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< [px]
  std::array<double, 5> distortion{};             ///< k1 k2 p1 p2 k3; of a fisheye k1 k2 k3 k4
  std::array<double, 3> rational{};               ///< k4 k5 k6; not of a fisheye
  bool is_fisheye = false;                        ///< Kannala-Brandt, OpenCV's fisheye
};

/// Stereo camera as recorded, not necessarily rectified.
struct RawStereoCamera {
  RawCamera left;
  RawCamera right;
  Pose T_robot_left = robotFromOptical();  ///< left optical frame on the robot
  Pose T_left_right = Pose::Identity();    ///< right optical frame in the left one
};

/// Depth camera as recorded: an intensity and a depth image, each with its own lens.
struct RawDepthCamera {
  RawCamera color;                          ///< lens of the intensity image
  RawCamera depth;                          ///< lens of the depth image
  Pose T_robot_color = robotFromOptical();  ///< optical frame of the intensity image on the robot
  Pose T_color_depth = Pose::Identity();    ///< optical frame of the depth image in that one
  double metres_per_unit = 0.001;           ///< of the depth image
  double max_range_m = 65.535;              ///< that the camera measures
  bool ranges_are_depths = true;            ///< along the optical axis; false: along the ray
};

/// A rectified camera in recorded form.
[[nodiscard]] RawStereoCamera rawFrom(const StereoCamera& camera);

/// Calibration of one camera as ROS describes it (sensor_msgs/CameraInfo, camera_info files).
struct CameraInfo {
  int width = 0;                 ///< [px]
  int height = 0;                ///< [px]
  std::string distortion_model;  ///< plumb_bob, rational_polynomial, equidistant, or empty
  std::vector<double> D;
  std::array<double, 9> K{};   ///< of the raw image, row-major
  std::array<double, 9> R{};   ///< rotation from the raw to the rectified camera; zeros: none
  std::array<double, 12> P{};  ///< of the rectified image
};

/// Images that a calibration is to describe.
enum class ImageKind { kRaw, kRectified };

/// The lens of raw images (K and D) or of rectified ones (P).
///
/// @throws InputError if the distortion model is not known, or D has too many coefficients for it
[[nodiscard]] RawCamera lensFrom(const CameraInfo& info, ImageKind kind);

/// The right camera in the left one, from R and P; nullopt if P states no baseline.
///
/// @throws InputError if R is not a rotation
[[nodiscard]] std::optional<Pose> rightInLeft(const CameraInfo& left, const CameraInfo& right,
                                              ImageKind kind);

/// What is impossible about a lens, with a hint; empty if nothing is.
[[nodiscard]] std::string lensFault(const RawCamera& lens);

/// What is impossible about the distance of two cameras [m], with a hint; empty if nothing is.
[[nodiscard]] std::string baselineFault(double baseline_m);

/// Baseline of the stereo camera whose disparities have the noise of a depth camera [m].
///
/// Errors of structured light and of stereo cameras grow with the square of the depth, which is a
/// constant error of a disparity: sigma_z = k z^2 = z^2 s / (f b). With k = 0.0025 / m, measured
/// for such cameras, and s = 0.4 px, what headway assumes of disparities, all thresholds hold that
/// were made for stereo cameras.
///
/// @param focal_px  of the images that disparities belong to
/// @see  Khoshelham & Elberink 2012, "Accuracy and resolution of Kinect depth data" (k = 0.0014);
///       Ahn et al. 2019, "Analysis and noise modeling of the Intel RealSense D435" (k = 0.002)
[[nodiscard]] double equivalentBaseline(double focal_px);

/// The lens as MRPT stores it, and back. A lens without distortion has the model `none`.
[[nodiscard]] RawCamera rawCamera(const mrpt::img::TCamera& camera);
[[nodiscard]] mrpt::img::TCamera mrptCamera(const RawCamera& camera, const std::string& name);

/// Replaces calibration and poses of a stereo observation, and marks a right image as present.
void setCalibration(const RawStereoCamera& camera,
                    mrpt::obs::CObservationStereoImages& observation);

/// Replaces calibration and pose of one image of a pair.
void setCalibration(const RawStereoCamera& camera, bool is_left,
                    mrpt::obs::CObservationImage& observation);

/// The left or right half of an image that contains those of both cameras, side by side.
[[nodiscard]] cv::Mat halfOf(const cv::Mat& image, bool is_right);

/// An image that contains those of both cameras as a pair of the same time, label, pose and lens;
/// others unchanged. An empty image gives an empty pair.
[[nodiscard]] std::shared_ptr<mrpt::obs::CObservation> splitSideBySide(
    const std::shared_ptr<mrpt::obs::CObservation>& observation);

/// A frame of a depth camera, without time and label.
///
/// @param depth  16-bit, 0 where nothing was measured
[[nodiscard]] std::shared_ptr<mrpt::obs::CObservation3DRangeScan> depthObservation(
    const mrpt::img::CImage& image, const cv::Mat& depth, const RawDepthCamera& camera);

}  // namespace headway::io
