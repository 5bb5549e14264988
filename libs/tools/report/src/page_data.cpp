// SPDX-License-Identifier: BSD-3-Clause
#include "page_data.h"

#include <headway/core/ellipse.h>
#include <headway/core/object_class.h>
#include <headway/io/calibration_file.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "html.h"

namespace headway::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMaxStep = 65535.0;
constexpr std::size_t kMaxTruePoses = 4000;

/// Positions and speeds in steps of 1 cm, angles in steps of 1 mrad.
std::int64_t hundredths(double value) {
  return std::isfinite(value) ? std::llround(std::clamp(100.0 * value, -1e12, 1e12)) : 0;
}
std::int64_t thousandths(double value) { return hundredths(10.0 * value); }

Json poseJson(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  Json json = Json::array();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    json.push_back(std::round(1e4 * value) / 1e4);
  }
  return json;
}

void append(Json& list, const Eigen::Vector3d& vector) {
  for (const double value : vector) list.push_back(hundredths(value));
}

/// Numbers the tracks in order of their first appearance.
class TrackNumbers {
 public:
  explicit TrackNumbers(const std::vector<ReplayFrame>& frames) {
    for (const auto& frame : frames) {
      for (const auto& track : frame.tracks) {
        const auto [number, is_new] = numbers_.try_emplace(track.id, numbers_.size());
        if (is_new) votes_.emplace_back(), ids_.push_back(track.id);
        votes_[number->second][track.object_class] += 1;
      }
    }
  }
  [[nodiscard]] std::size_t of(TrackId id) const { return numbers_.at(id); }
  /// Ids, and the number of frames with each class.
  [[nodiscard]] Json json() const {
    Json list = Json::array();
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      Json votes = Json::object();
      for (const auto& [object_class, count] : votes_[i]) votes[classNumber(object_class)] = count;
      list.push_back({{"id", ids_[i].value}, {"votes", votes}});
    }
    return list;
  }
  static std::string classNumber(ObjectClass object_class) {
    return std::to_string(static_cast<int>(object_class));
  }

 private:
  std::map<TrackId, std::size_t> numbers_;
  std::vector<TrackId> ids_;
  std::vector<std::map<ObjectClass, int>> votes_;
};

/// number, class, moving + 2 * coasting, x, y, z, yaw, vx, vy, length, width, height.
Json stateJson(const Track& track, std::size_t number) {
  Json state = {number, static_cast<int>(track.object_class),
                (isMoving(track) ? 1 : 0) + (track.status == TrackStatus::kCoasting ? 2 : 0)};
  append(state, track.position);
  state.push_back(thousandths(track.yaw));
  for (const double speed : {track.velocity.x(), track.velocity.y()}) {
    state.push_back(hundredths(speed));
  }
  append(state, track.size);
  return state;
}

/// number of the track, percent, then for each point: horizon [0.1 s], position, half axes of one
/// standard deviation, angle of the major one.
Json predictionJson(const PredictedPath& path, std::size_t number) {
  Json json = {number, std::llround(100.0 * path.probability)};
  for (const auto& point : path.points) {
    const Ellipse ellipse = sigmaEllipse(point.covariance);
    json.push_back(std::llround(10.0 * point.horizon_s));
    append(json, point.position);
    json.push_back(hundredths(ellipse.major));
    json.push_back(hundredths(ellipse.minor));
    json.push_back(thousandths(ellipse.angle));
  }
  return json;
}

Json frameJson(const ReplayFrame& frame, const TrackNumbers& numbers, Time start) {
  Json states = Json::array(), predictions = Json::array();
  for (const auto& track : frame.tracks) {
    const std::size_t number = numbers.of(track.id);
    states.push_back(stateJson(track, number));
    if (!isMoving(track)) continue;
    for (const auto& path : track.predictions) {
      if (!path.points.empty()) predictions.push_back(predictionJson(path, number));
    }
  }
  return {{"frame", frame.frame},
          {"time", std::round(1e4 * (frame.time - start)) / 1e4},
          {"pose", poseJson(frame.T_map_robot)},
          {"states", states},
          {"predictions", predictions}};
}

Json classesJson() {
  Json classes = Json::array();
  for (std::size_t i = 0; i < kObjectClassCount; ++i) {
    const auto object_class = static_cast<ObjectClass>(i);
    classes.push_back({displayName(object_class), hex(colourOf(object_class))});
  }
  return classes;
}

