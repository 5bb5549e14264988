// SPDX-License-Identifier: BSD-3-Clause
// From recorded pairs to rectified stereo frames, and what shows that a calibration does not belong
// to its images.
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/io/rawlog_source.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame_collector.h"
#include "rectifier.h"

namespace headway::io {

/// @throws InputError if left and right images are swapped according to the report
void requireNotSwapped(const CalibrationReport& report);

/// Images of a recorded pair, 8-bit grey or BGR.
struct DecodedPair {
  cv::Mat left;
  cv::Mat right;   ///< empty: of a depth camera
  cv::Mat ranges;  ///< of a depth camera, 16-bit
};

/// Converts recorded pairs to rectified stereo frames, with the calibration of the first pair.
class FrameDecoder {
 public:
  /// @param image_folder  folder of external images
  /// @param skipped       counts the reasons of pixelsOf() and rangesOf(), "image_size",
  /// "depth_size"
  FrameDecoder(std::string image_folder, std::map<std::string, std::size_t>& skipped)
      : image_folder_(std::move(image_folder)), skipped_(skipped) {}

  /// The images of the pair; nullopt, and counted, if one is missing, broken or of a size other
  /// than the calibration's.
  [[nodiscard]] std::optional<DecodedPair> decode(const RecordedPair& pair);

  /// Sets the calibration and measures its consistency with the images.
  ///
  /// @throws InputError if the calibration is invalid
  void calibrate(const RecordedPair& pair, const DecodedPair& images);

  /// Compares left and right in the first pairs with texture.
  ///
  /// @throws InputError if they are identical
  void requireTwoCameras(const DecodedPair& images);

  /// Matches some pairs of the first second that have corners, in a band of rows that a turned
  /// camera needs as well.
  ///
  /// @throws InputError if nothing matches in any, or their rows differ from pair to pair, as those
  ///         of cameras that are not synchronised while they turn
  void requireMatching(const StereoFrame& frame);

  /// The rectified images. Requires calibrate().
  [[nodiscard]] StereoFrame stereoFrame(const DecodedPair& images) const;
  /// The rectified right image in colour; empty if it is grey.
  [[nodiscard]] cv::Mat rightColour(const DecodedPair& images) const;
  /// The frame without motion prior; `images` are those of its pair. Requires calibrate().
  [[nodiscard]] RecordedFrame frameOf(PendingFrame pending, const DecodedPair& images) const;
  /// A frame that is a pose.
  [[nodiscard]] static RecordedFrame frameOf(PendingFrame pending);
  /// Rectifies boxes of the recorded image; boxes of images of other sizes are not changed.
  void rectifyBoxes(Detections& detections) const;

  [[nodiscard]] const std::string& imageFolder() const { return image_folder_; }
  /// Null before calibrate().
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const { return camera_; }
  [[nodiscard]] const std::optional<CalibrationReport>& report() const { return report_; }

 private:
  [[nodiscard]] std::string decodeRight(const RecordedPair& pair, DecodedPair& images) const;
  void calibrateDepth(const RecordedPair& pair, const DecodedPair& images);
  void requireBetterThanSwapped(const DecodedPair& images) const;

  std::string image_folder_;
  std::map<std::string, std::size_t>& skipped_;
  std::optional<Rectifier> rectifier_;
  std::optional<DepthRegistration> registration_;  ///< of a depth camera
  std::shared_ptr<const StereoCamera> camera_;
  std::optional<CalibrationReport> report_;
  std::size_t identical_pairs_ = 0;
  bool are_two_cameras_ = false;
  std::size_t compared_ = 0;      ///< pairs, by requireMatching()
  Time last_compared_ = 0.0;      ///< of the latest of them
  std::size_t most_matches_ = 0;  ///< in one of them
  std::vector<double> rows_px_;   ///< offset of those with matches
};

}  // namespace headway::io
