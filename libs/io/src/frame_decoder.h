#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/io/rawlog_source.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "rectifier.h"
#include "stereo_pairing.h"

namespace headway::io {

/// Images of a pair as recorded, 8-bit grey or BGR.
struct DecodedPair {
  cv::Mat left;
  cv::Mat right;
};

/// Makes rectified stereo frames of recorded pairs; the first pair's calibration holds for all.
class FrameDecoder {
 public:
  /// @param image_folder  where images beside the rawlog are
  /// @param skipped       counts "missing_image", "broken_image", "image_size"
  FrameDecoder(std::string image_folder, std::map<std::string, std::size_t>& skipped)
      : image_folder_(std::move(image_folder)), skipped_(skipped) {}

  /// The images of the pair; nullopt, and counted, if one is missing, broken or of another size
  /// than the calibration is for.
  [[nodiscard]] std::optional<DecodedPair> decode(const RecordedPair& pair);

  /// Learns the calibration, and measures it on the images.
  ///
  /// @throws InputError if it cannot be used
  void calibrate(const RecordedPair& pair, const DecodedPair& images);

  /// The images, rectified. To be called once calibrate() was.
  [[nodiscard]] StereoFrame stereoFrame(const DecodedPair& images) const;
  /// The right image in colour, rectified; empty if it is grey.
  [[nodiscard]] cv::Mat rightColour(const DecodedPair& images) const;
  /// Boxes are in the image as recorded; boxes of another image (by its size) stay as they are.
  void rectifyBoxes(Detections& detections) const;

  [[nodiscard]] const std::string& imageFolder() const { return image_folder_; }
  /// Null before calibrate().
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const { return camera_; }
  [[nodiscard]] const std::optional<CalibrationReport>& report() const { return report_; }

 private:
  std::string image_folder_;
  std::map<std::string, std::size_t>& skipped_;
  std::optional<Rectifier> rectifier_;
  std::shared_ptr<const StereoCamera> camera_;
  std::optional<CalibrationReport> report_;
};

}  // namespace headway::io
