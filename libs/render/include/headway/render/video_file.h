#pragma once

#include <headway/core/error.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::render {

/// This FFmpeg can encode no video that an MP4 file holds. Callers may write pictures instead.
class EncoderUnavailable : public InputError {
 public:
  using InputError::InputError;
};

/// Writes pictures to an MP4 file: H.264 as browsers and phones play it (4:2:0, BT.601), or MPEG-4
/// where there is no encoder of that.
///
/// Through FFmpeg's libraries, which cv::VideoWriter uses as well: that one offers neither the
/// encoder's speed (its choice takes twice as long as drawing) nor an error when the disk is full.
///
///     VideoFile video("drive.mp4", 10.0, {1280, 720});
///     for (...) video.add(picture);
///     video.finish();
class VideoFile {
 public:
  /// Writes over a file that is there.
  ///
  /// @param rate  pictures a second, above 0
  /// @param size  of each picture [px], both even: colour has half the resolution
  /// @throws EncoderUnavailable
  /// @throws InputError if the file cannot be written
  VideoFile(const std::string& path, double rate, cv::Size size);
  /// Leaves a file that may not play if finish() was not called.
  ~VideoFile();
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;

  /// @param picture  8-bit BGR of the size given
  /// @throws InputError if it cannot be written
  void add(const cv::Mat& picture);

  /// Writes the pictures that the encoder still holds, and the file's index.
  ///
  /// @throws InputError if they cannot be written
  void finish();

 private:
  class Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace headway::render
