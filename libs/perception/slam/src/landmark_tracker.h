// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>
#include <headway/stereo/stereo_match.h>

#include <vector>

#include "keypoints.h"
#include "sparse_map.h"
#include "tracking_frame.h"

namespace headway::slam {

/// A landmark as found in one frame.
struct TrackedLandmark {
  LandmarkId id;
  int level = 0;  ///< pyramid level it was found at
  stereo::StereoMeasurement measurement;
  double patch_scale = 1.0;  ///< pixels of its reference patch in one pixel of `level`
};

/// Finds landmarks of the map in images.
///
/// In two steps: landmarks of the previous frame are tracked coarse to fine, which needs only a
/// rough pose; then those of the local map are aligned with their own warped reference patches,
/// so that errors do not accumulate from frame to frame.
class LandmarkTracker {
 public:
  LandmarkTracker(const StereoCamera& camera, const SlamParams& params);

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

 private:
  struct Candidate;
  [[nodiscard]] std::vector<Candidate> candidatesByCell(const TrackingFrame& current,
                                                        const Pose& T_map_cam,
                                                        const std::vector<LandmarkId>& candidates,
                                                        const SparseMap& map) const;
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

/// Whether this pixel is set in a mask; nowhere in an empty one.
[[nodiscard]] bool isExcluded(const cv::Mat& excluded, const Eigen::Vector2d& uv);

}  // namespace headway::slam
