// SPDX-License-Identifier: BSD-3-Clause
// How soon it is noticed that one of two cameras fails, and how often it is said of a good pair.
//
//     bench_one_eye RAWLOG --width 640 [--width 320 ...] [--moments 10] [--seconds 1.5]
//                   [--rig RightLate ...] [--odometry] [--every N] [--good]
//
// Each rig fails for some seconds at several moments of a recording at which the robot moves. It is
// named if a finding about the images says so within a second. Without a pose "to the end" is a rig
// none of whose poses counts from then on up to a second after the end; with one "later", 2.5 s
// after it. With --good nothing fails, and each frame that such a finding doubts is a false alarm.

#include <headway/program/command_line.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "failing_rig.h"

namespace {

using namespace headway;

struct Request {
  std::string rawlog;
  std::vector<std::string> widths, rigs;
  int moments = 10;
  double seconds = 1.5;
  int every = 1;
  bool odometry = false;
  bool good = false;
};

/// Every Nth frame of the recording, with the odometry of wheels that err by nothing or without.
pipeline::Frames framesOf(const Request& request, int width) {
  const auto all = pipeline::recordedFrames(request.rawlog, 100000, width);
  const auto truth = io::readTruth(request.rawlog).poses;
  pipeline::Frames frames;
  std::size_t before = 0;
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(request.every)) {
    frames.push_back(all[i]);
    frames.back().index = frames.size() - 1;
    auto& prior = frames.back().stereo->motion_prior;
    prior = {};
    if (request.odometry && i > 0 && i < truth.size()) {
      prior.T_previous_current = truth[before].value.inverse(Eigen::Isometry) * truth[i].value;
    }
    before = i;
  }
  return frames;
}

/// Whether one of a frame's findings is about its images.
bool isAboutImages(const std::string& findings) {
  for (const char* name : {"one_image", "camera_frozen", "images_", "vertical_offset"}) {
    if (findings.find(name) != std::string::npos) return true;
  }
  return false;
}

/// Frames from which the robot moves for a second, evenly spread over the recording.
std::vector<std::size_t> momentsOf(const Request& request, const pipeline::Frames& frames,
                                   std::size_t second, std::size_t length) {
  const auto truth = io::readTruth(request.rawlog).poses;
  const auto every = static_cast<std::size_t>(request.every);
  std::vector<std::size_t> moving;
  for (std::size_t i = second; i + length < frames.size() && (i + second) * every < truth.size();
       ++i) {
    const Pose step =
        truth[i * every].value.inverse(Eigen::Isometry) * truth[(i + second) * every].value;
    const double turn = Eigen::AngleAxisd(step.linear()).angle();
    if (step.translation().norm() > 0.2 || turn > 0.1) moving.push_back(i);
  }
  std::vector<std::size_t> moments;
  for (int i = 0; i < request.moments && !moving.empty(); ++i) {
    moments.push_back(moving[static_cast<std::size_t>(i) * moving.size() /
                             static_cast<std::size_t>(request.moments)]);
  }
  return moments;
}

void tryRig(const pipeline::FailingRig& rig, const pipeline::Frames& frames, int width,
            const Request& request) {
  const double interval_s = frames[1].time - frames[0].time;
  const auto second = static_cast<std::size_t>(std::lround(1.0 / interval_s));
  const auto failing = static_cast<std::size_t>(std::lround(request.seconds / interval_s));
  const std::size_t after = 5 * second / 2;
  const auto moments = momentsOf(request, frames, second, failing + after);
  int named = 0, kept = 0, recovered = 0;
  double slowest_s = 0.0;
  for (const std::size_t begin : moments) {
    const std::size_t end = begin + failing;
    const std::size_t from = begin - std::min(begin, 3 * second);
    const pipeline::Frames part(frames.begin() + static_cast<std::ptrdiff_t>(from),
                                frames.begin() + static_cast<std::ptrdiff_t>(end + after));
    const auto seen = pipeline::noticed(part, rig.fail, begin - from, end - from);
    std::size_t first = begin;
    while (first < end && !isAboutImages(seen.findings[first - from])) ++first;
    const double seconds = static_cast<double>(first - begin) * interval_s;
    if (first < end && seconds <= 1.0 + 1e-6) {
      ++named;
      slowest_s = std::max(slowest_s, seconds);
    }
    bool is_doubted = true;
    for (std::size_t i = begin + second; i + 1 < end + second; ++i) {
      is_doubted = is_doubted && seen.doubted[i - from];
    }
    kept += is_doubted ? 1 : 0;
    recovered += seen.doubted.back() ? 0 : 1;
  }
  std::printf("%4d %-26s named %2d of %zu (slowest %.1f s), no pose to the end %2d, later %2d\n",
              width, rig.name, named, moments.size(), slowest_s, kept, recovered);
  std::fflush(stdout);
}

void countFalseAlarms(const pipeline::Frames& frames, int width) {
  const auto seen = pipeline::noticed(frames, {}, frames.size(), frames.size());
  const auto alarms = std::count_if(seen.findings.begin(), seen.findings.end(), isAboutImages);
  for (std::size_t i = 0; i < seen.findings.size(); ++i) {
    if (isAboutImages(seen.findings[i])) std::printf("  %zu: %s\n", i, seen.findings[i].c_str());
  }
  const auto lost = std::count(seen.doubted.begin(), seen.doubted.end(), true);
  std::printf("%4d %zu good frames, %ld with an alarm, %ld without a pose\n", width,
              seen.findings.size(), static_cast<long>(alarms), static_cast<long>(lost));
}

int measure(int argc, const char* const* argv) {
  Request request;
  program::CommandLine line("bench_one_eye", "How soon a failing camera is noticed.");
  line.positional(request.rawlog, "RAWLOG", "recording of a rig of two cameras");
  line.option(request.widths, 0, "width", "PX", "of the images; repeatable");
  line.option(request.moments, 0, "moments", "N", "at which a rig fails");
  line.option(request.seconds, 0, "seconds", "S", "for which a rig fails");
  line.option(request.rigs, 0, "rig", "NAME", "of those that fail; repeatable");
  line.option(request.every, 0, "every", "N", "takes every Nth frame");
  line.flag(request.odometry, 0, "odometry", "with wheel odometry, of the truth");
  line.flag(request.good, 0, "good", "nothing fails");
  if (!line.parse(argc, argv)) return program::kDone;
  for (const std::string& text : request.widths) {
    const int width = std::stoi(text);
    const auto frames = framesOf(request, width);
    if (request.good) countFalseAlarms(frames, width);
    for (const pipeline::FailingRig& rig : pipeline::failingRigs()) {
      const bool is_asked =
          request.rigs.empty() ||
          std::find(request.rigs.begin(), request.rigs.end(), rig.name) != request.rigs.end();
      if (is_asked && !request.good) tryRig(rig, frames, width, request);
    }
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_one_eye", [&] { return measure(argc, argv); });
}
