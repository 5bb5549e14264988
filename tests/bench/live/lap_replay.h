// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stage_times.h>
#include <headway_test/textured_world.h>
#include <malloc.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <vector>

#include "replay.h"

namespace headway::bench {

/// Resident memory of this process [MB].
inline double residentMb() {
  std::ifstream pages("/proc/self/statm");
  double total = 0.0;
  double resident = 0.0;
  pages >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

/// Memory that the program has allocated [MB]: resident memory without the allocator's reserves.
inline double allocatedMb() {
  const auto heap = mallinfo2();
  return 1e-6 * static_cast<double>(heap.uordblks + heap.hblkhd);
}

/// Small stereo frames of a robot that drives to and fro in a room again and again, a little
/// differently in every second lap, and passes a pedestrian in each.
class LapInput : public run::Source {
 public:
  static constexpr std::size_t kLap = 100;  // frames

  explicit LapInput(std::size_t frames) : frames_(frames), room_(cameraOfLaps()) {
    room_.addRoom(12.0, 8.0, 4.0);
    for (std::size_t i = 0; i < 2 * kLap; ++i) laps_.push_back(room_.frame(i, 0.0, poseAt(i)));
  }

  [[nodiscard]] std::string name() const override { return "laps"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return room_.camera(); }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    auto frame = nextFrame();
    if (!frame) return std::nullopt;
    return LiveFrame{std::move(*frame), monotonicSeconds()};
  }
  [[nodiscard]] run::SourceReport report() const override {
    run::SourceReport report;
    report.skipped.emplace();
    return report;
  }

 private:
  static StereoCamera cameraOfLaps() {
    StereoCamera camera = test::smallCamera();
    camera.width /= 2;
    camera.height /= 2;
    camera.fx = camera.fy = 0.5 * camera.fx;
    camera.cx = 0.5 * camera.cx - 0.25;
    camera.cy = 0.5 * camera.cy - 0.25;
    return camera;
  }

  static Pose poseAt(std::size_t index) {
    const auto step = static_cast<double>(index % kLap);
    const bool is_second = index / kLap % 2 == 1;
    const double along = 0.5 - 0.5 * std::cos(2.0 * M_PI * step / kLap);
    Pose T_map_robot = Pose::Identity();
    T_map_robot.translation() << 2.0 * along, is_second ? 0.04 * std::sin(0.4 * step) : 0.0, 0.0;
    T_map_robot.linear() = expSo3({0.0, 0.0, 0.6 * along});
    return T_map_robot;
  }

  std::optional<RecordedFrame> nextFrame() {
    if (next_ == frames_) return std::nullopt;
    RecordedFrame frame;
    frame.index = next_++;
    frame.time = 0.1 * static_cast<double>(frame.index);
    frame.stereo = laps_[frame.index % laps_.size()];
    frame.stereo->index = frame.index;
    frame.stereo->time = frame.time;
    frame.detections.emplace();
    frame.detections->time = frame.time;
    const std::size_t step = frame.index % kLap;
    if (step > 20 && step < 60) frame.detections->items.push_back(pedestrianAt(step));
    return frame;
  }

  /// Crosses ahead of the robot, in the optical frame.
  static Detection pedestrianAt(std::size_t step) {
    Detection detection;
    detection.object_class = ObjectClass::kPedestrian;
    detection.score = 0.9;
    Box3d box;
    box.centre << -2.0 + 0.1 * static_cast<double>(step - 20), 0.0, 4.0;
    box.length = 0.8;
    box.width = 0.6;
    box.height = 1.75;
    detection.box3d = box;
    return detection;
  }

  std::size_t frames_;
  std::size_t next_ = 0;
  test::TexturedWorld room_;
  std::vector<StereoFrame> laps_;  ///< two laps
};

/// What several laps took, all read at their end.
struct LapFigures {
  std::size_t frames = 0;  ///< so far
  double resident_mb = 0.0;
  double allocated_mb = 0.0;
  double cpu_ms = 0.0;     ///< processor time of a frame of these laps, mean
  double median_ms = 0.0;  ///< process() of these laps
  double p99_ms = 0.0;
  std::size_t keyframes = 0;
  std::size_t landmarks = 0;
  std::size_t tracks = 0;  ///< confirmed so far
};

/// Reports figures after every so many frames.
class LapMeter : public run::Sink {
 public:
  LapMeter(std::size_t interval, const replay::Replay& run,
           std::function<void(const LapFigures&)> report)
      : interval_(interval), run_(run), report_(std::move(report)) {}

  void onFrame(const run::FrameResult& result, pipeline::Perception& perception) override {
    times_.add(run_.summary().last_frame_ms);
    if (result.frames % interval_ != 0) return;
    const auto& map = *perception.map().staticMap();
    const double cpu_ms =
        1e3 * (processorSeconds() - cpu_before_) / static_cast<double>(times_.count());
    report_({result.frames, residentMb(), allocatedMb(), cpu_ms, times_.percentile(0.5),
             times_.percentile(0.99), map.keyframes.size(), map.landmarks.size(),
             run_.summary().tracks_confirmed});
    times_ = Histogram();
    cpu_before_ = processorSeconds();
  }

 private:
  std::size_t interval_;
  const replay::Replay& run_;
  std::function<void(const LapFigures&)> report_;
  Histogram times_;
  double cpu_before_ = processorSeconds();
};

/// Runs the pipeline with all its files along laps, and reports figures after every `laps` laps.
inline void replayLaps(std::size_t frames, std::size_t laps, const std::string& folder,
                       const std::function<void(const LapFigures&)>& report) {
  replay::Options options;
  options.output = folder;
  options.overwrite = true;
  options.quiet = true;
  options.snapshots = 0;
  pipeline::PerceptionParams settings;
  settings.slam.features = 120;
  settings.slam.trajectory_in_memory = 1000;
  Params params;
  settings.describe(params);
  replay::Replay run(options, std::make_unique<LapInput>(frames), settings, params);
  LapMeter meter(laps * LapInput::kLap, run, report);
  run.add(meter);
  run.run();
}

}  // namespace headway::bench
