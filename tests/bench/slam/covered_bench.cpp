// SPDX-License-Identifier: BSD-3-Clause
// What a covered camera costs: the error of the motion across the gap, where wheel odometry alone
// tells of it.
//
//     bench_covered -i IN.rawlog [--seconds 5] [--set slam.key=value ...]
//
// A row for each time at which the camera is covered; the recording is tracked anew for each.

#include <headway/core/error.h>
#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "slam_bench_line.h"

namespace {

using namespace headway;

constexpr double kFirst = 3.0;  ///< from the start of the recording to the first cover [s]
constexpr double kStep = 3.0;   ///< between the starts of two covers [s]
constexpr double kAfter = 1.5;  ///< of the recording after the cover [s]

/// A recording's truth by time.
class Truth {
 public:
  explicit Truth(const std::string& rawlog) : poses_(io::readTruth(rawlog).poses) {
    if (poses_.empty()) throw InputError(rawlog + ": contains no truth_pose");
  }
  [[nodiscard]] const Pose& at(Time time) const {
    const auto after =
        std::lower_bound(poses_.begin(), poses_.end(), time - 1e-3,
                         [](const Stamped<Pose>& pose, Time limit) { return pose.time < limit; });
    return after == poses_.end() ? poses_.back().value : after->value;
  }
  [[nodiscard]] double way(Time from, Time to) const {
    double metres = 0.0;
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      if (poses_[i - 1].time < from - 1e-3 || poses_[i].time > to + 1e-3) continue;
      metres += (poses_[i].value.translation() - poses_[i - 1].value.translation()).norm();
    }
    return metres;
  }
  [[nodiscard]] Time begin() const { return poses_.front().time; }
  [[nodiscard]] Time end() const { return poses_.back().time; }

 private:
  std::vector<Stamped<Pose>> poses_;
};

struct Cost {
  Time before = 0.0;  ///< of the last tracked frame before the cover
  Time after = 0.0;   ///< of the first one after it
  double error_m = 0.0;
  double sigma_m = 0.0;  ///< of the position, as stated in the last covered frame
  std::size_t lost_after = 0;
};

/// Tracks the recording, covered from one time to another.
std::optional<Cost> cover(const std::string& rawlog, Time from, Time to, const Truth& truth,
                          const pipeline::PerceptionParams& settings) {
  io::RawlogSource source(rawlog, {});
  slam::StereoSlam slam(source.camera(), settings.slam);
  Cost cost;
  while (auto frame = source.next()) {
    if (!frame->stereo) continue;
    StereoFrame& stereo = *frame->stereo;
    if (stereo.time > to + kAfter) break;
    const bool is_covered = stereo.time >= from && stereo.time < to;
    if (is_covered) {
      stereo.left = cv::Mat(stereo.left.size(), stereo.left.type(), cv::Scalar::all(8));
      stereo.right = stereo.left.clone();
    }
    const auto update = slam.process(stereo, {});
    const bool is_tracked = update.status != slam::TrackingStatus::kLost;
    if (is_covered) cost.sigma_m = std::sqrt(update.covariance.diagonal().head<2>().maxCoeff());
    if (is_tracked && stereo.time < from) cost.before = stereo.time;
    if (is_tracked && stereo.time >= to && cost.after == 0.0) cost.after = stereo.time;
    cost.lost_after += !is_tracked && stereo.time >= to ? 1 : 0;
  }
  Pose T_map_before, T_map_after;
  slam.visitTrajectory([&](const slam::FrameEstimate& estimate) {
    if (estimate.time == cost.before) T_map_before = estimate.T_map_robot;
    if (estimate.time == cost.after) T_map_after = estimate.T_map_robot;
  });
  if (cost.before == 0.0 || cost.after == 0.0) return std::nullopt;
  const Pose estimated = T_map_before.inverse() * T_map_after;
  const Pose real = truth.at(cost.before).inverse() * truth.at(cost.after);
  cost.error_m = (estimated.translation() - real.translation()).norm();
  return cost;
}

int measure(int argc, const char* const* argv) {
  std::string input;
  double seconds = 5.0;
  SlamBenchLine bench("bench_covered", "Covers the camera of a recording for some seconds.");
  bench.line.option(input, 'i', "input", "IN.rawlog", "rawlog with stereo images", true);
  bench.line.option(seconds, 0, "seconds", "S", "duration of the cover");
  if (!bench.line.parse(argc, argv)) return program::kDone;
  const Truth truth(input);
  std::vector<double> percent;
  for (Time from = truth.begin() + kFirst; from + seconds + kAfter < truth.end(); from += kStep) {
    const auto cost = cover(input, from, from + seconds, truth, bench.settings);
    if (!cost) {
      std::printf("| %s | %.1f | – | – | – | – |\n", input.c_str(), from - truth.begin());
      continue;
    }
    const double way = truth.way(cost->before, cost->after);
    percent.push_back(100.0 * cost->error_m / way);
    std::printf("| %s | %.1f | %.2f | %.3f | %.2f | %.2f | %zu |\n", input.c_str(),
                from - truth.begin(), way, cost->error_m, percent.back(), cost->sigma_m,
                cost->lost_after);
    std::fflush(stdout);
  }
  if (!percent.empty()) {
    std::printf("%s: median %.2f %%, maximum %.2f %% of the way\n", input.c_str(),
                percentile(percent, 0.5), percentile(percent, 1.0));
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_covered", [&] { return measure(argc, argv); });
}
