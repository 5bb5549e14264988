// SPDX-License-Identifier: BSD-3-Clause
// Recall and precision of a detector of moving objects in simulated worlds, from images alone.
//
//     headway-sim -c WORLD.ini -o WORLD.rawlog
//     bench_moving_objects WORLD.rawlog... [range=rig] [list] [frames=FIRST-LAST]
//                          [section.key=value ...]
//
// The whole pipeline runs on the images (SLAM's own poses), by default with stereo_motion. The
// reference is, in every frame, the true objects within 25 m that move faster than 0.8 m/s and are
// at least half visible. A detection is correct if its centre is within 1 m plus half the object's
// length, one detection per object. A detection within 25 m without an object faster than 0.3 m/s,
// or a second one of the same object, is false. With range=rig the reference is what the rig
// promises: objects faster than 0.5 m/s from 0.5 m to the rig's reach for people or vehicles, whose
// centre is inside the image from left to right: the ratio in the truth is that of the part inside.
// `list` prints a line for each observation: missed and found objects, and false detections.

#include <headway/core/assignment.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/pipeline/perception.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

using headway::Box3d;
using headway::ObjectClass;

constexpr double kTurnRate_radps = 0.35;  // of a robot that turns on the spot, at least
constexpr double kTurnSpeed_mps = 0.15;   // and at most
constexpr double kStatic_mps = 0.3;
constexpr double kVisible = 0.5;
constexpr double kNear = 1.0;

/// What is evaluated.
struct Limits {
  double min_range = 0.0;       ///< [m]
  double people_range = 25.0;   ///< [m]
  double vehicle_range = 25.0;  ///< [m]
  double min_speed = 0.8;       ///< [m/s]
  /// Of centres to the left and right, tangent of the angle to the optical axis; 0: not tested.
  double max_left = 0.0;
  double max_right = 0.0;

  [[nodiscard]] double rangeOf(ObjectClass object_class) const {
    const bool vehicle = object_class == ObjectClass::kCar || object_class == ObjectClass::kVan ||
                         object_class == ObjectClass::kTruck || object_class == ObjectClass::kTram;
    return vehicle ? vehicle_range : people_range;
  }
};

Limits limitsOf(const headway::stereo::RigCapability& rig, const headway::StereoCamera& camera) {
  return {0.5, rig.people_to_m,       rig.vehicles_to_m,
          0.5, camera.cx / camera.fx, (camera.width - 1.0 - camera.cx) / camera.fx};
}

/// A true object in one frame.
struct Truth {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< right and forward of the camera [m]
  double length = 0.0;
  double speed = 0.0;
  double visible = 0.0;

  [[nodiscard]] bool isEvaluated(const Limits& limits) const {
    const double range = place.norm();
    return range >= limits.min_range && range < limits.rangeOf(object_class) &&
           speed > limits.min_speed && visible >= kVisible &&
           (limits.max_left <= 0.0 ||
            (place.x() > -limits.max_left * place.y() && place.x() < limits.max_right * place.y()));
  }
};

using TruthByFrame = std::map<std::size_t, std::vector<Truth>>;

TruthByFrame readTruth(const std::filesystem::path& folder) {
  std::map<std::pair<std::size_t, std::int64_t>, double> speeds;
  for (const auto& sample : headway::io::readTrackCsv(folder / "objects.csv")) {
    speeds[{sample.frame, sample.track.id.value}] = sample.track.velocity.norm();
  }
  TruthByFrame frames;
  for (const auto& row : headway::io::readKittiRows(folder / "label_02.txt")) {
    const auto detection = headway::io::detectionFrom(row);
    if (!detection || !detection->box3d) continue;
    const auto& centre = detection->box3d->centre;
    frames[row.frame].push_back({row.id,
                                 detection->object_class,
                                 {centre.x(), centre.z()},
                                 detection->box3d->length,
                                 speeds[{row.frame, row.id}],
                                 row.visible});
  }
  return frames;
}

/// An object that the pipeline reports in one frame.
struct Reported {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  ///< right and forward of the camera [m]
  ObjectClass object_class = ObjectClass::kUnknown;
  double speed = 0.0;                   ///< [m/s]
  headway::Box2d box2d;                 ///< of detections [px]
  headway::DetectionEvidence evidence;  ///< of detections
};
using Places = std::vector<Reported>;

Places detectionsOf(const headway::pipeline::PerceptionUpdate& update) {
  Places places;
  if (!update.detections) return places;
  for (const auto& item : update.detections->items) {
    if (!item.box3d) continue;
    places.push_back({{item.box3d->centre.x(), item.box3d->centre.z()},
                      item.object_class,
                      item.velocity ? item.velocity->value.norm() : 0.0,
                      item.box2d.value_or(headway::Box2d()),
                      item.evidence});
  }
  return places;
}

