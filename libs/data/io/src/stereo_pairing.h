// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/io/rawlog_sink.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <array>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "camera_choice.h"
#include "recorded_depth.h"

namespace headway::io {

/// A recorded stereo pair, or an intensity image with depth; external images are not loaded.
///
/// The intensity image of a depth camera is the left one, and the calibration that of a pair whose
/// baseline is equivalentBaseline().
struct RecordedPair {
  Time time = 0.0;  ///< of the left image [s]
  mrpt::img::CImage left;
  mrpt::img::CImage right;
  mrpt::img::TCamera left_camera;
  mrpt::img::TCamera right_camera;
  Pose T_robot_left = Pose::Identity();
  Pose T_left_right = Pose::Identity();
  std::optional<RecordedDepth> depth;  ///< instead of a right image
};

/// A camera's lens.
[[nodiscard]] RawCamera rawCamera(const mrpt::img::TCamera& camera);

/// The pair's calibration.
[[nodiscard]] RawStereoCamera rawCameraOf(const RecordedPair& pair);

/// Whether all numbers of the calibration are finite.
[[nodiscard]] bool hasFiniteCalibration(const RecordedPair& pair);

/// Selects the observations of a stereo camera and pairs single images by time.
class StereoPairing {
 public:
  /// @param tolerance_s  maximum time difference of the two images [s]
  /// @param skipped      counts unpaired images ("unpaired_image", "no_right_image", "no_depth",
  ///                     "no_intensity_image")
  StereoPairing(CameraChoice choice, double tolerance_s,
                std::map<std::string, std::size_t>& skipped)
      : choice_(std::move(choice)), tolerance_s_(tolerance_s), skipped_(skipped) {}

  /// Whether the observation belongs to this camera and may be passed to add().
  [[nodiscard]] bool accepts(const mrpt::obs::CObservation& observation) const;

  /// @return the pair completed by this observation, if any
  [[nodiscard]] std::optional<RecordedPair> add(const mrpt::obs::CObservation::Ptr& observation);

  /// Least time between images of both sides that were too far apart [s]; infinite without any.
  [[nodiscard]] double nearest() const { return nearest_; }
  /// Counts the images that remain unpaired at the end.
  void finish();

 private:
  using Image = mrpt::obs::CObservationImage::Ptr;
  std::optional<RecordedPair> addSingle(const Image& image);
  std::optional<RecordedPair> addDepth(const mrpt::obs::CObservation3DRangeScan& scan);
  void countUnpaired(std::size_t images);

  CameraChoice choice_;
  double tolerance_s_;
  std::map<std::string, std::size_t>& skipped_;
  std::array<std::deque<Image>, 2> waiting_;  ///< left, right
  double nearest_ = std::numeric_limits<double>::infinity();
};

}  // namespace headway::io
