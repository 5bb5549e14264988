// SPDX-License-Identifier: BSD-3-Clause
// headway-import rawlog: checks a rawlog, or thins its frames.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <algorithm>
#include <iostream>

#include "commands.h"
#include "recording_check.h"

namespace headway::import {
namespace {

using mrpt::obs::CObservation;

/// Whether an observation's images are files beside the rawlog.
bool hasImageBeside(const CObservation& observation) {
  if (const auto* stereo = dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation)) {
    return stereo->imageLeft.isExternallyStored() || stereo->imageRight.isExternallyStored();
  }
  if (const auto* image = dynamic_cast<const mrpt::obs::CObservationImage*>(&observation)) {
    return image->image.isExternallyStored();
  }
  const auto* scan = dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation);
  return scan != nullptr &&
         (scan->rangeImage_isExternallyStored() || scan->intensityImage.isExternallyStored());
}

/// Times of the images of one camera, ascending: the first of a rawlog, or the one of a label.
class FrameTimes {
 public:
  FrameTimes(std::string label, std::size_t every) : label_(std::move(label)), every_(every) {}

  void add(const CObservation& observation) {
    if (!isAnyImage(observation) || observation.timestamp == INVALID_TIMESTAMP) return;
    if (label_.empty()) label_ = observation.sensorLabel;
    if (observation.sensorLabel == label_) times_.push_back(io::timeFrom(observation.timestamp));
  }
  void finish() { std::sort(times_.begin(), times_.end()); }

  [[nodiscard]] std::size_t count() const { return times_.size(); }
  [[nodiscard]] bool isFrame(const CObservation& observation) const {
    return isAnyImage(observation) && observation.sensorLabel == label_;
  }
  /// Whether the frame nearest in time is kept.
  [[nodiscard]] bool keeps(Time time) const {
    auto nearest = std::lower_bound(times_.begin(), times_.end(), time);
    const bool is_after = nearest == times_.end() ||
                          (nearest != times_.begin() && time - *(nearest - 1) < *nearest - time);
    if (is_after) --nearest;
    return static_cast<std::size_t>(nearest - times_.begin()) % every_ == 0;
  }

 private:
  std::string label_;
  std::size_t every_;
  std::vector<Time> times_;
};

/// What a rawlog was thinned to.
struct Thinned {
  std::size_t frames = 0, frames_before = 0, others = 0;
  std::map<std::string, std::size_t> skipped;
  std::optional<std::string> truncation;
};

/// Copies a rawlog with every Nth frame: its images and boxes, and all that other sensors measured.
///
/// @param label  see io::RawlogSourceOptions
Thinned thin(const std::string& input, const std::string& output, const std::string& label,
             std::size_t every) {
  FrameTimes frames(label.substr(0, label.find(',')), every);
  Thinned thinned;
  (void)io::visitObservations(input, thinned.skipped,
                              [&](const CObservation& observation) { frames.add(observation); });
  frames.finish();
  if (frames.count() == 0) {
    throw InputError(input + ": contains no images" + (label.empty() ? "" : " of " + label));
  }
  thinned.frames_before = frames.count();
  io::RawlogSink sink(output, io::ImageStorage::kEmbeddedRaw);
  thinned.skipped.clear();
  thinned.truncation =
      io::visitObservations(input, thinned.skipped, [&](const CObservation& observation) {
        if (program::interrupted()) return;
        const bool is_image = isAnyImage(observation);
        const bool is_of_frame =
            is_image || dynamic_cast<const CObservationObjectDetections*>(&observation) != nullptr;
        const bool has_time = observation.timestamp != INVALID_TIMESTAMP;
        if (is_of_frame && (!has_time || !frames.keeps(io::timeFrom(observation.timestamp))))
          return;
        if (is_image && hasImageBeside(observation)) {
          throw InputError(input +
                           ": stores its images beside it; import the recording again without "
                           "--external-images");
        }
        thinned.others += is_of_frame ? 0 : 1;
        thinned.frames += frames.isFrame(observation) ? 1 : 0;
        sink.write(observation);
      });
  sink.close();
  return thinned;
}

void report(const std::string& input, const std::string& output, std::size_t every,
            const Thinned& thinned) {
  if (thinned.truncation) {
    std::cout << "note: " << printable(input) << " " << printable(*thinned.truncation) << "\n";
  }
  std::cout << printable(output) << ": " << thinned.frames << " of " << thinned.frames_before
            << " frames (every " << every << "), " << thinned.others
            << " observations of other sensors" << (program::interrupted() ? ", interrupted" : "");
  for (const auto& [reason, count] : thinned.skipped) {
    std::cout << ", skipped " << printable(reason) << " " << count;
  }
  std::cout << std::endl;
}

}  // namespace

int runRawlog(int argc, const char** argv) {
  std::string input, output_path, sensor_label;
  std::optional<std::size_t> every;
  bool check = false, overwrite = false;
  program::CommandLine line("headway-import rawlog",
                            "Checks a rawlog, or writes it again with every Nth frame and all "
                            "observations of other sensors.");
  line.positional(input, "FILE", "Rawlog");
  line.option(output_path, 'o', "output", "OUT.rawlog", "Rawlog to write, with --every");
  line.option(every, 0, "every", "N",
              "Keep frames 0, N, 2N and so on, with their boxes; images are stored raw");
  line.option(sensor_label, 0, "sensor-label", "LABEL",
              "Stereo camera to use if the rawlog contains several");
  addCheck(line, check);
  line.flag(overwrite, 'w', "overwrite", "Overwrite an existing output");
  if (!line.parse(argc, argv)) return program::kDone;
  if (!every) {
    if (!output_path.empty()) throw program::UsageError("-o requires --every N");
    if (!check) throw program::UsageError("a rawlog needs no import; --check checks it");
    program::catchInterrupts();
    return checkRawlog(input, sensor_label);
  }
  if (*every < 1) throw program::UsageError("--every: must be at least 1");
  const ImportOutput output(output_path, check);
  program::requireWritable(output.path(), overwrite, {input});
  program::catchInterrupts();
  const Thinned thinned = thin(input, output.path(), sensor_label, *every);
  if (!line.quiet()) report(input, output.path(), *every, thinned);
  return check ? checkRawlog(output.path(), sensor_label) : program::kDone;
}

}  // namespace headway::import