Places movingTracksOf(const headway::pipeline::PerceptionUpdate& update,
                      const headway::Pose& T_robot_cam) {
  Places places;
  const headway::Pose T_cam_map = (update.camera.T_map_robot * T_robot_cam).inverse();
  for (const auto& track : update.objects.tracks) {
    if (track.status != headway::TrackStatus::kConfirmed || !isMoving(track)) continue;
    const Eigen::Vector3d centre = T_cam_map * track.position;
    places.push_back(
        {{centre.x(), centre.z()}, track.object_class, track.velocity.head<2>().norm(), {}, {}});
  }
  return places;
}

struct Ratio {
  int found = 0;
  int all = 0;
  void add(bool hit) {
    ++all;
    found += hit ? 1 : 0;
  }
  [[nodiscard]] double percent() const { return all > 0 ? 100.0 * found / all : 0.0; }
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// A line for each evaluated object and each false detection.
class Listing {
 public:
  explicit Listing(const char* what) : what_(what) {}

  void object(std::size_t frame, const Truth& truth, const Reported* found) const {
    std::printf("%s %zu %s object %lld %s at %.2f %.2f m, %.2f m/s, visible %.2f", what_, frame,
                found != nullptr ? "found" : "missed", static_cast<long long>(truth.id),
                std::string(toString(truth.object_class)).c_str(), truth.place.x(), truth.place.y(),
                truth.speed, truth.visible);
    if (found != nullptr) {
      const headway::Box2d& box = found->box2d;
      std::printf(", measured %.2f m/s at %.2f %.2f m, box %.0f %.0f %.0f %.0f%s", found->speed,
                  found->place.x(), found->place.y(), box.left, box.top, box.right, box.bottom,
                  by(*found));
    }
    std::printf("\n");
  }
  void wrong(std::size_t frame, const Reported& report, bool turning) const {
    const headway::Box2d& box = report.box2d;
    std::printf("%s %zu false %s at %.2f %.2f m, %.2f m/s, box %.0f %.0f %.0f %.0f%s%s\n", what_,
                frame, std::string(toString(report.object_class)).c_str(), report.place.x(),
                report.place.y(), report.speed, box.left, box.top, box.right, box.bottom,
                by(report), turning ? ", turning" : "");
  }

 private:
  static const char* by(const Reported& report) {
    return report.evidence.motion       ? ", by motion"
           : report.evidence.appearance ? ", by appearance"
                                        : "";
  }
  const char* what_;
};

class Score {
 public:
  /// @param listing  null: nothing is printed
  void evaluate(std::size_t frame, const Listing* listing, const std::vector<Truth>& truth,
                const Places& detections, const Limits& limits, bool turning) {
    std::vector<headway::CandidatePair> candidates;
    for (std::size_t t = 0; t < truth.size(); ++t) {
      for (std::size_t r = 0; r < detections.size(); ++r) {
        const double off = (truth[t].place - detections[r].place).norm();
        const bool moves = truth[t].speed > kStatic_mps;
        if (moves && off < kNear + 0.5 * truth[t].length) candidates.push_back({t, r, off});
      }
    }
    std::map<std::size_t, const Reported*> hit;
    std::vector<bool> right(detections.size(), false);
    for (const auto& pair : headway::assignPairs(std::move(candidates))) {
      hit[pair.row] = &detections[pair.column];
      right[pair.column] = true;
      if (truth[pair.row].isEvaluated(limits)) {
        speed_errors_.push_back(std::abs(detections[pair.column].speed - truth[pair.row].speed));
      }
    }
    turning_frames_ += turning ? 1 : 0;
    for (std::size_t r = 0; r < detections.size(); ++r) {
      const double range = detections[r].place.norm();
      if (range >= limits.rangeOf(detections[r].object_class)) continue;
      precision_.add(right[r]);
      false_while_turning_ += turning && !right[r] ? 1 : 0;
      if (listing != nullptr && !right[r]) listing->wrong(frame, detections[r], turning);
    }
    for (std::size_t t = 0; t < truth.size(); ++t) {
      if (!truth[t].isEvaluated(limits)) continue;
      count(truth[t], hit.count(t) > 0);
      if (listing != nullptr) listing->object(frame, truth[t], hit[t]);
    }
  }

  void endWorld() {
    for (const auto& [id, ratio] : objects_) {
      mostly_.add(ratio.percent() >= 50.0);
      ever_.add(ratio.found > 0);
    }
    objects_.clear();
  }

  void print(const char* what) const {
    std::printf(
        "\n%s: recall %.1f %% of %d observations, precision %.1f %% of %d detections; of %d "
        "objects %.0f %% found in half of their observations, %.0f %% at all\n",
        what, recall_.percent(), recall_.all, precision_.percent(), precision_.all, mostly_.all,
        mostly_.percent(), ever_.percent());
    std::printf(
        "  median error of the speed %.2f m/s; %d false in %d frames of turns on the spot\n",
        median(speed_errors_), false_while_turning_, turning_frames_);
    for (const auto& [group, ratio] : groups_) {
      std::printf("  %-28s %5.1f %% of %d\n", group.c_str(), ratio.percent(), ratio.all);
    }
  }