Json cameraJson(const fs::path& calibration) {
  if (!fs::exists(calibration)) return nullptr;
  const StereoCamera camera = io::readCalibration(calibration);
  return {{"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"pose", poseJson(camera.T_robot_cam)}};
}

Json gridJson(const fs::path& description) {
  const auto grid = readGrid(description);
  if (!grid) return nullptr;
  const GridPicture picture = gridPicture(grid->picture);
  return {{"picture", picture.uri},
          {"x", grid->origin.x()},
          {"y", grid->origin.y()},
          {"width", picture.width * grid->resolution_m},
          {"height", picture.height * grid->resolution_m}};
}

/// Ground height under the robot's origin, and the rig's reach [m]; as of a car if they are
/// unknown.
void addRig(const Json& record, Json& data) {
  data["ground"] = 0.0;
  data["reach"] = 20.0;
  if (!record.is_object() || !record.contains("rig") || !record["rig"].is_object()) return;
  const Json& rig = record["rig"];
  data["reach"] = rig.value("obstacles_to_m", 20.0);
  if (data["camera"].is_null()) return;
  data["ground"] = data["camera"]["pose"][2].get<double>() - rig.value("camera_height_m", 0.0);
}

Json truthJson(const ReplayTruth& truth, const std::vector<ReplayFrame>& frames) {
  if (truth.path.empty()) return nullptr;
  Json path = Json::array(), objects = Json::array();
  const std::size_t step = 1 + (truth.path.size() - 1) / kMaxTruePoses;
  for (std::size_t i = 0; i < truth.path.size(); i += step) {
    append(path, truth.path[i].value.translation());
  }
  for (const auto& frame : frames) {
    Json boxes = Json::array();
    const auto found = truth.objects.find(frame.frame);
    if (found != truth.objects.end()) {
      for (const auto& track : found->second) {
        Json box = Json::array();
        append(box, track.position);
        box.push_back(thousandths(track.yaw));
        append(box, track.size);
        boxes.push_back(box);
      }
    }
    objects.push_back(boxes);
  }
  return {{"path", path}, {"objects", objects}};
}

/// Median distance from points in random order to their nearest other [m]; 0 of fewer than two.
double spacingOf(const std::vector<ColouredPoint>& points) {
  constexpr std::size_t kSamples = 101;
  std::vector<float> nearest(points.size() < 2 ? 0 : std::min(kSamples, points.size()));
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    nearest[i] = std::numeric_limits<float>::max();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      nearest[i] = std::min(nearest[i], (points[j].position - points[i].position).squaredNorm());
    }
  }
  if (nearest.empty()) return 0.0;
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return std::sqrt(*middle);
}

}  // namespace

PackedPoints packed(std::vector<ColouredPoint> points) {
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const auto& point) { return !point.position.allFinite(); }),
               points.end());
  PackedPoints result;
  result.count = points.size();
  if (points.empty()) return result;
  std::mt19937 random(1);
  for (std::size_t i = points.size() - 1; i > 0; --i)
    std::swap(points[i], points[random() % (i + 1)]);
  result.spacing = spacingOf(points);
  Eigen::AlignedBox3f bounds;
  for (const auto& point : points) bounds.extend(point.position);
  result.origin = bounds.min().cast<double>();
  result.step = (bounds.sizes().cast<double>() / kMaxStep).cwiseMax(1e-6);
  result.bytes.reserve(9 * points.size());
  for (const auto& point : points) {
    const Eigen::Vector3d steps =
        (point.position.cast<double>() - result.origin).cwiseQuotient(result.step);
    for (const double step : steps) {
      const auto value = static_cast<unsigned>(std::lround(std::clamp(step, 0.0, kMaxStep)));
      result.bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
      result.bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
    }
  }
  for (const auto& point : points) {
    for (const auto part : {point.colour.red, point.colour.green, point.colour.blue}) {
      result.bytes.push_back(part);
    }
  }
  return result;
}

Json pageData(const fs::path& folder, const std::vector<ReplayFrame>& frames,
              const ReplayTruth& truth, const std::vector<Stamped<Pose>>& keyframes) {
  const TrackNumbers numbers(frames);
  Json data = {{"classes", classesJson()},
               {"tracks", numbers.json()},
               {"camera", cameraJson(folder / "calibration.yaml")},
               {"grid", gridJson(folder / "map_grid.yaml")},
               {"truth", truthJson(truth, frames)},
               {"prediction_colour", hex(kPredictionColour)},
               {"keyframes", Json::array()},
               {"frames", Json::array()}};
  const fs::path record = folder / "replay.json";
  addRig(fs::exists(record) ? readJson(record) : Json(), data);
  for (const auto& keyframe : keyframes) data["keyframes"].push_back(poseJson(keyframe.value));
  for (const auto& frame : frames) {
    data["frames"].push_back(frameJson(frame, numbers, frames.front().time));
  }
  return data;
}

}  // namespace headway::report
