#include "recorded_images.h"

#include <headway/core/error.h>

#include <filesystem>

namespace headway::render_program {

RecordedImages::RecordedImages(const FinishedReplay& replay, std::size_t first_frame,
                               const Note& note) {
  const std::string without = ": drawn without the camera's image";
  if (replay.rawlog.empty()) {
    note("the rawlog is unknown" + without);
    return;
  }
  if (!std::filesystem::exists(replay.rawlog)) {
    note(replay.rawlog + " does not exist" + without);
    return;
  }
  try {
    io::RawlogSourceOptions options;
    options.sensor_label = replay.sensor_label;
    options.from_index = first_frame;
    source_.emplace(replay.rawlog, options);
    if (source_->camera() != nullptr) return;
    note(replay.rawlog + " contains no images" + without);
  } catch (const InputError& error) {
    note(error.what() + without);
  }
  source_.reset();
}

cv::Mat RecordedImages::at(const ReplayFrame& frame) {
  if (!source_) return {};
  while (!ahead_ || ahead_->index < frame.frame) {
    ahead_ = source_->next();
    if (!ahead_) {
      source_.reset();
      return {};
    }
  }
  if (ahead_->index != frame.frame || !ahead_->stereo) return {};
  const StereoFrame& stereo = *ahead_->stereo;
  return stereo.left_colour.empty() ? stereo.left : stereo.left_colour;
}

}  // namespace headway::render_program
