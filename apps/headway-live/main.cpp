// SPDX-License-Identifier: BSD-3-Clause
// headway-live: the cameras and sensors of a robot to trajectory, tracks, predictions and map.
#include <headway/core/error.h>
#include <headway/core/worker_thread.h>
#include <headway/drivers/observation_recorder.h>
#include <headway/drivers/sensor_group.h>
#include <headway/io/calibration_file.h>
#include <headway/io/live_source.h>
#include <headway/io/raw_camera.h>
#include <headway/pipeline/perception_params.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/system/os.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "live_page.h"
#include "replay.h"

namespace {

using namespace headway;
using mrpt::obs::CObservation;

/// Command-line options of a live run.
struct LiveOptions {
  replay::Options run;      ///< output, map to load and so on, as of a replay
  std::string sensors;      ///< .ini file of rawlog-grabber
  std::string plugins;      ///< shared libraries with drivers, separated by commas
  std::string calibration;  ///< file that replaces the drivers' calibration; empty: none
  std::string record;       ///< rawlog to write; empty: none
  std::optional<std::size_t> show_port;  ///< of the page; nullopt: none
  std::string show_address = "127.0.0.1";
  std::optional<std::size_t> health_port;  ///< nullopt: none
  double pair_tolerance_s = 0.01;
};

/// Adds the options to a command line.
void describe(LiveOptions& options, program::CommandLine& line) {
  options.run.program = "headway-live";
  options.run.snapshots = 0;
  line.option(options.sensors, 0, "sensors", "SENSORS.ini",
              "Sensors to grab, in the format of MRPT's rawlog-grabber", true);
  line.option(options.run.output, 'o', "output", "OUTDIR", "Folder for all results");
  line.option(options.plugins, 0, "load-plugins", "LIB.so,...",
              "Shared libraries with further classes of CGenericSensor");
  line.option(options.calibration, 0, "calibration", "FILE",
              "calibration.yaml that replaces the cameras' calibration and poses");
  line.option(options.record, 0, "record", "OUT.rawlog", "Rawlog of all observations to write");
  line.option(options.run.load_map, 0, "load-map", "MAP",
              "Localise in this map.headway and extend it (slam.mapping=false: localise only)");
  line.option(options.run.sensor_label, 0, "sensor-label", "LABEL",
              "Stereo camera to use if there are several; LEFT,RIGHT for two cameras");
  line.option(options.pair_tolerance_s, 0, "pair-tolerance", "SECONDS",
              "Maximum difference of time of the images of two cameras; default 0.01");
  line.option(
      options.show_port, 0, "show", "PORT",
      "Serve a page at http://127.0.0.1:PORT that shows images, map and health; 0: any port");
  line.option(options.show_address, 0, "show-address", "ADDRESS",
              "Address to serve the page on instead; its URL then contains a secret token");
  line.option(options.health_port, 0, "health", "PORT",
              "Serve http://127.0.0.1:PORT/health for programs: JSON, status 200 while tracked");
  line.option(options.run.detector, 0, "detector", "NAME",
              "Source of boxes; default: detect.detector of the configuration");
  line.flag(options.run.overwrite, 'w', "overwrite", "Overwrite existing results");
}

/// @throws UsageError if options are invalid or contradict each other
void check(const LiveOptions& options) {
  using program::UsageError;
  if (options.run.output.empty()) {
    throw UsageError("-o/--output: is required (--help shows the options)");
  }
  if (!(options.pair_tolerance_s >= 0.0)) {
    throw UsageError("--pair-tolerance must not be negative");
  }
  if (!options.run.detector.empty()) replay::checkDetector(options.run.detector);
  for (const auto& [name, port] :
       {std::pair("--show", options.show_port), std::pair("--health", options.health_port)}) {
    if (port && *port > 65535) throw UsageError(std::string(name) + ": ports are 0 to 65535");
  }
  if (!options.show_port && options.show_address != LiveOptions().show_address) {
    throw UsageError("--show-address has no effect without --show");
  }
  if (!options.record.empty()) {
    if (std::filesystem::path(options.record).extension() == ".zst") {
      throw UsageError("--record: recordings are compressed by gzip; name it OUT.rawlog");
    }
    program::requireWritable(options.record, options.run.overwrite,
                             {options.sensors, options.calibration, options.run.load_map});
  }
}

io::LiveSourceOptions sourceOptions(const LiveOptions& options,
                                    const pipeline::PerceptionParams& params) {
  io::LiveSourceOptions result;
  result.observations.sensor_label = options.run.sensor_label;
  result.observations.pair_tolerance_s = options.pair_tolerance_s;
  result.observations.use_odometry = params.slam.use_odometry;
  result.observations.use_imu = params.slam.use_imu;
  result.observations.use_laser = params.laser.use && params.grid.period_s > 0.0;
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

constexpr char kWaiting[] = "waiting for images";

/// Why there is no stereo pair yet, as far as it is known.
std::string describeWait(const io::LiveSource& source, double pair_tolerance_s) {
  const auto skipped = source.skipped();
  const auto unpaired = skipped.find("unpaired_image");
  if (unpaired == skipped.end()) {
    const std::string missing = source.missing();
    return missing.empty() ? "" : "; " + missing;
  }
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

std::unique_ptr<live::LivePage> makePage(const LiveOptions& options) {
  if (!options.show_port && !options.health_port) return nullptr;
  auto page = std::make_unique<live::LivePage>(
      live::LivePageOptions{options.show_port, options.show_address, options.health_port});
  if (options.show_port) std::printf("page: %s\n", page->url().c_str());
  if (options.health_port) std::printf("health: %s\n", page->healthUrl().c_str());
  std::fflush(stdout);
  return page;
}

/// Prints one line a second in a thread of its own: pose, tracking, tracks, latency and drops.
///
/// Ends the input within about 50 ms of an interrupt, also while no frames arrive.
class StatusLine : public run::Sink {
 public:
  /// @param quiet  prints nothing
  StatusLine(bool quiet, io::LiveSource& source, double pair_tolerance_s)
      : quiet_(quiet),
        source_(source),
        pair_tolerance_s_(pair_tolerance_s),
        thread_([this] { run(); }) {}
  ~StatusLine() override {
    stopping_ = true;
    thread_.join();
  }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void onFrame(const run::FrameResult& result, pipeline::Perception& /*perception*/) override {
    const double latency_s = monotonicSeconds() - result.arrival_s;
    const std::lock_guard lock(mutex_);
    last_ = result;
    max_latency_s_ = std::max(max_latency_s_, latency_s);
    ++frames_;
  }

 private:
  void run();
  [[nodiscard]] std::string text();

  bool quiet_;
  io::LiveSource& source_;
  double pair_tolerance_s_;
  std::mutex mutex_;
  std::optional<run::FrameResult> last_;  // guarded by mutex_, like the members below
  double max_latency_s_ = 0.0;            ///< since the last line
  std::size_t frames_ = 0;                ///< since the last line
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last member, so that it starts after the others
};

void StatusLine::run() {
  using Clock = std::chrono::steady_clock;
  auto due = Clock::now() + std::chrono::seconds(1);
  bool is_said = false;
  while (!stopping_) {
    if (program::interrupted()) source_.close();
    if (Clock::now() >= due) {
      due += std::chrono::seconds(1);
      const std::string line = text();
      if (!quiet_) std::puts(line.c_str());
      std::fflush(stdout);
      const bool is_waiting = line.rfind(kWaiting, 0) == 0 && line != kWaiting;
      if (quiet_ && is_waiting && !std::exchange(is_said, true)) warn(line);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

std::string StatusLine::text() {
  const std::lock_guard lock(mutex_);
  if (!last_) return kWaiting + describeWait(source_, pair_tolerance_s_);
  const pipeline::PerceptionUpdate& update = last_->update;
  const Pose& T_map_robot = update.camera.T_map_robot;
  const auto& place = T_map_robot.translation();
  const auto is_confirmed = [](const Track& track) {
    return track.status == TrackStatus::kConfirmed;
  };
  const auto& tracks = update.objects.tracks;
  std::array<char, 240> line{};
  std::snprintf(line.data(), line.size(),
                "frame %zu: x %.2f y %.2f m, yaw %.1f deg, %s (%d landmarks), %d tracks, %zu "
                "frames/s, latency %.0f ms at most, %zu dropped",
                update.frame, place.x(), place.y(), yawOf(T_map_robot) * 180.0 / M_PI,
                frames_ == 0 ? "no images" : slam::toString(update.camera.status),
                update.camera.inliers,
                static_cast<int>(std::count_if(tracks.begin(), tracks.end(), is_confirmed)),
                frames_, 1e3 * max_latency_s_, last_->source.dropped);
  max_latency_s_ = 0.0;
  frames_ = 0;
  return line.data() + (last_->left_out.empty() ? "" : "; " + last_->left_out);
}

/// Shows the figures of each frame on the page, under any load.
class PageSink : public run::Sink {
 public:
  PageSink(live::LivePage& page, const replay::Replay& run, const drivers::SensorGroup& sensors)
      : page_(page), run_(run), sensors_(sensors) {}

  void onFrame(const run::FrameResult& result, pipeline::Perception& /*perception*/) override {
    live::LiveView view;
    view.update = result.update;
    view.arrival_s = result.arrival_s;
    view.latency_s = monotonicSeconds() - result.arrival_s;
    view.process_s = 1e-3 * run_.summary().last_frame_ms;
    view.frames = result.frames;
    view.dropped = result.source.dropped;
    view.left_out = result.left_out;
    view.sensors = sensors_.status();
    view.warnings = run_.summary().warnings;
    page_.show(std::move(view));
  }

 private:
  live::LivePage& page_;
  const replay::Replay& run_;
  const drivers::SensorGroup& sensors_;
};

/// Shows images and map on the page where there is time.
class PictureSink : public run::Sink {
 public:
  explicit PictureSink(live::LivePage& page) : page_(page) {}

  void onFrame(const run::FrameResult& result, pipeline::Perception& perception) override {
    page_.draw({result.frame, perception.map(), result.arrival_s});
  }
  [[nodiscard]] bool isExpendable() const override { return true; }

 private:
  live::LivePage& page_;
};

/// Runs sensors and pipeline until they are interrupted.
void runLive(const LiveOptions& options, bool quiet, const pipeline::PerceptionParams& params,
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
  StatusLine status(quiet, source, options.pair_tolerance_s);
  sensors->start();
  if (!waitForCamera(source, options.pair_tolerance_s)) return;
  replay::Replay pipeline(options.run, std::make_unique<run::SensorFrames>(source), params,
                          all_params);
  pipeline.add(status);
  std::optional<PictureSink> pictures;
  std::optional<PageSink> shown;
  if (page && options.show_port) pipeline.add(pictures.emplace(*page));
  if (page) pipeline.add(shown.emplace(*page, pipeline, *sensors));
  pipeline.run();
  sensors->stop();
  if (recorder) finish(options.record, *recorder);
  if (!quiet) replay::printSummary(pipeline.summary());
}

}  // namespace

int main(int argc, char** argv) {
  return program::run("headway-live", [&] {
    LiveOptions options;
    pipeline::PerceptionParams params;
    Params all_params;
    params.describe(all_params);
    replay::describeCheckpoints(options.run.checkpoint_s, all_params);
    program::CommandLine line(
        "headway-live",
        "Runs the pipeline on a robot's sensors until Ctrl-C: localises the camera, maps the "
        "static environment, tracks and predicts moving objects, and writes OUTDIR as it goes.");
    describe(options, line);
    line.parameters(all_params);
    if (!line.parse(argc, argv)) return program::kDone;
    options.run.quiet = line.quiet() || line.verbosity() > mrpt::system::LVL_INFO;
    options.run.debug = line.verbosity() == mrpt::system::LVL_DEBUG;
    options.run.input = options.record;
    options.run.is_live = true;
    check(options);
    if (!options.run.detector.empty()) params.detection.detector = options.run.detector;
    program::catchInterrupts();
    runLive(options, line.quiet(), pipeline::PerceptionParams::live(params), all_params);
    requestStop(0);  // a signal is the regular end, so that the exit status is 0
    return program::kDone;
  });
}
