// SPDX-License-Identifier: BSD-3-Clause
// headway-live: the cameras and sensors of a robot to trajectory, tracks, predictions and map.
#include <headway/core/error.h>
#include <headway/core/stop_request.h>
#include <headway/drivers/observation_recorder.h>
#include <headway/drivers/sensor_group.h>
#include <headway/io/calibration_file.h>
#include <headway/io/live_source.h>
#include <headway/io/observation_calibration.h>
#include <headway/pipeline/load_shedder.h>
#include <headway/program/progress.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/system/os.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

#include "live_options.h"
#include "live_page.h"
#include "replay.h"
#include "status_line.h"

namespace {

using namespace headway;
using mrpt::obs::CObservation;

io::LiveSourceOptions sourceOptions(const live::LiveOptions& options,
                                    const pipeline::PerceptionParams& params) {
  io::LiveSourceOptions result;
  result.observations.sensor_label = options.run.sensor_label;
  result.observations.pair_tolerance_s = options.pair_tolerance_s;
  result.observations.use_odometry = params.slam.use_odometry;
  result.observations.use_imu = params.slam.use_imu;
  result.observations.use_laser = params.laser.use && params.grid.every_nth_frame > 0;
  return result;
}

/// Sets the calibration of images, of two cameras by their labels LEFT,RIGHT.
void calibrate(const io::RawStereoCamera& camera, const std::string& labels,
               CObservation& observation) {
  if (auto* stereo = dynamic_cast<mrpt::obs::CObservationStereoImages*>(&observation)) {
    io::setCalibration(camera, *stereo);
  } else if (auto* image = dynamic_cast<mrpt::obs::CObservationImage*>(&observation)) {
    const auto comma = labels.find(',');
    const std::string& label = image->sensorLabel;
    if (comma == std::string::npos) return;
    const bool is_left = label == labels.substr(0, comma);
    if (is_left || label == labels.substr(comma + 1)) io::setCalibration(camera, is_left, *image);
  }
}

mrpt::config::CConfigFile readSensors(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path + ": no such file of sensors");
  }
  return mrpt::config::CConfigFile(path);
}

void warn(const std::string& text) { std::cerr << "headway-live: " << text << std::endl; }

std::unique_ptr<drivers::SensorGroup> makeSensors(
    const std::string& path, drivers::SensorGroup::ObservationCallback deliver) {
  try {
    return std::make_unique<drivers::SensorGroup>(readSensors(path), std::move(deliver), warn);
  } catch (const InputError& error) {
    const std::string reason = error.what();
    throw InputError(reason.rfind(path, 0) == 0 ? reason : path + ": " + reason);
  }
}

void loadPlugins(const std::string& libraries) {
  std::string error;
  if (!libraries.empty() && !mrpt::system::loadPluginModules(libraries, error)) {
    throw InputError("--load-plugins " + libraries + ": " + error);
  }
}

/// Why there is no stereo pair yet, as far as it is known.
std::string describeWait(const io::LiveSource& source, double pair_tolerance_s) {
  const auto skipped = source.skipped();
  const auto unpaired = skipped.find("unpaired_image");
  if (unpaired == skipped.end()) return "";
  std::ostringstream text;
  text << "; " << unpaired->second << " images have no partner of the other camera within "
       << pair_tolerance_s << " s (--pair-tolerance)";
  return text.str();
}

/// Waits for the first images; false if the program was interrupted before.
bool waitForCamera(io::LiveSource& source, double pair_tolerance_s) {
  try {
    if (source.camera() != nullptr || !program::interrupted()) return true;
  } catch (const InputError&) {
    if (!program::interrupted()) throw;
  }
  warn("interrupted before the first stereo pair" + describeWait(source, pair_tolerance_s));
  return false;
}

void finish(const std::string& path, drivers::ObservationRecorder& recorder) {
  recorder.close();
  if (recorder.dropped() == 0) return;
  warn(path + ": lacks " + std::to_string(recorder.dropped()) +
       " observations, because the disk was slower than the sensors");
}

std::unique_ptr<live::LivePage> makePage(const live::LiveOptions& options) {
  if (!options.show_port) return nullptr;
  auto page = std::make_unique<live::LivePage>(
      live::LivePageOptions{static_cast<int>(*options.show_port), options.show_address});
  std::printf("page: %s\n", page->url().c_str());
  std::fflush(stdout);
  return page;
}

live::LiveView viewOf(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update,
                      const replay::Replay& run, const drivers::SensorGroup& sensors) {
  live::LiveView view;
  view.frame = frame;
  view.update = update;
  view.map = run.perception().map();
  view.process_s = 1e-3 * run.summary().last_frame_ms;
  view.frames = run.summary().frame_ms.count();
  view.sensors = sensors.status();
  view.warnings = run.summary().warnings;
  return view;
}

pipeline::RuntimeParams runtimeParams(const pipeline::PerceptionParams& params) {
  pipeline::RuntimeParams result;
  result.detect_every_nth_frame = params.detection.detect.every_nth_frame;
  result.grid_every_nth_frame = params.grid.every_nth_frame;
  result.recorded_timeout_s = params.detection.recorded_timeout_s;
  return result;
}

