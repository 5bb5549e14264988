// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway/report/recorded_images.h>

#include <filesystem>
#include <optional>

namespace headway::report {

class RecordedImages::Reader {
 public:
  Reader(const std::string& rawlog, const io::RawlogSourceOptions& options)
      : source_(rawlog, options) {}

  [[nodiscard]] bool hasImages() const { return source_.camera() != nullptr; }

  cv::Mat at(std::size_t frame) {
    while (!has_ended_ && (!ahead_ || ahead_->index < frame)) {
      ahead_ = source_.next();
      has_ended_ = !ahead_;
    }
    if (!ahead_ || ahead_->index != frame || !ahead_->stereo) return {};
    const StereoFrame& stereo = *ahead_->stereo;
    return stereo.left_colour.empty() ? stereo.left : stereo.left_colour;
  }

 private:
  io::RawlogSource source_;
  std::optional<RecordedFrame> ahead_;  ///< read ahead
  bool has_ended_ = false;
};

RecordedImages::RecordedImages(const ReplayInput& input, std::size_t first_frame,
                               const Note& note) {
  const std::string without = ": drawn without the camera's image";
  if (input.rawlog.empty()) {
    note("the rawlog is unknown" + without);
    return;
  }
  if (!std::filesystem::exists(input.rawlog)) {
    note(input.rawlog + " does not exist" + without);
    return;
  }
  try {
    io::RawlogSourceOptions options;
    options.sensor_label = input.sensor_label;
    options.from_index = first_frame;
    reader_ = std::make_unique<Reader>(input.rawlog, options);
    if (reader_->hasImages()) return;
    note(input.rawlog + " contains no images" + without);
  } catch (const InputError& error) {
    note(error.what() + without);
  }
  reader_.reset();
}

RecordedImages::~RecordedImages() = default;

cv::Mat RecordedImages::at(std::size_t frame) {
  return reader_ != nullptr ? reader_->at(frame) : cv::Mat();
}

}  // namespace headway::report
