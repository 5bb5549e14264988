// SPDX-License-Identifier: BSD-3-Clause
// The part of geo_files.h that writes the moving objects.
#include <headway/core/output_file.h>
#include <headway/geo/geojson.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <cmath>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "geo_files.h"

namespace headway::replay {
namespace {

constexpr std::size_t kMaxTrackPoints = 10000;  // of a line
constexpr double kLongestPause = 60.0;          // of a track, after which its line is ended [s]

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
  static constexpr std::size_t kMaxSteps = 20000;

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
    if (steps_.size() > kMaxSteps) steps_.pop_front();
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
    if (line.points.size() < kMaxTrackPoints) return;
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