/// Leaves work out while frames take longer than the sensor's interval.
class LoadControl {
 public:
  LoadControl(replay::Replay& run, const pipeline::PerceptionParams& params)
      : run_(run), shedder_(runtimeParams(params)) {}

  /// Takes a processed frame. @param page_s  time of its page
  void add(const RecordedFrame& frame, double page_s) {
    const auto before = std::exchange(last_, Stamped<std::size_t>{frame.time, frame.index});
    if (!before || frame.index <= before->value || !(frame.time > before->time)) return;
    const double interval_s =
        (frame.time - before->time) / static_cast<double>(frame.index - before->value);
    const double process_s = 1e-3 * run_.summary().last_frame_ms + page_s;
    const auto line = shedder_.add(monotonicSeconds(), process_s, interval_s);
    if (!line) return;
    run_.change(shedder_.params());
    run_.warn("frame " + std::to_string(frame.index) + ": " + *line);
  }
  [[nodiscard]] bool hasPage() const {
    return shedder_.level() == pipeline::LoadShedder::Level::kNothing;
  }
  [[nodiscard]] std::string description() const { return shedder_.description(); }

 private:
  replay::Replay& run_;
  pipeline::LoadShedder shedder_;
  std::optional<Stamped<std::size_t>> last_;  ///< index of the last frame
};

/// Shows each frame in the status line and, if there is one, on the page.
replay::Replay::FrameCallback reporter(replay::Replay& run,
                                       const pipeline::PerceptionParams& params,
                                       const replay::LiveInput& live, const io::LiveSource& source,
                                       const drivers::SensorGroup& sensors,
                                       live::StatusLine& status, live::LivePage* page) {
  auto load = std::make_shared<LoadControl>(run, params);
  return [&, load, page, page_s = 0.0](const RecordedFrame& frame,
                                       const pipeline::PerceptionUpdate& update) mutable {
    const double now_s = monotonicSeconds();
    const double latency_s = now_s - live.arrival_s();
    load->add(frame, std::exchange(page_s, 0.0));
    status.update(update, latency_s, source.dropped(), load->description());
    if (page == nullptr || !load->hasPage()) return;
    auto view = viewOf(frame, update, run, sensors);
    view.latency_s = latency_s;
    view.dropped = source.dropped();
    page->show(std::move(view));
    page_s = monotonicSeconds() - now_s;  // counts for the next frame
  };
}

/// Runs sensors and pipeline until they are interrupted.
void run(const live::LiveOptions& options, bool quiet, const pipeline::PerceptionParams& params,
         const Params& all_params) {
  loadPlugins(options.plugins);
  std::optional<io::RawStereoCamera> calibration;
  if (!options.calibration.empty()) calibration = io::readRawCalibration(options.calibration);
  std::optional<drivers::ObservationRecorder> recorder;
  if (!options.record.empty()) recorder.emplace(options.record);
  io::LiveSource source(sourceOptions(options, params));
  const auto deliver = [&](const CObservation::Ptr& observation) {
    if (calibration) calibrate(*calibration, options.run.sensor_label, *observation);
    if (recorder) recorder->write(observation);
    source.push(observation);
  };
  const auto page = makePage(options);
  const auto sensors = makeSensors(options.sensors, deliver);
  const auto poll = [&source] {
    if (program::interrupted()) source.close();
  };
  const auto wait = [&] { return describeWait(source, options.pair_tolerance_s); };
  live::StatusLine status(quiet, poll, wait);
  sensors->start();
  if (!waitForCamera(source, options.pair_tolerance_s)) return;
  auto input = std::make_unique<replay::LiveInput>(source);
  const replay::LiveInput& live = *input;
  replay::Replay pipeline(options.run, std::move(input), params, all_params);
  pipeline.onFrame(reporter(pipeline, params, live, source, *sensors, status, page.get()));
  pipeline.run();
  sensors->stop();
  if (recorder) finish(options.record, *recorder);
  if (!quiet) replay::printSummary(pipeline.summary());
}

}  // namespace

int main(int argc, char** argv) {
  return program::run("headway-live", [&] {
    live::LiveOptions options;
    pipeline::PerceptionParams params;
    Params all_params;
    params.describe(all_params);
    replay::describeCheckpoints(options.run.checkpoint_s, all_params);
    program::CommandLine line(
        "headway-live",
        "Runs the pipeline on a robot's sensors until Ctrl-C: localises the camera, maps the "
        "static environment, tracks and predicts moving objects, and writes OUTDIR as it goes.");
    live::describe(options, line);
    line.parameters(all_params);
    if (!line.parse(argc, argv)) return program::kDone;
    options.run.quiet = line.quiet() || line.verbosity() > mrpt::system::LVL_INFO;
    options.run.debug = line.verbosity() == mrpt::system::LVL_DEBUG;
    options.run.input = options.record;
    live::check(options);
    if (!options.run.detector.empty()) params.detection.detector = options.run.detector;
    program::catchInterrupts();
    run(options, line.quiet(), pipeline::PerceptionParams::live(params), all_params);
    requestStop(0);  // a signal is the regular end, so that the exit status is 0
    return program::kDone;
  });
}
