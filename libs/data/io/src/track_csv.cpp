// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/track_file.h>

#include <array>
#include <cmath>
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

namespace {

void visitSamples(
    const std::string& path,
    const std::function<void(const TrackSample&, const TextRows&, const CsvColumns&)>& visit) {
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; the header line is missing");
  const CsvColumns columns(rows, objectCsvHeader());
  while (rows.next()) {
    columns.requireComplete(rows);
    visit(trackSample(rows, columns), rows, columns);
  }
}

}  // namespace

void visitTrackCsv(const std::string& path, const std::function<void(const TrackSample&)>& visit) {
  visitSamples(
      path, [&](const TrackSample& sample, const TextRows&, const CsvColumns&) { visit(sample); });
}

std::vector<ObjectSample> readObjectCsv(const std::string& path) {
  std::vector<ObjectSample> objects;
  visitSamples(path,
               [&](const TrackSample& sample, const TextRows& rows, const CsvColumns& columns) {
                 const auto visible = columns.find("visible");
                 objects.push_back({sample, visible ? rows.number(*visible) : 1.0});
               });
  return objects;
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

namespace {

bool isMultiple(double value, double step) {
  return !(step > 0.0) || std::abs(value / step - std::round(value / step)) < 0.01;
}

}  // namespace

void visitPredictionCsv(const std::string& path,
                        const std::function<void(const PredictionRow&)>& visit,
                        double horizon_step_s) {
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; the header line is missing");
  const CsvColumns columns(rows, predictionCsvHeader());
  const auto at = [&](const char* name) { return columns.at(name); };
  const std::array<std::size_t, 6> place = {at("x"),      at("y"),      at("z"),
                                            at("cov_xx"), at("cov_xy"), at("cov_yy")};
  const std::size_t frame = at("frame"), time = at("time"), id = at("track_id");
  const std::size_t object_class = at("class"), mode = at("mode"), probability = at("probability");
  const std::size_t horizon = at("horizon_s");
  while (rows.next()) {
    columns.requireComplete(rows);
    PredictionRow row;
    row.point.horizon_s = rows.number(horizon);
    if (!isMultiple(row.point.horizon_s, horizon_step_s)) continue;
    row.frame = rows.index(frame);
    row.time = rows.number(time);
    row.id.value = rows.integer(id);
    row.object_class = classFrom(rows, rows.fields()[object_class]);
    row.mode = static_cast<int>(rows.integer(mode));
    row.probability = rows.number(probability);
    const auto value = [&](std::size_t i) { return rows.number(place[i]); };
    row.point.position = {value(0), value(1), value(2)};
    // Read first: an error would leave the matrix half filled.
    const double xx = value(3), xy = value(4), yy = value(5);
    row.point.covariance << xx, xy, xy, yy;
    visit(row);
  }
}

std::vector<PredictionRow> readPredictionCsv(const std::string& path) {
  std::vector<PredictionRow> result;
  visitPredictionCsv(path, [&](const PredictionRow& row) { result.push_back(row); });
  return result;
}

}  // namespace headway::io
