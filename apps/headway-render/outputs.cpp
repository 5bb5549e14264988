#include "outputs.h"

#include <headway/core/error.h>
#include <headway/program/command_line.h>

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace headway::render_program {

void writePicture(const std::string& path, const cv::Mat& picture) {
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) {
    throw InputError(path + ": cannot be written (is the disk full, or the folder missing?)");
  }
}

class VideoOutput::Encoder {
 public:
  /// H.264 plays everywhere; MPEG-4 is what a plain build has.
  bool open(const std::string& path, double rate, cv::Size size) {
    for (const int code : {cv::VideoWriter::fourcc('a', 'v', 'c', '1'),
                           cv::VideoWriter::fourcc('m', 'p', '4', 'v')}) {
      try {
        if (writer_.open(path, code, rate, size, true)) return true;
      } catch (const cv::Exception&) {
        continue;
      }
    }
    return false;
  }
  void add(const cv::Mat& picture) { writer_.write(picture); }

 private:
  cv::VideoWriter writer_;
};

VideoOutput::VideoOutput(const std::string& path, double rate, cv::Size size, bool overwrite,
                         const Note& note) {
  auto encoder = std::make_unique<Encoder>();
  if (encoder->open(path, rate, size)) {
    encoder_ = std::move(encoder);
    return;
  }
  const std::filesystem::path video(path);
  folder_ = video.parent_path() / (video.stem().string() + "_frames");
  program::requireWritable(folder_, overwrite);
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw InputError(folder_.string() + ": cannot be made: " + error.message());
  note("no MP4 encoder here: pictures are written to " + folder_.string() + " instead");
}

VideoOutput::~VideoOutput() = default;

void VideoOutput::add(const cv::Mat& picture) {
  if (encoder_ != nullptr) {
    encoder_->add(picture);
  } else {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%06zu.png", count_);
    writePicture(folder_ / name.data(), picture);
  }
  ++count_;
}

}  // namespace headway::render_program
