// SPDX-License-Identifier: BSD-3-Clause
// Satellite fixes of a run, and the files that place its map, path and tracks on the earth.
#include "geo_files.h"

#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/geo/geojson.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace headway::replay {
namespace {

constexpr std::uint32_t kGnssVersion = 1;

/// The pose at a time between two frames.
Pose poseBetween(const slam::FrameEstimate& before, const slam::FrameEstimate& after, Time time) {
  const double ratio = (time - before.time) / (after.time - before.time);
  Pose pose = Pose::Identity();
  pose.linear() = quaternionOf(before.T_map_robot)
                      .slerp(ratio, quaternionOf(after.T_map_robot))
                      .toRotationMatrix();
  pose.translation() =
      (1.0 - ratio) * before.T_map_robot.translation() + ratio * after.T_map_robot.translation();
  return pose;
}

bool isEarlier(const GnssFix& fix, Time time) { return fix.time < time; }

bool isEarlierOnMap(const geo::FixOnMap& a, const geo::FixOnMap& b) {
  return a.fix.time < b.fix.time;
}

template <typename Fix>
void removeEverySecond(std::vector<Fix>& fixes) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < fixes.size(); i += 2) fixes[kept++] = fixes[i];
  fixes.resize(kept);
}

std::vector<geo::FixOnMap> fixesAlong(const std::vector<GnssFix>& fixes,
                                      const slam::TrajectoryVisit& visit) {
  std::vector<GnssFix> sorted = fixes;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const GnssFix& a, const GnssFix& b) { return a.time < b.time; });
  std::vector<geo::FixOnMap> result;
  std::optional<slam::FrameEstimate> before;
  visit([&](const slam::FrameEstimate& after) {
    const auto last = std::exchange(before, after.tracked ? std::optional(after) : std::nullopt);
    if (!last || !before || !(after.time > last->time) || after.time - last->time > 1.0) {
      return;
    }
    auto fix = std::lower_bound(sorted.begin(), sorted.end(), last->time, isEarlier);
    for (; fix != sorted.end() && fix->time < after.time; ++fix) {
      result.push_back({*fix, poseBetween(*last, after, fix->time) * fix->antenna});
    }
  });
  return result;
}

geo::FixOnMap readFix(ByteReader& in) {
  geo::FixOnMap read;
  GnssFix& fix = read.fix;
  fix.time = in.finiteValue<double>();
  fix.antenna = in.finiteMatrix<Eigen::Vector3d>();
  fix.latitude_deg = in.finiteValue<double>();
  fix.longitude_deg = in.finiteValue<double>();
  fix.altitude_m = in.finiteValue<double>();
  fix.sigma_m = in.finiteValue<double>();
  read.in_map = in.finiteMatrix<Eigen::Vector3d>();
  if (!(fix.sigma_m > 0.0) || std::abs(fix.latitude_deg) > 90.0) {
    throw InputError("damaged: a satellite fix is none");
  }
  return read;
}

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxLinePoints = 10000;

/// The robot's way in stretches that are written as they end.
class Way {
 public:
  Way(geo::GeoJsonLines& lines, const geo::Georeference& reference)
      : lines_(lines), reference_(reference) {}

  void add(const slam::FrameEstimate& estimate) {
    if (!estimate.tracked) return end();
    points_.push_back({estimate.time, reference_.positionOf(estimate.T_map_robot.translation())});
    if (points_.size() < kMaxLinePoints) return;
    const geo::GeoPoint last = points_.back();  // the next line begins where this one ends
    end();
    points_.push_back(last);
  }
  void end() {
    lines_.add("\"name\":\"robot\"", points_);
    points_.clear();
  }

 private:
  geo::GeoJsonLines& lines_;
  const geo::Georeference& reference_;
  std::vector<geo::GeoPoint> points_;
};

Json rowsOf(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) row.push_back(matrix(i, k));
    rows.push_back(row);
  }
  return rows;
}

constexpr double kLongestPause = 60.0;  // of a track, after which its line is ended [s]

/// What moves a point of the map as it was at a time to the final map.
class MapCorrection {
 public:
  explicit MapCorrection(const std::filesystem::path& folder)
      : online_((folder / "trajectory_online.tum").string()),
        final_((folder / "trajectory.tum").string()) {}

