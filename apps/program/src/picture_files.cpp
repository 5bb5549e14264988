// SPDX-License-Identifier: BSD-3-Clause
// Pictures and videos that programs write.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/program/files.h>
#include <headway/program/picture_files.h>

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace headway::program {

void writePicture(const std::string& path, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  try {
    cv::imencode(std::filesystem::path(path).extension().string(), picture, bytes);
  } catch (const cv::Exception&) {
    throw InputError(path + ": the name must end in .png or .jpg");
  }
  writeFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

VideoOutput::VideoOutput(const std::string& path, double rate, cv::Size size, bool overwrite,
                         const std::function<void(const std::string&)>& note)
    : path_(path) {
  try {
    video_.emplace(path, rate, size);
    return;
  } catch (const render::EncoderUnavailable& error) {
    note(error.what());
  }
  path_ = path_.parent_path() / (path_.stem().string() + "_frames");
  requireWritable(path_, overwrite);
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error) throw InputError(path_.string() + ": cannot be made: " + error.message());
  note("pictures are written to " + path_.string() + " instead");
}

void VideoOutput::add(const cv::Mat& picture) {
  if (video_) {
    video_->add(picture);
  } else {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%06zu.png", count_);
    writePicture(path_ / name.data(), picture);
  }
  ++count_;
}

void VideoOutput::finish() {
  if (video_) video_->finish();
}

}  // namespace headway::program
