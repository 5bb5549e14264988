// SPDX-License-Identifier: BSD-3-Clause
// How many of the people around a robot a replay finds, and what it takes for objects that is none.
#include <headway/core/assignment.h>
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/people_error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "evaluation_inputs.h"

namespace headway::eval {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double groundDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).head<2>().norm();
}

/// Distance over the ground of a point from a box; 0 inside.
double distanceToBox(const Eigen::Vector3d& point, const Track& box) {
  const Eigen::Vector2d offset = Eigen::Rotation2Dd(-box.yaw) * (point - box.position).head<2>();
  return (offset.cwiseAbs() - 0.5 * box.size.head<2>()).cwiseMax(0.0).norm();
}

std::string bandOf(double range_m) {
  if (range_m < 1.5) return "0.5-1.5";
  if (range_m < 3.0) return "1.5-3";
  return range_m < PeopleErrorParams().max_range_m ? "3-7" : "7-";
}

class PeopleEvaluation {
 public:
  PeopleEvaluation(const StereoCamera& camera, const PeopleErrorParams& params)
      : camera_(camera), T_cam_robot_(camera.T_robot_cam.inverse()), params_(params) {
    result_.max_range_m = params.max_range_m;
  }

  void add(const PeopleFrame& frame) {
    ++result_.frames;
    std::vector<const SeenObject*> people;
    for (const auto& seen : frame.truth) {
      if (isPerson(seen.object.object_class)) people.push_back(&seen);
    }
    const auto row_of = match(people, frame.rows);
    for (std::size_t i = 0; i < people.size(); ++i) {
      noteArrival(*people[i], row_of[i], frame.time);
      if (!counts(*people[i], frame.time)) continue;
      countPerson(*people[i], row_of[i]);
      if (!isMoving(people[i]->object)) continue;
      for (const char* way : waysOf(*people[i], people, frame)) count(row_of[i], result_.ways[way]);
    }
    for (const auto& row : frame.rows) {
      if (row.status == TrackStatus::kConfirmed) countRow(row, frame.truth, people);
    }
  }

  [[nodiscard]] PeopleError result() {
    for (const auto& [id, arrival] : arrivals_) end(arrival);
    std::sort(result_.first_rows_s.begin(), result_.first_rows_s.end());
    result_.moving_tracks = moving_.size();
    for (const auto& [id, rows] : moving_) {
      if (2 * rows.wrong >= rows.all) result_.false_moving_tracks.push_back(id.value);
    }
    return std::move(result_);
  }

 private:
  struct View {
    Time since = 0.0, last = 0.0;
    bool was_hidden = false;  ///< before, in the image's field
  };
  /// Somebody in view within the reach.
  struct Arrival {
    Time since = 0.0, last = 0.0;
    double first_row_s = std::numeric_limits<double>::infinity();
  };
  struct MovingRows {
    std::size_t all = 0, wrong = 0;
  };

  /// Whether its centre is in the image, hidden or not.
  [[nodiscard]] bool isInField(const SeenObject& seen) const {
    const auto at = project(T_cam_robot_ * seen.object.position, camera_);
    return at && at->x() >= 0.0 && at->y() >= 0.0 && at->x() <= camera_.width - 1 &&
           at->y() <= camera_.height - 1;
  }
  [[nodiscard]] bool isInView(const SeenObject& seen) const {
    return seen.visible >= params_.min_visible && isInField(seen);
  }
  [[nodiscard]] bool isInReach(const SeenObject& seen) const {
    const double range = rangeOf(seen);
    return range >= params_.min_range_m && range <= params_.max_range_m;
  }
  /// Whether somebody last in view at a time has left it since.
  [[nodiscard]] bool hasLeft(Time last, Time now) const {
    return now - last > params_.settle_s + kTimeTolerance_s;
  }

  /// Whether a person counts; takes note of how long he has been in view. Whoever is out of view
  /// for no longer than he must be in view has not left it.
  bool counts(const SeenObject& seen, Time time) {
    const TrackId id = seen.object.id;
    if (!isInView(seen)) {
      if (isInField(seen)) hidden_at_[id] = time;
      return false;
    }
    auto [view, is_new] = views_.try_emplace(id, View{time, time});
    if (is_new || hasLeft(view->second.last, time)) {
      const auto hidden = hidden_at_.find(id);
      view->second.since = time;
      view->second.was_hidden = hidden != hidden_at_.end() && !hasLeft(hidden->second, time);
    }
    view->second.last = time;
    return time - view->second.since > params_.settle_s - kTimeTolerance_s && isInReach(seen);
  }