  [[nodiscard]] const Pose& at(Time time) {
    while (steps_.empty() || steps_.back().time < time) {
      if (!readStep()) break;
    }
    if (steps_.empty()) return none_;
    const Stamped<Pose>* best = &steps_.back();
    for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
      if (std::abs(step->time - time) > std::abs(best->time - time)) break;
      best = &*step;
    }
    return best->value;
  }

 private:
  /// Reads on to the next time that both paths have.
  bool readStep() {
    auto online = online_.next();
    auto corrected = final_.next();
    while (online && corrected && online->time != corrected->time) {
      (online->time < corrected->time ? online : corrected) =
          (online->time < corrected->time ? online_ : final_).next();
    }
    if (!online || !corrected) return false;
    steps_.push_back({online->time, corrected->value * online->value.inverse()});
    if (steps_.size() > kMaxKept) steps_.pop_front();
    return true;
  }

  io::TumReader online_, final_;
  std::deque<Stamped<Pose>> steps_;
  Pose none_ = Pose::Identity();
};

/// Lines of tracks, which are written as they end.
class TrackLines {
 public:
  TrackLines(std::ostream& out, const geo::Georeference& reference)
      : lines_(out), reference_(reference) {}

  void add(const TrackSample& sample, const Eigen::Vector3d& in_map) {
    if (sample.time - checked_ > kLongestPause) endOld(sample.time);
    Line& line = open_[sample.track.id];
    line.object_class = sample.track.object_class;
    line.points.push_back({sample.time, reference_.positionOf(in_map)});
    if (line.points.size() < kMaxLinePoints) return;
    const geo::GeoPoint last = line.points.back();
    write(sample.track.id, line);
    line.points = {last};
  }
  void end() {
    for (const auto& [id, line] : open_) write(id, line);
    lines_.end();
  }

 private:
  struct Line {
    ObjectClass object_class = ObjectClass::kUnknown;
    std::vector<geo::GeoPoint> points;
  };

  void endOld(Time now) {
    for (auto line = open_.begin(); line != open_.end();) {
      const bool is_old = now - line->second.points.back().time > kLongestPause;
      if (is_old) write(line->first, line->second);
      line = is_old ? open_.erase(line) : std::next(line);
    }
    checked_ = now;
  }
  void write(TrackId id, const Line& line) {
    lines_.add("\"track_id\":" + std::to_string(id.value) + ",\"class\":\"" +
                   std::string(toString(line.object_class)) + "\"",
               line.points);
  }

  geo::GeoJsonLines lines_;
  const geo::Georeference& reference_;
  std::map<TrackId, Line> open_;
  Time checked_ = 0.0;
};

}  // namespace

void GnssLog::add(const std::vector<GnssFix>& fixes) {
  for (const auto& fix : fixes) {
    if (added_++ % step_ != 0) continue;
    fixes_.push_back(fix);
    if (fixes_.size() <= max_fixes_) continue;
    removeEverySecond(fixes_);
    step_ *= 2;
  }
}

void GnssLog::load(const std::string& bytes, const slam::MapView& map) {
  ByteReader in(bytes);
  const auto version = in.value<std::uint32_t>();
  if (version != kGnssVersion) {
    throw InputError("its satellite fixes are of version " + std::to_string(version) +
                     ", this program reads version " + std::to_string(kGnssVersion));
  }
  before_ = in.list<geo::FixOnMap>(readFix);
  if (!in.atEnd()) throw InputError("damaged: there are data after its satellite fixes");
  for (const auto& keyframe : map.keyframes) loaded_[keyframe.id] = keyframe.T_map_robot;
}

std::vector<geo::FixOnMap> GnssLog::onMap(const slam::TrajectoryVisit& trajectory,
                                          const slam::MapView& map) const {
  struct Moved {
    Eigen::Vector3d before;  ///< of the keyframe's robot
    Pose T_now_before;
  };
  std::vector<Moved> keyframes;
  for (const auto& keyframe : map.keyframes) {
    const auto loaded = loaded_.find(keyframe.id);
    if (loaded == loaded_.end()) continue;
    keyframes.push_back({loaded->second.translation(),
                         keyframe.T_map_robot * loaded->second.inverse(Eigen::Isometry)});
  }
  std::vector<geo::FixOnMap> fixes = before_;
  for (geo::FixOnMap& fix : fixes) {
    const auto nearest = std::min_element(
        keyframes.begin(), keyframes.end(), [&fix](const Moved& a, const Moved& b) {
          return (a.before - fix.in_map).squaredNorm() < (b.before - fix.in_map).squaredNorm();
        });
    if (nearest != keyframes.end()) fix.in_map = nearest->T_now_before * fix.in_map;
  }
  const auto own = fixesAlong(fixes_, trajectory);
  fixes.insert(fixes.end(), own.begin(), own.end());
  std::stable_sort(fixes.begin(), fixes.end(), isEarlierOnMap);
  return fixes;
}

