// SPDX-License-Identifier: BSD-3-Clause
// headway-live: the cameras and sensors of a robot to trajectory, tracks, predictions and map.
#include <headway/core/error.h>
#include <headway/core/input_files.h>
#include <headway/core/text.h>
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
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "live_page.h"
#include "replay.h"
#include "ros2_connection.h"

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
  live::Ros2Options ros2;
  std::string initial_pose;  ///< X,Y,YAW in the loaded map; empty: unknown
};

mrpt::config::CConfigFile readSensors(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw InputError(path + ": no such file of sensors");
  }
  return mrpt::config::CConfigFile(path);
}

/// Rawlogs and images that drivers play are inputs.
void registerRecordings(const std::string& sensors) {
  if (sensors.empty()) return;
  const auto configuration = readSensors(sensors);
  std::vector<std::string> sections;
  configuration.getAllSections(sections);
  for (const auto& section : sections) {
    registerInput(configuration.read_string(section, "rawlog_file", ""));
    program::registerDataset(configuration.read_string(section, "image_dir_url", ""));
  }
}

/// Adds the options to a command line.
void describe(LiveOptions& options, program::CommandLine& line) {
  options.run.program = "headway-live";
  options.run.snapshots = 0;
  line.option(options.sensors, 0, "sensors", "SENSORS.ini",
              "Sensors to grab, in the format of MRPT's rawlog-grabber");
  live::describe(options.ros2, line);
  line.option(options.run.output, 'o', "output", "OUTDIR", "Folder for all results");
  line.option(options.plugins, 0, "load-plugins", "LIB.so,...",
              "Shared libraries with further classes of CGenericSensor");
  line.option(options.calibration, 0, "calibration", "FILE",
              "calibration.yaml that replaces the cameras' calibration and poses");
  line.option(options.record, 0, "record", "OUT.rawlog", "Rawlog of all observations to write");
  line.option(options.run.load_map, 0, "load-map", "MAP",
              "Localise in this map.headway and extend it (slam.mapping=false: localise only)");
  line.option(
      options.initial_pose, 0, "initial-pose", "X,Y,YAW",
      "Where the robot is in the loaded map, about [m, m, rad]: it is searched there first");
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

/// Of --initial-pose. @throws UsageError
Pose initialPoseOf(const std::string& text) {
  std::vector<double> values;
  std::istringstream in(text);
  for (double value = 0.0; in >> value && std::isfinite(value); in.ignore(1, ',')) {
    values.push_back(value);
    if (in.peek() != ',') break;
  }
  if (values.size() != 3 || in.peek() != std::istringstream::traits_type::eof()) {
    throw program::UsageError("--initial-pose " + text + ": must be X,Y,YAW [m, m, rad]");
  }
  Pose pose = Pose::Identity();
  pose.translation().head<2>() << values[0], values[1];
  pose.linear() = Eigen::AngleAxisd(values[2], Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// @throws UsageError if options are invalid or contradict each other
void check(const LiveOptions& options) {
  using program::UsageError;
  if (options.run.output.empty()) {
    throw UsageError("-o/--output: is required (--help shows the options)");
  }
  if (options.sensors.empty() && !options.ros2.isUsed()) {
    throw UsageError("--sensors: is required, or --ros2 (--help shows the options)");
  }
  if (!options.ros2.interface.empty() && !options.ros2.isUsed()) {
    throw UsageError("--ros2-interface has no effect without --ros2");
  }
  if (!options.initial_pose.empty()) {
    (void)initialPoseOf(options.initial_pose);
    if (options.run.load_map.empty()) {
      throw UsageError("--initial-pose has no effect without --load-map");
    }
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
    registerRecordings(options.sensors);
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

void warn(const std::string& text) {
  std::cerr << "headway-live: " << printable(text) << std::endl;
}

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
std::string describeWait(const io::LiveSource& source, double pair_tolerance_s,
                         const live::Ros2Connection* ros2) {
  const std::string topics = ros2 == nullptr ? "" : ros2->missing();
  if (!topics.empty()) return "; ROS 2: " + topics;
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
bool waitForCamera(io::LiveSource& source, double pair_tolerance_s,
                   const live::Ros2Connection* ros2) {
  try {
    if (source.camera() != nullptr || !program::interrupted()) return true;
  } catch (const InputError&) {
    if (!program::interrupted()) throw;
  }
  warn("interrupted before the first stereo pair" + describeWait(source, pair_tolerance_s, ros2));
  return false;
}

/// Of --record; null: none.
std::unique_ptr<drivers::ObservationRecorder> makeRecorder(const LiveOptions& options) {
  if (options.record.empty()) return nullptr;
  namespace fs = std::filesystem;
  const fs::path folder = fs::weakly_canonical(options.run.output);
  if (fs::weakly_canonical(options.record).parent_path() == folder) fs::create_directories(folder);
  return std::make_unique<drivers::ObservationRecorder>(options.record, warn);
}

/// Closes a recording, null: none, at the end of a scope, also when an exception ends it, which
/// remains the one that is reported.
std::shared_ptr<void> closeAtEnd(drivers::ObservationRecorder* recorder) {
  return {nullptr, [recorder](void*) {
            try {
              if (recorder != nullptr) recorder->close();
            } catch (const std::exception& error) {
              warn(error.what());
            }
          }};
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
/// Ends input and page within about 50 ms of an interrupt, also while no frames arrive, and while
/// drivers are configured.
class StatusLine : public run::Sink {
 public:
  /// @param quiet  prints nothing
  /// @param page   null: none
  StatusLine(bool quiet, io::LiveSource& source, live::LivePage* page, double pair_tolerance_s)
      : quiet_(quiet),
        source_(source),
        page_(page),
        pair_tolerance_s_(pair_tolerance_s),
        thread_([this] { run(); }) {}
  ~StatusLine() override {
    stopping_ = true;
    thread_.join();
  }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// From now on names the topics that are waited for; null: none.
  void setTopics(const live::Ros2Connection* ros2) {
    const std::lock_guard lock(mutex_);
    ros2_ = ros2;
  }
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
  live::LivePage* page_;
  double pair_tolerance_s_;
  std::mutex mutex_;
  const live::Ros2Connection* ros2_ = nullptr;  // guarded by mutex_, like the members below
  std::optional<run::FrameResult> last_;
  double max_latency_s_ = 0.0;  ///< since the last line
  std::size_t frames_ = 0;      ///< since the last line
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last member, so that it starts after the others
};

void StatusLine::run() {
  using Clock = std::chrono::steady_clock;
  auto due = Clock::now() + std::chrono::seconds(1);
  bool is_said = false;
  while (!stopping_) {
    if (program::interrupted()) {
      source_.close();
      if (page_ != nullptr) page_->end();
    }
    if (Clock::now() >= due) {
      due += std::chrono::seconds(1);
      const std::string line = text();
      if (!quiet_) std::puts(printable(line).c_str());
      std::fflush(stdout);
      const bool is_waiting = line.rfind(kWaiting, 0) == 0 && line != kWaiting;
      if (quiet_ && is_waiting && !std::exchange(is_said, true)) warn(line);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

std::string StatusLine::text() {
  const std::lock_guard lock(mutex_);
  if (!last_) return kWaiting + describeWait(source_, pair_tolerance_s_, ros2_);
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

/// Frames of the sensors, with the messages of ROS 2 that were not used.
class LiveFrames : public run::SensorFrames {
 public:
  LiveFrames(io::LiveSource& source, const live::Ros2Connection* ros2)
      : SensorFrames(source), ros2_(ros2) {}

  [[nodiscard]] run::SourceReport report() const override {
    auto report = SensorFrames::report();
    if (ros2_ == nullptr || !report.skipped) return report;
    for (const auto& [reason, count] : ros2_->skipped()) (*report.skipped)[reason] += count;
    return report;
  }

 private:
  const live::Ros2Connection* ros2_;
};

/// Shows the figures of each frame on the page, under any load.
class PageSink : public run::Sink {
 public:
  PageSink(live::LivePage& page, const replay::Replay& run) : page_(page), run_(run) {}

  void onFrame(const run::FrameResult& result, pipeline::Perception& /*perception*/) override {
    live::LiveView view;
    view.update = result.update;
    view.arrival_s = result.arrival_s;
    view.latency_s = monotonicSeconds() - result.arrival_s;
    view.process_s = 1e-3 * run_.summary().last_frame_ms;
    view.frames = result.frames;
    view.dropped = result.source.dropped;
    view.left_out = result.left_out;
    view.warnings = run_.summary().warnings;
    page_.show(std::move(view));
  }

 private:
  live::LivePage& page_;
  const replay::Replay& run_;
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

/// Of drivers and topics; null: none.
std::vector<drivers::SensorStatus> statesOf(const drivers::SensorGroup* sensors,
                                            const live::Ros2Connection* ros2) {
  auto all = sensors != nullptr ? sensors->status() : std::vector<drivers::SensorStatus>();
  const auto topics = ros2 != nullptr ? ros2->sensors() : std::vector<drivers::SensorStatus>();
  all.insert(all.end(), topics.begin(), topics.end());
  return all;
}

void sayNetwork(const live::Ros2Connection& ros2, bool quiet) {
  if (!quiet) std::cout << ros2.network() << std::endl;
  if (quiet && !ros2.bufferHint().empty()) warn("ROS 2: " + ros2.bufferHint());
}

/// Stops a connection at the end of a scope, before what it uses ends.
std::shared_ptr<void> stopAtEnd(std::optional<live::Ros2Connection>& ros2) {
  return {nullptr, [&ros2](void*) {
            if (ros2) ros2->stop();
          }};
}

/// The same of drivers.
///
/// @param has_blocked  whether one's thread goes on
std::shared_ptr<void> stopAtEnd(std::unique_ptr<drivers::SensorGroup>& sensors, bool& has_blocked) {
  return {nullptr, [&](void*) {
            if (sensors) has_blocked = !sensors->stop();
          }};
}

/// Lets a page, if there is one, show the sensors until the end of a scope.
std::shared_ptr<void> watchUntilEnd(live::LivePage* page, live::SensorStates states) {
  if (page != nullptr) page->watch(std::move(states));
  return {nullptr, [page](void*) {
            if (page != nullptr) page->watch({});
          }};
}

/// Runs sensors and pipeline until they are interrupted.
///
/// @param has_blocked  becomes true if a driver's thread goes on after its end
void runLive(const LiveOptions& options, bool quiet, const pipeline::PerceptionParams& params,
             const Params& all_params, bool& has_blocked) {
  loadPlugins(options.plugins);
  std::optional<io::RawStereoCamera> calibration;
  if (!options.calibration.empty()) calibration = io::readRawCalibration(options.calibration);
  const auto recorder = makeRecorder(options);
  io::LiveSource source(sourceOptions(options, params));
  std::optional<live::Ros2Connection> ros2;
  const auto add = [&](const CObservation::Ptr& observation) {
    if (recorder) recorder->write(observation);
    source.push(observation);
    if (ros2) ros2->addObservation(*observation);
  };
  const auto deliver = [&](const CObservation::Ptr& observation) {
    if (calibration) calibrate(*calibration, options.run.sensor_label, *observation);
    add(observation);
  };
  const auto page = makePage(options);
  StatusLine status(quiet, source, page.get(), options.pair_tolerance_s);
  std::unique_ptr<drivers::SensorGroup> sensors;
  if (!options.sensors.empty()) sensors = makeSensors(options.sensors, deliver);
  const auto sensors_end = stopAtEnd(sensors, has_blocked);
  const auto recording_end = closeAtEnd(recorder.get());  // first: a driver may block
  const live::SensorStates states = [&] {
    return statesOf(sensors.get(), ros2 ? &*ros2 : nullptr);
  };
  if (options.ros2.isUsed()) {
    ros2.emplace(options.ros2, sensors != nullptr, options.calibration, options.pair_tolerance_s,
                 live::Ros2Connection::Callbacks{add, warn, states});
    sayNetwork(*ros2, quiet);
    ros2->start();
  }
  const auto before_sensors = stopAtEnd(ros2);  // of which it speaks
  const auto watching = watchUntilEnd(page.get(), states);
  live::Ros2Connection* topics = ros2 ? &*ros2 : nullptr;
  status.setTopics(topics);
  if (sensors && !program::interrupted()) sensors->start();
  if (!waitForCamera(source, options.pair_tolerance_s, topics)) {
    if (recorder) recorder->close();
    return;
  }
  replay::Replay pipeline(options.run, std::make_unique<LiveFrames>(source, topics), params,
                          all_params);
  const auto before_pipeline = stopAtEnd(ros2);  // which it uses
  if (!options.initial_pose.empty()) {
    pipeline.perception().setInitialPose(initialPoseOf(options.initial_pose));
  }
  if (ros2) ros2->setPerception(pipeline.perception());
  if (ros2) pipeline.add(ros2->sink());
  pipeline.add(status);
  std::optional<PictureSink> pictures;
  std::optional<PageSink> shown;
  if (page && options.show_port) pipeline.add(pictures.emplace(*page));
  if (page) pipeline.add(shown.emplace(*page, pipeline));
  pipeline.run();
  if (ros2) ros2->stop();
  if (recorder) recorder->close();
  if (!quiet) replay::printSummary(pipeline.summary());
}

}  // namespace

int main(int argc, char** argv) {
#ifdef __GLIBC__
  // A heap for each thread keeps what that thread has freed: after hours more than is in use.
  mallopt(M_ARENA_MAX, 2);
#endif
  bool has_blocked = false;
  const int status = program::run("headway-live", [&] {
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
    if (options.ros2.list) {
      std::cout << live::listOfTopics(options.ros2) << std::flush;
      return program::kDone;
    }
    options.run.quiet = line.quiet() || line.verbosity() > mrpt::system::LVL_INFO;
    options.run.debug = line.verbosity() == mrpt::system::LVL_DEBUG;
    options.run.input = options.record;
    options.run.is_live = true;
    check(options);
    if (!options.run.detector.empty()) params.detection.detector = options.run.detector;
    program::catchInterrupts();
    // A signal is the regular end: the exit status is 0, or 1 after an error.
    const std::shared_ptr<void> withdrawal(nullptr, [](void*) { requestStop(0); });
    runLive(options, line.quiet(), pipeline::PerceptionParams::live(params), all_params,
            has_blocked);
    return program::kDone;
  });
  if (!has_blocked) return status;
  std::fflush(nullptr);
  std::_Exit(status);  // exit() would destroy what the driver uses
}
