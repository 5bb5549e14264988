// SPDX-License-Identifier: BSD-3-Clause
// How surely and how well a camera is found again in a stored map.
//
//     bench_relocalisation --map MAP.rawlog --map-to N --restart OTHER.rawlog ... [--restart-from
//     N]
//         [--places 20] [--seed 1] [--seconds 3] [--mapped] [--elsewhere ANOTHER_WORLD.rawlog ...]
//
// MAP is mapped up to frame N. The camera then restarts at random frames of OTHER, a recording in
// the same frame of truth (it may be the rest of MAP, or MAP with people before the camera), with
// nothing but the stored map, which it does not extend; a start counts as found if a frame of its
// first seconds is. Two errors of that frame: within the map, where the truth is taken from the
// nearest mapped frame; and against the truth without any alignment, which has the map's own drift
// in it. A start that is found more than 0.5 m from its place in the map is wrong.
// With --mapped they begin where a mapped frame was taken within 0.5 m and 20 degrees: robots that
// meet other people drive elsewhere. Starts in ANOTHER_WORLD must not be found.

#include <headway/core/error.h>
#include <headway/core/statistics.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>

#include "slam_bench_line.h"

namespace {

using namespace headway;

constexpr double kRight_m = 0.5;  // of the right place
constexpr double kSameView_rad = 20.0 * kDegree;

struct Request {
  std::string map;
  std::vector<std::string> restart, elsewhere;
  double seconds = 3.0;
  std::optional<std::size_t> map_to, restart_from;
  int places = 20;
  int seed = 1;
  bool mapped = false;
};

struct Start {
  std::size_t first = 0;            ///< frame of the rawlog that the camera starts at
  std::optional<std::size_t> took;  ///< frames until it was found; empty: not found
  double in_map_m = 0.0;            ///< error within the map
  double in_truth_m = 0.0;          ///< error against the truth
};

/// Truth in the frame of the robot's first pose, one pose a frame.
std::vector<Stamped<Pose>> truthOf(const std::string& rawlog) {
  auto poses = io::readTruth(rawlog).poses;
  if (poses.empty()) throw InputError(rawlog + ": holds no truth_pose");
  const Pose T_first_world = poses.front().value.inverse(Eigen::Isometry);
  for (auto& pose : poses) pose.value = T_first_world * pose.value;
  return poses;
}

/// The pose with the time nearest to a given one.
const Pose& poseAt(Time time, const std::vector<Stamped<Pose>>& poses) {
  const auto nearer = [time](const auto& a, const auto& b) {
    return std::abs(a.time - time) < std::abs(b.time - time);
  };
  return std::min_element(poses.begin(), poses.end(), nearer)->value;
}

/// A stored map and where its frames were.
struct MappedPlace {
  std::string slam_map;
  std::vector<slam::FrameEstimate> frames;
  std::vector<Stamped<Pose>> truth;

  /// A place of the truth from where a mapped frame was taken.
  [[nodiscard]] Pose seenFrom(const slam::FrameEstimate& frame, const Pose& T_truth_robot) const {
    return poseAt(frame.time, truth).inverse(Eigen::Isometry) * T_truth_robot;
  }

  /// Whether a mapped frame was taken there.
  [[nodiscard]] bool shows(const Pose& T_truth_robot) const {
    return std::any_of(frames.begin(), frames.end(), [&](const auto& frame) {
      const Pose T = seenFrom(frame, T_truth_robot);
      return T.translation().norm() <= kRight_m &&
             Eigen::AngleAxisd(T.linear()).angle() <= kSameView_rad;
    });
  }

