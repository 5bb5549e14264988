// SPDX-License-Identifier: BSD-3-Clause
// Comparison of left with right images: rows, times, order, and the right camera's rotation.
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/pipeline/perception_update.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/rectification.h>

#include <Eigen/Core>
#include <vector>

#include "evidence.h"

namespace headway::pipeline {

/// Compares left and right images while a recording runs, twice a second: rows that differ, images
/// of different times, and images that are swapped.
///
/// A right image that is late by a frame shows each point where the left image showed it a frame
/// before: rows differ as the left image has moved, however little that is.
///
/// Corners of the left image are searched in a band of rows of the right one, in wide images at
/// half the resolution. A condition is reported when it occurs in two comparisons in a row, so
/// within 1 s; different times, as soon as the sum of the comparisons is decisive, which follow
/// faster once one suspects them. The rotation of the right camera is estimated from the rows of
/// all comparisons, from the first frame on, and is to be undone where it is significant: turn().
class StereoCheck {
 public:
  /// @param matching  as of obstacles and ground
  explicit StereoCheck(const stereo::DisparityParams& matching = {}) : matching_(matching) {}

  /// Takes the images of each frame.
  ///
  /// @return "vertical_offset" if all rows differ alike, "images_not_simultaneous" if they differ
  /// by
  ///         place, as in images of a moving camera that were not taken at the same time, or as
  ///         the left image moves, and
  ///         "images_swapped" if most points have a negative disparity. What turn() explains is no
  ///         difference by place. "too_near" if for 2 s much of what both images show has been
  ///         nearer than what is matched. Fatal: "right_camera_turned", from the beginning, by more
  ///         than can be corrected, with the axis
  [[nodiscard]] Findings add(const StereoFrame& frame);

  /// Whether the next frame is one of the first, each of which is compared and may refuse a camera.
  [[nodiscard]] bool isStarting() const;

  /// Starts with the rotation that an earlier run found for the map in use, before the first frame
  /// [rad]. It changes only by what is surely visible, because the map changes with it.
  void assume(const Eigen::Vector3d& turn);

  /// Takes the disparities' offset that is left in images without turn(), as the camera's motion
  /// shows it.
  ///
  /// @return fatal if the yaw is more than can be corrected: "right_camera_turned"
  [[nodiscard]] std::optional<Finding> addOffset(const stereo::OffsetEstimate& offset,
                                                 const StereoCamera& camera, std::size_t frame);
  /// The same by poses that are recorded, of unknown quality, and therefore refuse no camera.
  void addOffsetAtGivenPoses(const stereo::OffsetEstimate& offset, const StereoCamera& camera);

  /// Whether the camera was seen to move on the rig, so that turn() was another one before.
  [[nodiscard]] bool hasMoved() const { return estimator_ && estimator_->hasMoved(); }

  /// Whether a condition persists since two comparisons that turn() does not explain.
  [[nodiscard]] bool imagesContradict() const { return persists_; }

  /// The right camera's rotation against its calibration; nullopt with too few matches so far.
  [[nodiscard]] std::optional<stereo::RectificationError> rectification() const;

  /// The rotation to be undone in right images from this frame on: pitch, yaw, roll [rad]. Zero
  /// unless significant; it changes where the estimate has moved visibly.
  [[nodiscard]] const Eigen::Vector3d& turn() const { return turn_; }

 private:
  enum class Condition { kNone, kSwapped, kOffset, kScattered, kLate };
  struct Match {
    stereo::RowMatch row;
    double disparity = 0.0;  ///< [px]
  };
  [[nodiscard]] static std::vector<Match> matchesOf(const StereoFrame& frame, int max_corners,
                                                    double searched_turn);
  static void refine(const StereoFrame& frame, std::vector<Match>& matches);
  [[nodiscard]] Condition compare(const std::vector<Match>& matches, const StereoCamera* camera,
                                  double& rows_px) const;
  [[nodiscard]] std::optional<Finding> estimate(const std::vector<Match>& matches,
                                                const StereoFrame& frame);
  /// That the right images are of another time, by these frames of the left one.
  struct Timing {
    Evidence evidence;
    double frames = 0.0;
  };
  void compareTimes(const std::vector<Match>& matches, const cv::Mat& left_image,
                    const cv::Mat& other, const StereoCamera* camera, Timing& timing) const;
  [[nodiscard]] bool isSwapped(const StereoFrame& frame) const;
  [[nodiscard]] Finding findingOf(const StereoFrame& frame, double rows_px) const;
  [[nodiscard]] std::optional<Finding> compareRange(const StereoFrame& frame);

  stereo::DisparityParams matching_;
  std::optional<Time> last_range_;  ///< of the latest compareRange()
  int near_ = 0;                    ///< comparisons in a row in which the scene was too near

  std::optional<Time> last_;           ///< of the latest comparison of which two count
  std::optional<Time> last_timed_;     ///< of the latest one with the frames before and after
  cv::Mat left_before_;                ///< left image of the frame before
  std::vector<Match> matches_before_;  ///< of the frame before, if it was compared
  Timing late_, early_;
  Condition condition_ = Condition::kNone;
  bool persists_ = false;
  int estimated_ = 0;                                        ///< frames
  std::optional<stereo::RectificationEstimator> estimator_;  ///< after the first frame
  std::optional<stereo::OffsetEstimate> disparities_;        ///< with what turn_ explains
  Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d known_ = Eigen::Vector3d::Zero();  ///< before the first frame
  double margin_sigmas_ = 0.0;                       ///< of correctionFor()
};

}  // namespace headway::pipeline
