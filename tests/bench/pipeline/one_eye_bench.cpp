// SPDX-License-Identifier: BSD-3-Clause
// How soon it is noticed that one of two cameras fails, and how often it is said of a good pair.
//
//     bench_one_eye RAWLOG --width 640 [--width 320 ...] [--moments 10] [--good]
//
// Each rig fails for 1.5 s at several moments of a recording at which the robot moves. It is
// noticed if the images are doubted in all frames from a second after that moment (for most rigs
// from the first one) up to a second after its end. With --good nothing fails, and every doubted
// frame is a false alarm.

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
  std::vector<std::string> widths;
  int moments = 10;
  bool good = false;
};

/// Frames from which the robot moves for a second, evenly spread over the recording.
std::vector<std::size_t> momentsOf(const std::string& rawlog, const pipeline::Frames& frames,
                                   std::size_t second, int count) {
  const auto truth = io::readTruth(rawlog).poses;
  std::vector<std::size_t> moving;
  const std::size_t end = std::min(frames.size(), truth.size());
  for (std::size_t i = second; i + 4 * second < end; ++i) {
    const Pose step = truth[i].value.inverse(Eigen::Isometry) * truth[i + second].value;
    const double turn = Eigen::AngleAxisd(step.linear()).angle();
    if (step.translation().norm() > 0.2 || turn > 0.1) moving.push_back(i);
  }
  std::vector<std::size_t> moments;
  for (int i = 0; i < count && !moving.empty(); ++i) {
    moments.push_back(
        moving[static_cast<std::size_t>(i) * moving.size() / static_cast<std::size_t>(count)]);
  }
  return moments;
}

void tryRigs(const std::string& rawlog, int width, const Request& request) {
  const auto frames = pipeline::recordedFrames(rawlog, 100000, width);
  const double interval_s = frames[1].time - frames[0].time;
  const auto second = static_cast<std::size_t>(std::lround(1.0 / interval_s));
  const auto moments = momentsOf(rawlog, frames, second, request.moments);
  for (const pipeline::FailingRig& rig : pipeline::failingRigs()) {
    int named = 0, kept = 0;
    double slowest_s = 0.0;
    for (const std::size_t begin : moments) {
      const std::size_t end = begin + second + second / 2;
      const std::size_t from = begin - second;
      const pipeline::Frames part(
          frames.begin() + static_cast<std::ptrdiff_t>(from),
          frames.begin() + static_cast<std::ptrdiff_t>(end + second + second / 2));
      const auto doubted = pipeline::doubtedFrames(part, rig.fail, begin - from, end - from);
      const auto at = [&](std::size_t frame) {
        return doubted.begin() + static_cast<std::ptrdiff_t>(frame - from);
      };
      const auto noticed = std::find(at(begin), at(end), true);
      const double seconds = static_cast<double>(noticed - at(begin)) * interval_s;
      const bool is_named = noticed != at(end) && seconds <= 1.0 + 1e-6;
      named += is_named ? 1 : 0;
      if (is_named) slowest_s = std::max(slowest_s, seconds);
      kept += is_named && std::find(noticed, at(end + second - 1), false) == at(end + second - 1)
                  ? 1
                  : 0;
    }
    std::printf("%4d %-28s named %2d of %zu (slowest %.1f s), doubted to the end %2d\n", width,
                rig.name, named, moments.size(), slowest_s, kept);
  }
}

void countFalseAlarms(const std::string& rawlog, int width) {
  const auto frames = pipeline::recordedFrames(rawlog, 100000, width);
  const auto doubted = pipeline::doubtedFrames(frames, {}, frames.size(), frames.size());
  std::printf("%4d %zu good frames, %ld doubted\n", width, doubted.size(),
              static_cast<long>(std::count(doubted.begin(), doubted.end(), true)));
}

int measure(int argc, const char* const* argv) {
  Request request;
  program::CommandLine line("bench_one_eye", "How soon a failing camera is noticed.");
  line.positional(request.rawlog, "RAWLOG", "recording of a rig of two cameras");
  line.option(request.widths, 0, "width", "PX", "of the images; repeatable");
  line.option(request.moments, 0, "moments", "N", "at which a rig fails");
  line.flag(request.good, 0, "good", "nothing fails");
  if (!line.parse(argc, argv)) return program::kDone;
  for (const std::string& width : request.widths) {
    if (request.good) {
      countFalseAlarms(request.rawlog, std::stoi(width));
    } else {
      tryRigs(request.rawlog, std::stoi(width), request);
    }
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_one_eye", [&] { return measure(argc, argv); });
}
