// SPDX-License-Identifier: BSD-3-Clause
// Pictures to an MP4 file.
#pragma once

#include <headway/core/error.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::render {

/// FFmpeg has no encoder for MP4 files. Callers may write pictures instead.
class EncoderUnavailable : public InputError {
 public:
  using InputError::InputError;
};

/// Writes pictures to an MP4 file: H.264 (4:2:0, BT.601), or MPEG-4 if H.264 is not available.
///
/// Uses FFmpeg directly because cv::VideoWriter offers neither the encoder's preset (its default
/// takes twice as long as rendering) nor errors of a full disk.
///
///     VideoFile video("drive.mp4", 10.0, {1280, 720});
///     for (...) video.add(picture);
///     video.finish();
class VideoFile {
 public:
  /// Overwrites an existing file.
  ///
  /// @param rate  pictures per second, above 0
  /// @param size  of the pictures [px], both even because of the halved colour resolution
  /// @throws EncoderUnavailable
  /// @throws InputError if the file cannot be written
  VideoFile(const std::string& path, double rate, cv::Size size);
  /// Without finish() the file may be unplayable.
  ~VideoFile();
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;

  /// Returns before the picture is encoded, so that the next one is drawn meanwhile.
  ///
  /// @param picture  8-bit BGR of the size given; copied
  /// @throws InputError on a write error of the picture before
  void add(const cv::Mat& picture);

  /// Flushes the encoder and writes the index.
  ///
  /// @throws InputError on a write error
  void finish();

 private:
  class Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace headway::render
