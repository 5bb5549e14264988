// SPDX-License-Identifier: BSD-3-Clause
// Measuring landmarks: a frame prepared for tracking, and where the map's landmarks are in it.
#pragma once

#include <headway/core/moving_regions.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/point_tracking.h>
#include <headway/stereo/stereo_match.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "keypoints.h"
#include "sparse_map.h"

namespace headway::slam {

/// Where nothing may be measured: the moving regions as a mask, boxes drawn full.
///
/// Unsure regions are excluded only in the mode without a geometric test.
///
/// @return  8-bit, non-zero inside a region; empty where the mode ignores regions or there is none
/// @throws  InputError if the regions' mask is not 8-bit or not of the image's size
[[nodiscard]] cv::Mat excludedMask(const MovingRegions& moving, DynamicRejection mode,
                                   const cv::Size& image_size);

/// Where landmarks must be verified static before they constrain the pose: the unsure regions, in
/// the mode with both tests.
///
/// @return  8-bit, non-zero inside a region; empty where there is none
[[nodiscard]] cv::Mat suspectMask(const MovingRegions& moving, DynamicRejection mode,
                                  const cv::Size& image_size);

/// One frame, prepared for tracking.
struct TrackingFrame {
  std::size_t index = 0;
  Time time = 0.0;  ///< [s]
  stereo::ImagePyramid left;
  stereo::SecondView right;
  cv::Mat excluded;  ///< 8-bit, non-zero where nothing may be measured; may be empty
  cv::Mat suspect;   ///< 8-bit, non-zero where landmarks must be verified first; may be empty
  FeatureGrid grid;  ///< about params.features cells outside of the excluded regions
  /// Away from the ground in view, camera frame; known where the camera is lost and stands on it.
  std::optional<Eigen::Vector3d> up;
};

/// Pyramids of both images, contrast-stretched in poor light, and the masks.
///
/// @throws InputError if an image is not 8-bit grey and of the camera's size, or the regions' mask
///         is not
[[nodiscard]] TrackingFrame makeTrackingFrame(const stereo::FrameContext& context,
                                              const MovingRegions& moving,
                                              const StereoCamera& camera, const SlamParams& params);

/// Whether this pixel is set in a mask; nowhere in an empty one.
[[nodiscard]] bool isExcluded(const cv::Mat& excluded, const Eigen::Vector2d& uv);

/// Where a frame shows a point: (u, v, disparity); nullopt if it is not in the image, or where
/// nothing may be measured.
[[nodiscard]] std::optional<Eigen::Vector3d> visibleAt(const Eigen::Vector3d& point_cam,
                                                       const TrackingFrame& frame,
                                                       const StereoCamera& camera);

/// Follows points into a frame by KLT; nullopt for those that are not found where something may be
/// measured.
///
/// @param from       with gradients
/// @param predicted  positions in the frame, one each
[[nodiscard]] std::vector<stereo::TrackedPosition> followPoints(
    const stereo::ImagePyramid& from, const TrackingFrame& frame,
    const std::vector<Eigen::Vector2d>& points, const std::vector<Eigen::Vector2d>& predicted);

/// The matcher of left and right image by these parameters.
[[nodiscard]] inline stereo::StereoMatcher matcherFor(const StereoCamera& camera,
                                                      const SlamParams& params) {
  return {static_cast<int>(params.max_disparity_ratio * camera.width), params.min_zncc};
}

/// A landmark as found in one frame.
struct TrackedLandmark {
  LandmarkId id;
  int level = 0;  ///< pyramid level it was found at
  stereo::StereoMeasurement measurement;
  double patch_scale = 1.0;  ///< pixels of its reference patch in one pixel of `level`
};

/// Of those whose disparity was measured [px]; nullopt if none was.
[[nodiscard]] std::optional<double> medianDisparity(const std::vector<TrackedLandmark>& seen);

/// Finds landmarks of the map in images.
///
/// In two steps: landmarks of the previous frame are tracked coarse to fine, which needs only a
/// rough pose; then those of the local map are aligned with their own warped reference patches,
/// so that errors do not accumulate from frame to frame.
class LandmarkTracker {
 public:
  LandmarkTracker(const StereoCamera& camera, const SlamParams& params)
      : camera_(camera), params_(params), matcher_(matcherFor(camera, params)) {}

  /// Where landmarks of the previous frame are now, left image alone.
  ///
  /// @param T_map_cam  predicted pose
  [[nodiscard]] std::vector<TrackedLandmark> follow(const TrackingFrame& previous,
                                                    const std::vector<TrackedLandmark>& tracked,
                                                    const TrackingFrame& current,
                                                    const Pose& T_map_cam,
                                                    const SparseMap& map) const;

  /// Measures the local map's landmarks in both images, spread over the image.
  ///
  /// Counts in each landmark how often it was tried and found.
  ///
  /// @param candidates  landmarks that may be in view, ascending
  /// @param T_map_cam   pose, right to a few pixels
  [[nodiscard]] std::vector<TrackedLandmark> measure(const TrackingFrame& current,
                                                     const Pose& T_map_cam,
                                                     const std::vector<LandmarkId>& candidates,
                                                     SparseMap& map) const;

  /// Whether a landmark is where the pose says, to two pixels of the level that it is searched at.
  ///
  /// @param uvd  where it is seen from there
  /// @return     nullopt where it looks too different from there: too small, or too oblique
  [[nodiscard]] std::optional<bool> isFoundAt(const Eigen::Vector3d& uvd, const Landmark& landmark,
                                              const TrackingFrame& current, const Pose& T_map_cam,
                                              const SparseMap& map) const;

 private:
  struct Candidate;
  [[nodiscard]] std::vector<Candidate> candidatesByCell(const TrackingFrame& current,
                                                        const Pose& T_map_cam,
                                                        const std::vector<LandmarkId>& candidates,
                                                        const SparseMap& map) const;
  struct SeenPatch;
  [[nodiscard]] std::optional<SeenPatch> patchSeenFrom(const Pose& T_map_cam,
                                                       const Landmark& landmark, int levels,
                                                       const SparseMap& map) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> findNear(const Eigen::Vector3d& uvd,
                                                        double max_shift_px, const SeenPatch& seen,
                                                        const TrackingFrame& current) const;
  [[nodiscard]] std::optional<TrackedLandmark> measureOne(const TrackingFrame& current,
                                                          const Pose& T_map_cam,
                                                          const Candidate& candidate,
                                                          const SparseMap& map) const;

  [[nodiscard]] stereo::StereoMeasurement stereoMeasurement(const TrackingFrame& current,
                                                            const Eigen::Vector2d& uv,
                                                            double expected_disparity,
                                                            int level) const;

  StereoCamera camera_;
  SlamParams params_;
  stereo::StereoMatcher matcher_;
};

}  // namespace headway::slam