  /// Where in the map a place of the truth is: as seen from the mapped frame next to it.
  [[nodiscard]] Pose inMap(const Pose& T_truth_robot) const {
    const auto distance = [&](const slam::FrameEstimate& frame) {
      constexpr double kMetresARadian = 5.0;
      const Pose T = seenFrom(frame, T_truth_robot);
      return T.translation().norm() + kMetresARadian * Eigen::AngleAxisd(T.linear()).angle();
    };
    const auto next =
        std::min_element(frames.begin(), frames.end(),
                         [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    return next->T_map_robot * seenFrom(*next, T_truth_robot);
  }
};

MappedPlace mapPlace(const Request& request, const pipeline::PerceptionParams& settings) {
  io::RawlogSourceOptions options;
  options.to_index = request.map_to;
  io::RawlogSource source(request.map, options);
  pipeline::Perception perception(source.camera(), settings);
  while (auto frame = source.next()) {
    static_cast<void>(perception.process(*frame));
  }
  const auto& static_map = *perception.map().staticMap();
  std::printf("map: %zu keyframes, %zu landmarks\n", static_map.keyframes.size(),
              static_map.landmarks.size());
  return {collected(perception.stored().made_attachments.at("slam")), perception.trajectory(),
          truthOf(request.map)};
}

/// Random frames of a recording, ascending, some of those from which a start may begin.
std::vector<std::size_t> drawStarts(const std::vector<std::size_t>& allowed,
                                    const Request& request) {
  if (allowed.empty()) throw InputError("the recording has no frame to start at");
  std::mt19937 random(static_cast<unsigned>(request.seed));
  std::vector<std::size_t> starts;
  for (int i = 0; i < request.places; ++i) starts.push_back(allowed[random() % allowed.size()]);
  std::sort(starts.begin(), starts.end());
  return starts;
}

/// A camera that starts in a stored map.
struct RestartedCamera {
  Start start;
  std::unique_ptr<slam::StereoSlam> slam;
};

std::vector<Start> restart(const std::string& rawlog, std::size_t from, const Request& request,
                           const MappedPlace& place, slam::SlamParams params) {
  const auto truth = truthOf(rawlog);
  const double frames_a_second = static_cast<double>(truth.size() - 1) /
                                 std::max(1e-3, truth.back().time - truth.front().time);
  const auto frames_a_start =
      static_cast<std::size_t>(std::lround(request.seconds * frames_a_second)) + 1;
  std::vector<std::size_t> allowed;
  for (std::size_t i = from; i + frames_a_start <= truth.size(); ++i) {
    if (!request.mapped || place.shows(truth[i].value)) allowed.push_back(i);
  }
  const auto firsts = drawStarts(allowed, request);
  params.mapping = false;
  io::RawlogSourceOptions options;
  options.from_index = firsts.front();
  options.to_index = firsts.back() + frames_a_start - 1;
  io::RawlogSource source(rawlog, options);
  std::vector<RestartedCamera> cameras;
  while (auto frame = source.next()) {
    while (cameras.size() < firsts.size() && firsts[cameras.size()] <= frame->index) {
      cameras.emplace_back();
      cameras.back().start.first = firsts[cameras.size() - 1];
      cameras.back().slam = std::make_unique<slam::StereoSlam>(source.camera(), params);
      cameras.back().slam->load(place.slam_map);
    }
    for (auto& [start, slam] : cameras) {
      if (slam == nullptr) continue;
      const auto update = slam->process(*frame->stereo, {});
      const std::size_t frames = frame->index - start.first + 1;
      if (slam::isTracked(update.status)) {
        const Pose& T_truth_robot = poseAt(frame->time, truth);
        const Eigen::Vector3d found = update.T_map_robot.translation();
        start.took = frames;
        start.in_map_m = (found - place.inMap(T_truth_robot).translation()).norm();
        start.in_truth_m = (found - T_truth_robot.translation()).norm();
      }
      if (start.took || frames >= frames_a_start) slam.reset();
    }
  }
  std::vector<Start> starts;
  for (const auto& camera : cameras) starts.push_back(camera.start);
  return starts;
}

void print(const std::string& title, const std::vector<Start>& starts) {
  std::vector<double> in_map, in_truth;
  for (const Start& start : starts) {
    if (!start.took) {
      std::printf("  frame %zu: not found\n", start.first);
      continue;
    }
    in_map.push_back(start.in_map_m);
    in_truth.push_back(start.in_truth_m);
    std::printf(
        "  frame %zu: found at frame %zu of the start, %.3f m off in the map, %.3f m off "
        "the truth\n",
        start.first, *start.took, start.in_map_m, start.in_truth_m);
  }
  const auto close = std::count_if(in_map.begin(), in_map.end(), [](double m) { return m <= 0.1; });
  const auto wrong =
      std::count_if(in_map.begin(), in_map.end(), [](double m) { return m > kRight_m; });
  std::printf(
      "%s: %zu of %zu found, %zu of them wrong, %zu within 0.1 m in the map (median %.3f m, max "
      "%.3f "
      "m); off the truth median %.3f m, max %.3f m\n",
      title.c_str(), in_map.size(), starts.size(), static_cast<std::size_t>(wrong),
      static_cast<std::size_t>(close), percentile(in_map, 0.5), percentile(in_map, 1.0),
      percentile(in_truth, 0.5), percentile(in_truth, 1.0));
}

int measure(int argc, const char* const* argv) {
  Request request;
  SlamBenchLine bench("bench_relocalisation", "Starts a camera at random in a stored map.");
  auto& line = bench.line;
  line.option(request.map, 0, "map", "MAP.rawlog", "recording to map", true);
  line.option(request.map_to, 0, "map-to", "N", "last frame to map");
  line.option(request.restart, 0, "restart", "OTHER.rawlog", "recording to start in; repeatable");
  line.option(request.restart_from, 0, "restart-from", "N", "first frame to start at");
  line.option(request.elsewhere, 0, "elsewhere", "RAWLOG",
              "recording of another world; repeatable");
  line.option(request.seconds, 0, "seconds", "S", "that a start may take");
  line.option(request.places, 0, "places", "N", "starts to try");
  line.option(request.seed, 0, "seed", "N", "of the choice of starts");
  line.flag(request.mapped, 0, "mapped", "start where a mapped frame was taken");
  if (!line.parse(argc, argv)) return program::kDone;
  if (request.places < 1) throw program::UsageError("--places must be at least 1");

  const MappedPlace place = mapPlace(request, bench.settings);
  const std::size_t from = request.restart_from.value_or(0);
  for (const std::string& same : request.restart) {
    print(same, restart(same, from, request, place, bench.settings.slam));
  }
  for (const std::string& other : request.elsewhere) {
    print(other + " (another world)", restart(other, 0, request, place, bench.settings.slam));
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_relocalisation", [&] { return measure(argc, argv); });
}
