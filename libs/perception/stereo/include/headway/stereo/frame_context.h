// SPDX-License-Identifier: BSD-3-Clause
// What SLAM and the detectors compute of a frame, each value once and when it is first used.
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/core/worker_thread.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/image_pyramid.h>
#include <headway/stereo/rectification.h>
#include <headway/stereo/stereo_match.h>

#include <functional>
#include <memory>
#include <optional>

namespace headway::stereo {

/// @throws InputError if an image is not 8-bit grey (disparities: 32-bit) and of the camera's size
void requireImages(const StereoFrame& frame, const StereoCamera& camera);

/// What SLAM and the detectors compute of one stereo frame, each value once and when first used.
///
/// A handle: copies share the values. Which values are used, when, and whether matching was started
/// ahead does not change any of them. For one calling thread.
///
///     const FrameContext context = front_end.next(frame, disparity_offset_px);
///     context.startMatching(worker);                    // in another thread
///     const auto pose = slam.process(context, {});      // meanwhile
///     const auto found = detector.detect(context, pose.T_map_robot);
class FrameContext {
 public:
  /// A frame on its own: default parameters, no disparity offset and no previous ground.
  ///
  /// @param frame  with its camera; the images are shared
  FrameContext(const StereoFrame& frame);  // NOLINT(google-explicit-constructor)

  /// @param disparity_offset_px  measured less true disparity
  /// @param previous_ground      of the frame before, tried first
  /// @param right_turn           by which the right image was turned back, as rightTurn()
  FrameContext(const StereoFrame& frame, const DisparityParams& params, double disparity_offset_px,
               const std::optional<GroundPlane>& previous_ground,
               const Eigen::Vector3d& right_turn = Eigen::Vector3d::Zero());

  [[nodiscard]] const StereoFrame& frame() const;
  [[nodiscard]] const StereoCamera& camera() const { return *frame().camera; }

  /// Pyramids of the images, contrast-stretched in poor light; of a depth camera, its disparities.
  [[nodiscard]] const ImagePyramid& left() const;
  [[nodiscard]] const SecondView& right() const;

  /// Starts stereo matching in another thread.
  void startMatching(WorkerThread& worker) const;
  /// Dense disparities, corrected by the offset.
  [[nodiscard]] const DisparityImage& disparity() const;
  /// Left image on the grid of the disparities.
  [[nodiscard]] const cv::Mat& reducedLeft() const;
  /// Measured less true disparity, to be subtracted from disparities measured elsewhere [px].
  [[nodiscard]] double disparityOffset() const;
  /// Pitch, yaw, roll of the right camera by which its image was turned back: disparities of frames
  /// of which it differs are not comparable without turnedDisparity() [rad].
  [[nodiscard]] const Eigen::Vector3d& rightTurn() const;

  /// Ground plane in the camera frame; nullopt where none is found (expected, not an error).
  [[nodiscard]] const std::optional<GroundPlane>& ground() const;
  /// The matching of the ground along its plane up to a depth, corrected by the offset, for another
  /// thread. Empty where no ground is found.
  [[nodiscard]] std::function<DisparityImage()> groundMatching(double to_m) const;
  /// The last ground plane known, of this frame if it was asked for; does not search.
  [[nodiscard]] const std::optional<GroundPlane>& lastGround() const;

 private:
  struct Values;
  std::shared_ptr<Values> values_;
};

/// Makes the context of each frame from that of the frame before.
class FrontEnd {
 public:
  /// @throws InputError for parameters out of range
  explicit FrontEnd(const DisparityParams& params);

  /// Turns the right images of the next frames back by the right camera's rotation against its
  /// calibration, so that all who use their contexts see an exactly mounted camera.
  void setRightTurn(const RightTurn& turn) { right_turn_ = turn; }
  [[nodiscard]] const RightTurn& rightTurn() const { return right_turn_; }

  /// Frames come in order of time.
  ///
  /// @param disparity_offset_px  measured less true disparity, as estimated so far
  [[nodiscard]] FrameContext next(const StereoFrame& frame, double disparity_offset_px);

 private:
  DisparityParams params_;
  RightTurn right_turn_;
  std::optional<FrameContext> previous_;
};

}  // namespace headway::stereo
