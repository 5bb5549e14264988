#include <headway/core/error.h>
#include <headway/io/track_file.h>

#include <ostream>

#include "text_rows.h"

namespace headway::io {
namespace {

TrackStatus statusFrom(const TextRows& rows, const std::string& name) {
  for (const TrackStatus status : {TrackStatus::kTentative, TrackStatus::kConfirmed,
                                   TrackStatus::kCoasting, TrackStatus::kEnded}) {
    if (toString(status) == name) return status;
  }
  rows.fail("'" + name + "' is not a track status");
}

ObjectClass classFrom(const TextRows& rows, const std::string& name) {
  const auto object_class = objectClassFrom(name);
  if (!object_class) rows.fail("'" + name + "' is not a class of objects");
  return *object_class;
}

TrackSample trackSample(const TextRows& rows, const CsvColumns& columns) {
  const auto number = [&](const char* name) { return rows.number(columns.at(name)); };
  TrackSample sample;
  sample.frame = rows.index(columns.at("frame"));
  sample.time = number("time");
  Track& track = sample.track;
  track.id.value = rows.integer(columns.at("track_id"));
  track.object_class = classFrom(rows, rows.fields()[columns.at("class")]);
  track.status = statusFrom(rows, rows.fields()[columns.at("status")]);
  // The column does not distinguish static tracks from unclassified ones.
  track.motion_state =
      rows.integer(columns.at("moving")) != 0 ? MotionState::kMoving : MotionState::kUnknown;
  track.position = {number("x"), number("y"), number("z")};
  track.yaw = number("yaw");
  track.size = {number("length"), number("width"), number("height")};
  track.velocity = {number("vx"), number("vy"), number("vz")};
  track.position_covariance(0, 0) = number("var_x");
  track.position_covariance(1, 1) = number("var_y");
  track.position_covariance(0, 1) = track.position_covariance(1, 0) = number("cov_xy");
  const auto optional = [&](const char* name) {
    const auto column = columns.find(name);
    return column ? rows.number(*column) : 0.0;
  };
  track.velocity_covariance(0, 0) = optional("var_vx");
  track.velocity_covariance(1, 1) = optional("var_vy");
  track.velocity_covariance(0, 1) = track.velocity_covariance(1, 0) = optional("cov_vxvy");
  track.last_seen = sample.time;
  return sample;
}

}  // namespace

std::string objectCsvHeader() {
  return "frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,vz,var_x,"
         "var_y,cov_xy";
}

std::string trackCsvHeader() { return objectCsvHeader() + ",var_vx,var_vy,cov_vxvy"; }

void writeTrackCsv(std::ostream& out, const TrackSample& row) {
  const Track& track = row.track;
  out << formatted("%zu,%.9f,%lld,", row.frame, row.time, static_cast<long long>(track.id.value))
      << toString(track.object_class) << ',' << toString(track.status)
      << formatted(
             ",%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.9g,%.9g,%.9g,"
             "%.9g,%.9g,%.9g\n",
             isMoving(track) ? 1 : 0, track.position.x(), track.position.y(), track.position.z(),
             track.yaw, track.size.x(), track.size.y(), track.size.z(), track.velocity.x(),
             track.velocity.y(), track.velocity.z(), track.position_covariance(0, 0),
             track.position_covariance(1, 1), track.position_covariance(0, 1),
             track.velocity_covariance(0, 0), track.velocity_covariance(1, 1),
             track.velocity_covariance(0, 1));
}

void visitTrackCsv(const std::string& path, const std::function<void(const TrackSample&)>& visit) {
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; the header line is missing");
  const CsvColumns columns(rows, objectCsvHeader());
  while (rows.next()) {
    columns.requireComplete(rows);
    visit(trackSample(rows, columns));
  }
}

std::vector<TrackSample> readTrackCsv(const std::string& path) {
  std::vector<TrackSample> samples;
  visitTrackCsv(path, [&](const TrackSample& sample) { samples.push_back(sample); });
  return samples;
}

std::string predictionCsvHeader() {
  return "frame,time,track_id,class,mode,probability,horizon_s,x,y,z,cov_xx,cov_xy,cov_yy";
}

void writePredictionCsv(std::ostream& out, const PredictionRow& row) {
  const auto& [horizon_s, position, covariance] = row.point;
  out << formatted("%zu,%.9f,%lld,", row.frame, row.time, static_cast<long long>(row.id.value))
      << toString(row.object_class)
      << formatted(",%d,%.6f,%.3f,%.6f,%.6f,%.6f,%.9g,%.9g,%.9g\n", row.mode, row.probability,
                   horizon_s, position.x(), position.y(), position.z(), covariance(0, 0),
                   covariance(0, 1), covariance(1, 1));
}

std::vector<PredictionRow> readPredictionCsv(const std::string& path) {
  std::vector<PredictionRow> result;
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; the header line is missing");
  const CsvColumns columns(rows, predictionCsvHeader());
  const auto number = [&](const char* name) { return rows.number(columns.at(name)); };
  while (rows.next()) {
    columns.requireComplete(rows);
    PredictionRow row;
    row.frame = rows.index(columns.at("frame"));
    row.time = number("time");
    row.id.value = rows.integer(columns.at("track_id"));
    row.object_class = classFrom(rows, rows.fields()[columns.at("class")]);
    row.mode = static_cast<int>(rows.integer(columns.at("mode")));
    row.probability = number("probability");
    row.point.horizon_s = number("horizon_s");
    row.point.position = {number("x"), number("y"), number("z")};
    row.point.covariance(0, 0) = number("cov_xx");
    row.point.covariance(0, 1) = row.point.covariance(1, 0) = number("cov_xy");
    row.point.covariance(1, 1) = number("cov_yy");
    result.push_back(row);
  }
  return result;
}

}  // namespace headway::io
