#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

#include "finished_replay.h"

namespace headway::render_program {

/// @throws InputError if the picture cannot be written
void writePicture(const std::string& path, const cv::Mat& picture);

/// An MP4, or where this OpenCV has no encoder for it, pictures numbered from 0 in a folder
/// `NAME_frames` beside it.
class VideoOutput {
 public:
  /// @param rate  pictures a second
  /// @throws InputError if neither can be written
  VideoOutput(const std::string& path, double rate, cv::Size size, bool overwrite,
              const Note& note);
  ~VideoOutput();
  VideoOutput(const VideoOutput&) = delete;
  VideoOutput& operator=(const VideoOutput&) = delete;

  void add(const cv::Mat& picture);

 private:
  class Encoder;
  std::unique_ptr<Encoder> encoder_;  ///< null: pictures in a folder
  std::filesystem::path folder_;
  std::size_t count_ = 0;
};

}  // namespace headway::render_program
