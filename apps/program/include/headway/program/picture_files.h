// SPDX-License-Identifier: BSD-3-Clause
// Pictures and videos that programs write.
#pragma once

#include <headway/render/video_file.h>

#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace headway::program {

/// @throws InputError if the picture cannot be written
void writePicture(const std::string& path, const cv::Mat& picture);

/// An MP4 file or, without an encoder, pictures numbered from 0 in the folder `NAME_frames`.
class VideoOutput {
 public:
  /// @param rate       pictures per second
  /// @param overwrite  whether the folder of pictures may exist
  /// @param note       called with the folder if pictures are written instead
  /// @throws InputError if neither can be written
  VideoOutput(const std::string& path, double rate, cv::Size size, bool overwrite,
              const std::function<void(const std::string&)>& note);

  /// @throws InputError
  void add(const cv::Mat& picture);
  /// @throws InputError
  void finish();

  /// The video, or the folder of pictures.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::optional<render::VideoFile> video_;  ///< nullopt: pictures in a folder
  std::filesystem::path path_;
  std::size_t count_ = 0;
};

}  // namespace headway::program