std::string gnssBytes(std::vector<geo::FixOnMap> fixes) {
  while (fixes.size() > kMaxKept) removeEverySecond(fixes);
  ByteWriter out;
  out.value(kGnssVersion);
  out.count(fixes.size());
  for (const auto& [fix, in_map] : fixes) {
    out.value(fix.time);
    out.matrix(fix.antenna);
    out.value(fix.latitude_deg);
    out.value(fix.longitude_deg);
    out.value(fix.altitude_m);
    out.value(fix.sigma_m);
    out.matrix(in_map);
  }
  return std::move(out.bytes);
}

GeoSummary georeferenced(const std::vector<geo::FixOnMap>& fixes, std::size_t recorded,
                         std::size_t kept) {
  GeoSummary summary;
  summary.fixes = recorded;
  summary.without_pose = kept - std::min(fixes.size(), kept);
  auto result = geo::georeference(fixes);
  if (const auto* none = std::get_if<geo::NoGeoreference>(&result)) {
    summary.reason = none->reason;
  } else {
    summary.reference = std::get<geo::Georeference>(result);
  }
  return summary;
}

std::string describe(const GeoSummary& summary) {
  if (!summary.reference) {
    return "not georeferenced (" + std::to_string(summary.fixes) + " fixes): " + summary.reason;
  }
  const auto& reference = *summary.reference;
  const auto& origin = reference.frame.origin();
  char text[240];
  std::snprintf(text, sizeof text,
                "georeferenced: map origin %.7f, %.7f (+- %.2f m), heading %.2f deg (+- %.2f deg), "
                "%zu fixes used, %zu rejected, RMSE %.2f m",
                origin.latitude_deg, origin.longitude_deg, reference.originSigma(),
                reference.headingDeg(), reference.headingSigmaDeg(), reference.used,
                reference.rejected, reference.rmse_m);
  return text;
}

void writeMapGeo(const std::filesystem::path& path, const GeoSummary& summary) {
  const auto& reference = *summary.reference;
  const auto& origin = reference.frame.origin();
  const Eigen::Quaterniond turn = quaternionOf(reference.T_enu_map);
  Json json;
  json["datum"] = "WGS84";
  json["map_origin"] = {{"latitude_deg", origin.latitude_deg},
                        {"longitude_deg", origin.longitude_deg},
                        {"altitude_m", origin.altitude_m}};
  json["heading_deg"] = reference.headingDeg();
  json["enu_from_map_quaternion"] = {
      {"x", turn.x()}, {"y", turn.y()}, {"z", turn.z()}, {"w", turn.w()}};
  json["enu_from_map_rotation"] = rowsOf(reference.T_enu_map.linear());
  json["covariance_order"] = {"east_m",         "north_m",         "up_m",
                              "about_east_rad", "about_north_rad", "about_up_rad"};
  json["covariance"] = rowsOf(reference.covariance);
  json["heading_sigma_deg"] = reference.headingSigmaDeg();
  json["origin_sigma_m"] = reference.originSigma();
  json["fixes"] = {{"recorded", summary.fixes},
                   {"without_pose", summary.without_pose},
                   {"used", reference.used},
                   {"rejected", reference.rejected}};
  json["rmse_m"] = reference.rmse_m;
  writeFile(path, json.dump(2) + '\n');
}

void writeTrajectoryGeo(const std::filesystem::path& path, const geo::Georeference& reference,
                        const slam::TrajectoryVisit& visit) {
  OutputFile file(path);
  geo::GeoJsonLines lines(file.stream());
  Way way(lines, reference);
  visit([&way](const slam::FrameEstimate& estimate) { way.add(estimate); });
  way.end();
  lines.end();
  file.commit();
}

void writeTracksGeo(const std::filesystem::path& folder, const geo::Georeference& reference) {
  OutputFile file(folder / "tracks.geojson");
  MapCorrection correction(folder);
  TrackLines lines(file.stream(), reference);
  io::visitTrackCsv((folder / "tracks_smoothed.csv").string(), [&](const TrackSample& sample) {
    lines.add(sample, correction.at(sample.time) * sample.track.position);
  });
  lines.end();
  file.commit();
}

}  // namespace headway::replay
