// SPDX-License-Identifier: BSD-3-Clause
// Points of the image followed from frame to frame: which are chosen, where they are found again.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/stereo_frame.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/point_tracking.h>

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera_path.h"
#include "point_motion.h"

namespace headway::detect {

/// Where objects could be, above the ground.
struct InterestZone {
  double range_m = 50.0;      ///< depth [m]
  double max_height_m = 3.5;  ///< above ground [m]
  double people_m = 28.0;     ///< depth to which people are looked for [m]
};

/// The best corners to track, at most one to a square of `spacing_px`, strongest first.
///
/// Corners that may be on a person (below 2 m, within `people_m`) are preferred to others, of which
/// trees have the strongest. Nine tenths lie in the zone; the rest anywhere with a disparity.
/// Squares that hold one of the points `taken` are skipped. Without a ground plane heights are not
/// tested.
///
/// @see  Shi & Tomasi 1994: the smaller eigenvalue, here in an image reduced to a half
[[nodiscard]] std::vector<cv::Point2f> interestPoints(
    const cv::Mat& image, const stereo::DisparityImage& disparity, const StereoCamera& camera,
    const std::optional<stereo::GroundPlane>& ground, const InterestZone& zone,
    const std::vector<cv::Point2f>& taken, int spacing_px, int wanted);

/// Which points are followed.
struct FollowerParams {
  int max_points = 1200;
  int spacing_px = 8;            ///< between points [px]
  double window_s = 0.6;         ///< observations older than this are removed [s]
  double range_m = 50.0;         ///< maximum depth of new points [m]
  double max_height_m = 3.5;     ///< above ground, of points that may belong to objects [m]
  double people_m = 28.0;        ///< depth to which points on people are preferred [m]
  double motion_window_s = 0.6;  ///< observations that motions are fitted to [s]
  double speed_prior = 30.0;     ///< as that of fitMotion() [m/s]
  ObservationNoise noise;
};

/// Follows points of the left image through time and, in each frame, to the right image.
///
/// Points are chosen where objects could be: above the ground, not too high, and within
/// range, one to a cell of a grid; a tenth of them anywhere, to observe the camera's motion. They
/// are searched where a static point would be, then at their previous position, as objects that
/// move along with the camera are. A point ends if it is not found, does not return when tracked
/// back, or if its left and right image disagree.
///
/// @see  Lucas & Kanade 1981, Bouguet 2001 (pyramids), Shi & Tomasi 1994 (choice)
class PointFollower {
 public:
  PointFollower(const StereoCamera& camera, const FollowerParams& params)
      : camera_(camera), params_(params), turn_change_(camera) {}

  /// Finds the points of the frame before in this one; `path` has been advanced to it.
  void follow(const stereo::FrameContext& context, const stereo::DisparityImage& disparity,
              const CameraPath& path);

  /// Fits the motion of each point to its observations within the window.
  void fitMotions(const CameraPath& path);

  /// Adds new points up to the maximum.
  void replenish(const StereoFrame& frame, const stereo::DisparityImage& disparity,
                 const std::optional<stereo::GroundPlane>& ground, int frame_number);

  [[nodiscard]] std::vector<PointTrack>& points() { return points_; }
  [[nodiscard]] const std::vector<PointTrack>& points() const { return points_; }
  void clear();

 private:
  /// To disparities as they are measured in the newest frame.
  void convert(const CameraPath& path);
  [[nodiscard]] Eigen::Vector3d expectedAt(const PointTrack& point, const CameraPath& path) const;
  void keepFound(const std::vector<stereo::TrackedPosition>& positions,
                 const std::vector<std::optional<double>>& disparities, const CameraPath& path);
  /// None beside something nearer.
  ///
  /// @param predicted  disparities, used where there is no dense one
  [[nodiscard]] std::vector<std::optional<double>> disparitiesOf(
      const std::vector<stereo::TrackedPosition>& positions, const std::vector<double>& predicted,
      const stereo::DisparityImage& disparity) const;
  /// Of a stereo pair.
  [[nodiscard]] std::vector<std::optional<double>> matched(
      const std::vector<stereo::TrackedPosition>& positions, const std::vector<double>& predicted,
      const stereo::DisparityImage& disparity) const;
  /// Of a depth camera.
  [[nodiscard]] std::vector<std::optional<double>> givenDisparities(
      const std::vector<stereo::TrackedPosition>& positions) const;

  StereoCamera camera_;
  FollowerParams params_;
  TurnChange turn_change_;
  std::vector<PointTrack> points_;
  stereo::ImagePyramid left_before_;
  stereo::ImagePyramid left_;
  stereo::SecondView right_;
  std::int64_t next_id_ = 0;
  double offset_ = 0.0;  ///< of the disparities measured in the newest frame [px]
};

/// Ratio of the errors of image observations to those assumed, which depends on the images.
///
/// The median fit of static points, smoothed over the frames. Not objects::NoiseScale, which scales
/// the covariances of detections by a tracker's innovations.
class NoiseScale {
 public:
  /// @param seconds  since the frame before
  void update(const std::vector<PointTrack>& points, double seconds);
  /// True errors over those assumed [-].
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_ = 1.0;
};

}  // namespace headway::detect