  /// Takes note of when whoever comes into view within the reach is first found.
  void noteArrival(const SeenObject& seen, const Track* row, Time time) {
    if (!isInView(seen) || !isInReach(seen)) return;
    auto [entry, is_new] = arrivals_.try_emplace(seen.object.id, Arrival{time, time});
    Arrival& arrival = entry->second;
    if (!is_new && hasLeft(arrival.last, time)) {
      end(arrival);
      arrival = {time, time};
    }
    arrival.last = time;
    if (row != nullptr) arrival.first_row_s = std::min(arrival.first_row_s, time - arrival.since);
  }

  void end(const Arrival& arrival) {
    const bool stays = arrival.last - arrival.since > params_.stay_s - kTimeTolerance_s;
    if (stays || std::isfinite(arrival.first_row_s)) {
      result_.first_rows_s.push_back(arrival.first_row_s);
    }
  }

  [[nodiscard]] std::vector<const char*> waysOf(const SeenObject& seen,
                                                const std::vector<const SeenObject*>& people,
                                                const PeopleFrame& frame) const {
    std::vector<const char*> ways;
    const Track& person = seen.object;
    const Eigen::Vector2d to_camera =
        (camera_.T_robot_cam.translation() - person.position).head<2>().normalized();
    const double angle =
        std::acos(std::clamp(to_camera.dot(person.velocity.head<2>().normalized()), -1.0, 1.0));
    if (angle < params_.head_on_rad) ways.push_back("head-on");
    if (angle > M_PI - params_.head_on_rad) ways.push_back("leaving");
    if (angle > params_.crossing_rad && angle < M_PI - params_.crossing_rad)
      ways.push_back("crossing");
    const auto walks_along = [&](const SeenObject* other) {
      return other != &seen && isMoving(other->object) &&
             groundDistance(other->object.position, person.position) < params_.group_m;
    };
    if (std::any_of(people.begin(), people.end(), walks_along)) ways.push_back("in a group");
    const View& view = views_.at(person.id);
    if (view.was_hidden && frame.time - view.since < params_.stay_s) {
      ways.push_back("from behind something");
    }
    if (std::abs(frame.turn_radps) > params_.turning_radps) ways.push_back("robot turns");
    return ways;
  }

  [[nodiscard]] double rangeOf(const SeenObject& seen) const {
    return groundDistance(seen.object.position, camera_.T_robot_cam.translation());
  }

  /// The row that finds each person; null if none does.
  [[nodiscard]] std::vector<const Track*> match(const std::vector<const SeenObject*>& people,
                                                const std::vector<Track>& rows) const {
    std::vector<CandidatePair> candidates;
    for (std::size_t i = 0; i < people.size(); ++i) {
      for (std::size_t j = 0; j < rows.size(); ++j) {
        const bool may_be_person =
            isPerson(rows[j].object_class) || rows[j].object_class == ObjectClass::kUnknown;
        if (rows[j].status != TrackStatus::kConfirmed || !may_be_person) continue;
        const double distance = groundDistance(rows[j].position, people[i]->object.position);
        if (distance <= params_.found_within_m) candidates.push_back({i, j, distance});
      }
    }
    std::vector<const Track*> row_of(people.size(), nullptr);
    for (const auto& pair : assignPairs(std::move(candidates))) {
      row_of[pair.row] = &rows[pair.column];
    }
    return row_of;
  }

  void countPerson(const SeenObject& seen, const Track* row) {
    auto& ranges = isMoving(seen.object) ? result_.walking : result_.standing;
    count(row, result_.all);
    count(row, ranges[bandOf(rangeOf(seen))]);
  }

  static void count(const Track* row, PersonFrames& cell) {
    ++cell.persons;
    if (row == nullptr) return;
    ++cell.found;
    if (isPerson(row->object_class)) ++cell.found_as_person;
  }

