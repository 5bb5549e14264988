// SPDX-License-Identifier: BSD-3-Clause
// Tracking of one recording after degradation: frames removed, blur, noise, darkness.
//
//     bench_degraded -i IN.rawlog [--only WORDS] [--set slam.key=value ...]
//
// A row for each way of spoiling it: frames tracked, and the error of their path. The whole
// recording is kept in memory.

#include <headway/core/error.h>

#include <cstdio>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "slam_bench_line.h"

namespace {

using namespace headway;
using Recording = std::vector<StereoFrame>;

/// A recording and its truth, both in order of time.
struct Drive {
  Recording frames;
  std::vector<Stamped<Pose>> truth;
};

using Spoil = std::function<Drive(const Drive&)>;

Drive everyNth(const Drive& drive, std::size_t n) {
  Drive result{{}, drive.truth};
  for (std::size_t i = 0; i < drive.frames.size(); i += n) result.frames.push_back(drive.frames[i]);
  return result;
}

/// Bursts of frames get lost, as on a busy network.
Drive inBursts(const Drive& drive) {
  Drive result{{}, drive.truth};
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    if (i % 10 < 6) result.frames.push_back(drive.frames[i]);
  }
  return result;
}

Drive backwards(const Drive& drive) {
  Drive result{{drive.frames.rbegin(), drive.frames.rend()},
               {drive.truth.rbegin(), drive.truth.rend()}};
  const Time sum = drive.frames.front().time + drive.frames.back().time;
  for (auto& frame : result.frames) frame.time = sum - frame.time;
  for (auto& pose : result.truth) pose.time = sum - pose.time;
  return result;
}

/// Every image changed separately; `change` receives the frame's number and whether it is the right
/// one.
Drive changed(const Drive& drive,
              const std::function<void(cv::Mat& image, std::size_t frame, bool right)>& change) {
  Drive result = drive;
  for (std::size_t i = 0; i < result.frames.size(); ++i) {
    for (const bool right : {false, true}) {
      cv::Mat& image = right ? result.frames[i].right : result.frames[i].left;
      image = image.clone();
      change(image, i, right);
    }
  }
  return result;
}

void addNoise(cv::Mat& image, double sigma, std::size_t seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  cv::Mat noise(image.size(), CV_16S), sum;
  random.fill(noise, cv::RNG::NORMAL, 0.0, sigma);
  cv::add(image, noise, sum, cv::noArray(), CV_16S);
  sum.convertTo(image, CV_8U);
}

Drive noisy(const Drive& drive, double sigma) {
  return changed(drive, [sigma](cv::Mat& image, std::size_t frame, bool right) {
    addNoise(image, sigma, 2 * frame + (right ? 1 : 0));
  });
}

/// Little light: reduced contrast, with the noise of the sensor.
Drive dark(const Drive& drive, double contrast) {
  return changed(drive, [contrast](cv::Mat& image, std::size_t frame, bool right) {
    image.convertTo(image, CV_8U, contrast, 10.0);
    addNoise(image, 2.0, 2 * frame + (right ? 1 : 0));
  });
}

/// Smeared along the rows, in some frames or in all.
Drive smeared(const Drive& drive, int width, std::size_t every) {
  return changed(drive, [=](cv::Mat& image, std::size_t frame, bool) {
    if (frame % every == every - 1) cv::blur(image, image, {width, 1});
  });
}

/// An exposure that jumps from frame to frame, and differs between the cameras.
Drive flickering(const Drive& drive) {
  return changed(drive, [](cv::Mat& image, std::size_t frame, bool right) {
    const double gain = (frame % 4 < 2 ? 0.6 : 1.3) * (right ? 0.85 : 1.0);
    image.convertTo(image, CV_8U, gain, frame % 3 == 0 ? 12.0 : 0.0);
  });
}

/// A hand before the camera: five frames in thirty show nothing.
Drive covered(const Drive& drive) {
  return changed(drive, [](cv::Mat& image, std::size_t frame, bool) {
    if (frame % 30 >= 20 && frame % 30 < 25) image.setTo(8);
  });
}

void printRow(const char* name, const Drive& drive, const pipeline::PerceptionParams& settings) {
  slam::StereoSlam slam(drive.frames.front().camera, settings.slam);
  std::size_t tracked = 0;
  for (const StereoFrame& frame : drive.frames) {
    tracked += slam.process(frame, {}).status == slam::TrackingStatus::kTracked ? 1 : 0;
  }
  const auto error = errorOf(slam.trajectory(), drive.truth);
  std::printf("| %s | %zu of %zu | ", name, tracked, drive.frames.size());
  error ? std::printf("%.4f |\n", error->ate_m.rmse) : std::printf("– |\n");
  std::fflush(stdout);
}

int measure(int argc, const char* const* argv) {
  std::string input, only;
  SlamBenchLine bench("bench_degraded", "Tracks a recording that is degraded in many ways.");
  bench.line.option(input, 'i', "input", "IN.rawlog", "rawlog with stereo images", true);
  bench.line.option(only, 0, "only", "WORDS", "of the ways, those whose name holds these words");
  if (!bench.line.parse(argc, argv)) return program::kDone;

  Drive drive{{}, io::readTruth(input).poses};
  io::RawlogSource source(input, {});
  while (auto frame = source.next()) {
    if (frame->stereo) drive.frames.push_back(*frame->stereo);
  }
  if (drive.frames.empty()) throw InputError(input + ": holds no stereo images");
  for (StereoFrame& frame : drive.frames) frame.motion_prior = {};

  const std::vector<std::pair<const char*, Spoil>> ways = {
      {"as recorded", [](const Drive& d) { return d; }},
      {"every 2nd frame", [](const Drive& d) { return everyNth(d, 2); }},
      {"every 3rd frame", [](const Drive& d) { return everyNth(d, 3); }},
      {"every 4th frame", [](const Drive& d) { return everyNth(d, 4); }},
      {"4 of 10 frames lost in bursts", inBursts},
      {"backwards", backwards},
      {"half the contrast", [](const Drive& d) { return dark(d, 0.5); }},
      {"a fifth of the contrast", [](const Drive& d) { return dark(d, 0.2); }},
      {"a tenth of the contrast", [](const Drive& d) { return dark(d, 0.1); }},
      {"noise of 5 grey values", [](const Drive& d) { return noisy(d, 5.0); }},
      {"noise of 15 grey values", [](const Drive& d) { return noisy(d, 15.0); }},
      {"every 5th frame smeared by 15 px", [](const Drive& d) { return smeared(d, 15, 5); }},
      {"all frames smeared by 9 px", [](const Drive& d) { return smeared(d, 9, 1); }},
      {"all frames smeared by 21 px", [](const Drive& d) { return smeared(d, 21, 1); }},
      {"exposure jumps", flickering},
      {"covered at times", covered},
  };
  std::printf("| %s | tracked | ATE RMSE m |\n| --- | --- | --- |\n", input.c_str());
  for (const auto& [name, spoil] : ways) {
    if (std::string(name).find(only) == std::string::npos) continue;
    printRow(name, spoil(drive), bench.settings);
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_degraded", [&] { return measure(argc, argv); });
}