 private:
  void count(const Truth& truth, bool hit) {
    recall_.add(hit);
    auto& object = objects_[truth.id];
    const int age = object.all;
    object.add(hit);
    const double range = truth.place.norm();
    groups_["class " + std::string(toString(truth.object_class))].add(hit);
    groups_[range < 2    ? "range  0- 2 m"
            : range < 4  ? "range  2- 4 m"
            : range < 7  ? "range  4- 7 m"
            : range < 10 ? "range  7-10 m"
            : range < 15 ? "range 10-15 m"
            : range < 20 ? "range 15-20 m"
                         : "range 20-25 m"]
        .add(hit);
    groups_[age < 5    ? "observation 1-5"
            : age < 15 ? "observation 6-15"
                       : "observation 16 and later"]
        .add(hit);
    groups_[truth.speed < 0.8   ? "speed 0.5-0.8 m/s"
            : truth.speed < 1.5 ? "speed 0.8-1.5 m/s"
            : truth.speed < 3   ? "speed 1.5-3 m/s"
                                : "speed over 3 m/s"]
        .add(hit);
    groups_[truth.visible < 0.75 ? "visible 50-75 %" : "visible 75-100 %"].add(hit);
  }

  Ratio recall_, precision_, mostly_, ever_;
  std::vector<double> speed_errors_;  ///< of evaluated objects that were found [m/s]
  int turning_frames_ = 0;
  int false_while_turning_ = 0;
  std::map<std::string, Ratio> groups_;
  std::map<std::int64_t, Ratio> objects_;  ///< of the current world
};

/// Whether the robot turns on the spot, by its poses.
class TurnDetector {
 public:
  bool isTurning(headway::Time time, const headway::Pose& T_map_robot) {
    const double seconds = time - time_;
    const headway::Pose motion = T_before_.inverse() * T_map_robot;
    const bool known = seconds > 0.0 && seconds < 1.0;
    time_ = time;
    T_before_ = T_map_robot;
    return known && Eigen::AngleAxisd(motion.linear()).angle() > kTurnRate_radps * seconds &&
           motion.translation().norm() < kTurnSpeed_mps * seconds;
  }

 private:
  headway::Time time_ = 0.0;
  headway::Pose T_before_ = headway::Pose::Identity();
};

void runWorld(const std::string& rawlog, const headway::io::RawlogSourceOptions& options,
              const headway::pipeline::PerceptionParams& params, bool range_of_rig, bool list,
              Score& detections, Score& tracks) {
  const auto truth = readTruth(std::filesystem::path(rawlog).replace_extension(".truth"));
  headway::io::RawlogSource source(rawlog, options);
  headway::pipeline::Perception perception(source.camera(), params);
  const Limits limits = range_of_rig ? limitsOf(*perception.rig(), *source.camera()) : Limits();
  const Listing detection_list("detection"), track_list("track");
  TurnDetector turns;
  headway::DropCounts dropped;
  while (auto frame = source.next()) {
    frame->detections.reset();  // of the simulated detector
    const auto update = perception.process(*frame);
    for (const auto& [reason, count] : update.objects.detections_dropped) dropped[reason] += count;
    const auto found = truth.find(frame->index);
    const auto objects = found != truth.end() ? found->second : std::vector<Truth>();
    const bool turning = turns.isTurning(update.time, update.camera.T_map_robot);
    detections.evaluate(frame->index, list ? &detection_list : nullptr, objects,
                        detectionsOf(update), limits, turning);
    tracks.evaluate(frame->index, list ? &track_list : nullptr, objects,
                    movingTracksOf(update, source.camera()->T_robot_cam), limits, turning);
  }
  detections.endWorld();
  tracks.endWorld();
  std::printf("%s:", rawlog.c_str());
  for (const auto& [reason, count] : dropped) std::printf(" %s %zu", reason.c_str(), count);
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  headway::pipeline::PerceptionParams params;
  params.detection.detector = "stereo_motion";
  headway::Params registry;
  params.describe(registry);
  Score detections, tracks;
  headway::io::RawlogSourceOptions options;
  bool range_of_rig = false, list = false;
  try {
    std::vector<std::string> rawlogs;
    for (int i = 1; i < argc; ++i) {
      const std::string argument = argv[i];
      std::size_t last = 0;
      if (std::sscanf(argument.c_str(), "frames=%zu-%zu", &options.from_index, &last) == 2) {
        options.to_index = last;
      } else if (argument == "range=rig") {
        range_of_rig = true;
      } else if (argument == "list") {
        list = true;
      } else if (argument.find('=') != std::string::npos) {
        registry.set(argument);
      } else {
        rawlogs.push_back(argument);
      }
    }
    for (const auto& rawlog : rawlogs) {
      runWorld(rawlog, options, params, range_of_rig, list, detections, tracks);
    }
  } catch (const headway::InputError& error) {
    std::fprintf(stderr, "bench_moving_objects: %s\n", error.what());
    return 1;
  }
  detections.print("detections");
  tracks.print("confirmed moving tracks");
  return 0;
}