  void countRow(const Track& row, const std::vector<SeenObject>& truth,
                const std::vector<const SeenObject*>& people) {
    const auto is_near = [&](const Track& object) {
      return distanceToBox(row.position, object) <= params_.false_beyond_m;
    };
    const bool is_false = std::none_of(truth.begin(), truth.end(),
                                       [&](const auto& seen) { return is_near(seen.object); });
    ++result_.rows;
    if (is_false) ++result_.false_rows;
    if (isPerson(row.object_class)) {
      ++result_.person_rows;
      if (std::any_of(people.begin(), people.end(),
                      [&](const auto* seen) { return is_near(seen->object); })) {
        ++result_.person_rows_right;
      }
    }
    if (!isMoving(row)) return;
    auto& track = moving_[row.id];
    ++track.all;
    if (is_false) ++track.wrong;
  }

  const StereoCamera& camera_;
  Pose T_cam_robot_;
  const PeopleErrorParams& params_;
  std::map<TrackId, View> views_;
  std::map<TrackId, Time> hidden_at_;
  std::map<TrackId, Arrival> arrivals_;
  std::map<TrackId, MovingRows> moving_;
  PeopleError result_;
};

Json jsonOf(const PersonFrames& cell) {
  const auto interval = cell.interval();
  return {{"person_frames", cell.persons},
          {"found", cell.found},
          {"found_ratio", orNull(cell.foundRatio())},
          {"interval_95", interval ? Json(*interval) : Json(nullptr)},
          {"found_as_person", cell.found_as_person},
          {"as_person_ratio", orNull(cell.personRatio())}};
}

Json jsonOf(const std::vector<double>& times_s) {
  Json json = Json::array();
  for (const double time_s : times_s) json.push_back(std::isfinite(time_s) ? Json(time_s) : Json());
  return json;
}

Json jsonOf(const std::map<std::string, PersonFrames>& ranges) {
  Json json = Json::object();
  for (const auto& [name, cell] : ranges) json[name] = jsonOf(cell);
  return json;
}

}  // namespace

std::optional<double> PersonFrames::foundRatio() const { return ratioOf(found, persons); }
std::optional<double> PersonFrames::personRatio() const { return ratioOf(found_as_person, found); }

std::optional<std::array<double, 2>> PersonFrames::interval() const {
  if (persons == 0) return std::nullopt;
  constexpr double kQuantile = 1.959964;  // of the normal distribution, 97.5 %
  const auto n = static_cast<double>(persons);
  const double p = static_cast<double>(found) / n, z2 = kQuantile * kQuantile / n;
  const double middle = (p + 0.5 * z2) / (1.0 + z2);
  const double half = kQuantile * std::sqrt(p * (1.0 - p) / n + 0.25 * z2 / n) / (1.0 + z2);
  return std::array<double, 2>{std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::optional<double> PeopleError::falseRatio() const { return ratioOf(false_rows, rows); }
std::optional<double> PeopleError::personRowsRatio() const {
  return ratioOf(person_rows_right, person_rows);
}
std::optional<double> PeopleError::falseTracksPer10Min() const {
  if (!(duration_s > 0.0)) return std::nullopt;
  return 600.0 * static_cast<double>(false_moving_tracks.size()) / duration_s;
}

std::optional<double> PeopleError::withinASecondRatio() const {
  const auto later =
      std::upper_bound(first_rows_s.begin(), first_rows_s.end(), 1.0 + kTimeTolerance_s);
  return ratioOf(static_cast<std::size_t>(later - first_rows_s.begin()), first_rows_s.size());
}
std::optional<double> PeopleError::medianFirstRow_s() const {
  if (first_rows_s.empty()) return std::nullopt;
  const double median_s = first_rows_s[first_rows_s.size() / 2];
  return std::isfinite(median_s) ? std::optional(median_s) : std::nullopt;
}

PeopleError peopleError(const std::vector<PeopleFrame>& frames, const StereoCamera& camera,
                        const PeopleErrorParams& params) {
  PeopleEvaluation evaluation(camera, params);
  for (const auto& frame : frames) evaluation.add(frame);
  PeopleError error = evaluation.result();
  if (!frames.empty()) error.duration_s = frames.back().time - frames.front().time;
  return error;
}

PeopleError evaluatePeople(const fs::path& truth, const fs::path& replay, double reach_m) {
  PeopleErrorParams params;
  params.max_range_m = 0.0;
  const auto record = replayRecord(replay);
  const std::size_t first = firstFrame(record);
  const auto rig = record.find("rig");
  if (rig != record.end() && rig->is_object()) params.max_range_m = rig->value("people_to_m", 0.0);
  if (reach_m > 0.0) params.max_range_m = reach_m;
  if (!(params.max_range_m > 0.0)) {
    throw InputError((replay / "replay.json").string() +
                     ": states no reach of its rig for people; give one with --reach");
  }
  const auto camera = io::readCalibration((replay / "calibration.yaml").string());
  const auto true_poses = io::readTum((truth / "trajectory.tum").string());
  const auto estimated = io::readTum((replay / "trajectory_online.tum").string());
  const std::size_t end =
      first + io::readKittiPoses((replay / "trajectory_kitti.txt").string()).size();
  if (end > true_poses.size()) {
    throw InputError((truth / "trajectory.tum").string() + ": has " +
                     std::to_string(true_poses.size()) + " frames, but the replay ends at frame " +
                     std::to_string(end) + "; is it the truth of the replay's rawlog?");
  }
  std::vector<PeopleFrame> frames(end - first);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].time = true_poses[first + i].time;
    if (i == 0) continue;
    const Pose step =
        true_poses[first + i - 1].value.inverse(Eigen::Isometry) * true_poses[first + i].value;
    frames[i].turn_radps = yawOf(step) / (frames[i].time - frames[i - 1].time);
  }
  const auto frameOf = [&](std::size_t index) -> PeopleFrame* {
    return index >= first && index < end ? &frames[index - first] : nullptr;
  };
  for (const auto& [sample, visible] : io::readObjectCsv((truth / "objects.csv").string())) {
    PeopleFrame* frame = frameOf(sample.frame);
    if (frame == nullptr) continue;
    const Pose T_robot_map = true_poses[sample.frame].value.inverse();
    frame->truth.push_back({transformed(sample.track, T_robot_map), visible});
  }
  std::size_t rows_without_pose = 0;
  for (const auto& sample : io::readTrackCsv((replay / "tracks.csv").string())) {
    PeopleFrame* frame = frameOf(sample.frame);
    if (frame == nullptr) {
      throw InputError((replay / "tracks.csv").string() + ": frame " +
                       std::to_string(sample.frame) + " is not one of the replay's");
    }
    const Pose* T_map_robot = poseAt(estimated, sample.time);
    if (T_map_robot == nullptr) {
      ++rows_without_pose;
      continue;
    }
    frame->rows.push_back(transformed(sample.track, T_map_robot->inverse()));
  }
  PeopleError error = peopleError(frames, camera, params);
  error.rows_without_pose = rows_without_pose;
  return error;
}

Json toJson(const PeopleError& error) {
  return {{"frames", error.frames},
          {"duration_s", error.duration_s},
          {"reach_m", error.max_range_m},
          {"all", jsonOf(error.all)},
          {"walking", jsonOf(error.walking)},
          {"standing", jsonOf(error.standing)},
          {"ways", jsonOf(error.ways)},
          {"first_rows_s", jsonOf(error.first_rows_s)},
          {"rows", error.rows},
          {"rows_without_pose", error.rows_without_pose},
          {"false_rows", error.false_rows},
          {"false_ratio", orNull(error.falseRatio())},
          {"person_rows", error.person_rows},
          {"person_rows_right", error.person_rows_right},
          {"person_rows_right_ratio", orNull(error.personRowsRatio())},
          {"moving_tracks", error.moving_tracks},
          {"false_moving_tracks", error.false_moving_tracks},
          {"false_moving_tracks_per_10_min", orNull(error.falseTracksPer10Min())}};
}

plot::TextTable tableOf(const PeopleError& error) {
  plot::TextTable table = {
      {"people", "person-frames", "found", "found %", "95 % interval", "as person %"}};
  const auto add = [&](const std::string& name, const PersonFrames& cell) {
    const auto interval = cell.interval();
    const auto bound = [&](std::size_t i) { return plot::percentText((*interval)[i], 1); };
    table.push_back({name, std::to_string(cell.persons), std::to_string(cell.found),
                     plot::percentText(cell.foundRatio(), 1),
                     interval ? bound(0) + " to " + bound(1) : "-",
                     plot::percentText(cell.personRatio(), 1)});
  };
  for (const auto& [name, cell] : error.walking) add("walking, " + name + " m", cell);
  for (const auto& [name, cell] : error.standing) add("standing, " + name + " m", cell);
  for (const auto& [name, cell] : error.ways) add("walking, " + name, cell);
  add("all, to " + plot::fixedText(error.max_range_m, 1) + " m", error.all);
  return table;
}

}  // namespace headway::eval
