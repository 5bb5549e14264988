// SPDX-License-Identifier: BSD-3-Clause
// Files of boxes, tracks and predictions: KITTI's rows and headway's CSV.
#include <headway/core/detection.h>
#include <headway/core/error.h>
#include <headway/io/track_file.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "text_rows.h"

namespace headway::io {
namespace {

std::string labelColumns(const KittiRow& row) {
  return formatted(
      "%zu %lld %s %.2f %d %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f", row.frame,
      static_cast<long long>(row.id), row.type.c_str(), row.truncation, row.occlusion, row.alpha,
      row.box2d.left, row.box2d.top, row.box2d.right, row.box2d.bottom, row.height, row.width,
      row.length, row.bottom_centre.x(), row.bottom_centre.y(), row.bottom_centre.z(),
      row.rotation_y);
}

constexpr const char* kSittingInLabels = "Person";  // of the tracking benchmark

bool hasBox2d(const KittiRow& row) {
  return !(row.box2d.left == row.box2d.right && row.box2d.top == row.box2d.bottom);
}

bool hasBox3d(const KittiRow& row) {
  return !(row.height < 0.0 && row.width < 0.0 && row.length < 0.0);
}

/// The current row as a KITTI label (17 fields, score 1) or result (18 fields, with a score).
KittiRow kittiRow(const TextRows& rows) {
  if (rows.size() != 17 && rows.size() != 18) {
    rows.fail("has " + std::to_string(rows.size()) +
              " fields; a KITTI label has 17, a result 18 (with the score)");
  }
  KittiRow row;
  row.frame = rows.index(0);
  row.id = rows.integer(1);
  row.type = rows.fields()[2] == kSittingInLabels ? "Person_sitting" : rows.fields()[2];
  row.truncation = rows.number(3);
  row.occlusion = static_cast<int>(rows.integer(4));
  row.alpha = rows.number(5);
  row.box2d = {rows.number(6), rows.number(7), rows.number(8), rows.number(9)};
  row.height = rows.number(10);
  row.width = rows.number(11);
  row.length = rows.number(12);
  row.bottom_centre = {rows.number(13), rows.number(14), rows.number(15)};
  row.rotation_y = rows.number(16);
  row.score = rows.size() == 18 ? rows.number(17) : 1.0;  // labels have no score
  if (rows.size() == 18) row.visible = row.score;
  return row;
}

}  // namespace

std::vector<KittiRow> readKittiRows(const std::string& path) {
  std::vector<KittiRow> result;
  TextRows rows(path);
  while (rows.next()) result.push_back(kittiRow(rows));
  return result;
}

void writeKittiResult(std::ostream& out, const KittiRow& row) {
  out << labelColumns(row) << formatted(" %.6f\n", row.score);
}

void writeKittiLabel(std::ostream& out, const KittiRow& row, bool with_visible) {
  out << labelColumns(row);
  if (with_visible) out << formatted(" %.6f", row.visible);
  out << '\n';
}

std::optional<Detection> detectionFrom(const KittiRow& row) {
  const auto object_class = objectClassFrom(row.type);
  if (!object_class) return std::nullopt;
  Detection detection;
  detection.object_class = *object_class;
  detection.score = row.score;
  if (row.id >= 0) detection.detector_id = row.id;
  if (hasBox2d(row)) detection.box2d = row.box2d;
  if (hasBox3d(row)) {
    Box3d box;
    box.centre = row.bottom_centre - Eigen::Vector3d(0.0, 0.5 * row.height, 0.0);
    box.length = row.length;
    box.width = row.width;
    box.height = row.height;
    box.yaw = row.rotation_y;
    detection.box3d = box;
  }
  return detection;
}

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

namespace {

using FrameDetection = std::pair<std::size_t, Detection>;

constexpr char kCsvRequired[] = "frame,class";
constexpr char kCsvKnown[] =
    "frame,class,score,id,left,top,right,bottom,x,y,z,length,width,height,yaw,cov_xx,cov_xy,cov_xz,"
    "cov_yy,cov_yz,cov_zz";

/// Thrown for a row without a detection, with the reason.
struct RowDropped {
  const char* reason;
};

ObjectClass classNamed(const std::string& name) {
  const auto object_class = objectClassFrom(name);
  if (!object_class) throw RowDropped{name == "DontCare" ? "dont_care" : "unknown_class"};
  return *object_class;
}

FrameDetection fromKitti(const KittiRow& row) {
  classNamed(row.type);
  return {row.frame, *detectionFrom(row)};
}

/// `frame,type,x1,y1,x2,y2,score,h,w,l,x,y,z,ry,alpha` with types 1 pedestrian, 2 car, 3 cyclist.
FrameDetection fromDet3d(const TextRows& rows) {
  const std::array<const char*, 4> names = {"", "Pedestrian", "Car", "Cyclist"};
  const auto type = rows.integer(1);
  KittiRow row;
  row.frame = rows.index(0);
  row.type = type >= 1 && type <= 3 ? names[static_cast<std::size_t>(type)] : "";
  row.box2d = {rows.number(2), rows.number(3), rows.number(4), rows.number(5)};
  row.score = rows.number(6);
  row.height = rows.number(7);
  row.width = rows.number(8);
  row.length = rows.number(9);
  row.bottom_centre = {rows.number(10), rows.number(11), rows.number(12)};
  row.rotation_y = rows.number(13);
  return fromKitti(row);
}

/// `frame,x1,y1,x2,y2,score`, all of one class.
FrameDetection fromDet2d(const TextRows& rows, ObjectClass object_class) {
  Detection detection;
  detection.object_class = object_class;
  detection.box2d = Box2d{rows.number(1), rows.number(2), rows.number(3), rows.number(4)};
  detection.score = rows.number(5);
  return {rows.index(0), detection};
}

/// Values of the columns; nullopt if a column is missing or empty in this row.
template <std::size_t N>
std::optional<std::array<double, N>> group(const TextRows& rows, const CsvColumns& columns,
                                           const std::array<const char*, N>& names) {
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto column = columns.find(names[i]);
    if (!column || rows.fields()[*column].empty()) return std::nullopt;
    values[i] = rows.number(*column);
  }
  return values;
}

FrameDetection fromCsv(const TextRows& rows, const CsvColumns& columns) {
  columns.requireComplete(rows);
  Detection detection;
  detection.object_class = classNamed(rows.fields()[columns.at("class")]);
  if (const auto score = group<1>(rows, columns, {"score"})) detection.score = (*score)[0];
  const auto id = columns.find("id");
  if (id && !rows.fields()[*id].empty() && rows.integer(*id) >= 0) {
    detection.detector_id = rows.integer(*id);
  }
  if (const auto b = group<4>(rows, columns, {"left", "top", "right", "bottom"})) {
    detection.box2d = Box2d{(*b)[0], (*b)[1], (*b)[2], (*b)[3]};
  }
  if (const auto b = group<7>(rows, columns, {"x", "y", "z", "length", "width", "height", "yaw"})) {
    detection.box3d = Box3d{{(*b)[0], (*b)[1], (*b)[2]}, (*b)[3], (*b)[4], (*b)[5], (*b)[6]};
  }
  if (const auto c =
          group<6>(rows, columns, {"cov_xx", "cov_xy", "cov_xz", "cov_yy", "cov_yz", "cov_zz"})) {
    detection.centre_covariance.emplace();
    *detection.centre_covariance << (*c)[0], (*c)[1], (*c)[2],  //
        (*c)[1], (*c)[3], (*c)[4],                              //
        (*c)[2], (*c)[4], (*c)[5];
  }
  if (!detection.box2d && !detection.box3d) throw RowDropped{"no_box"};
  return {rows.index(columns.at("frame")), detection};
}

using RowReader = std::function<FrameDetection(const TextRows&)>;

/// Selects the reader of a file's rows by its first row.
///
/// @param is_header  set if that row is a header
RowReader readerFor(const std::string& path, const TextRows& first, bool& is_header) {
  is_header = first.isCommaSeparated() && !parseNumber(first.fields()[0]);
  if (is_header) {
    const CsvColumns columns(first, kCsvRequired);
    if (const auto unknown = columns.unknownTo(kCsvKnown)) {
      first.fail("column '" + *unknown + "' is unknown; known are " + kCsvKnown);
    }
    return [columns](const TextRows& rows) { return fromCsv(rows, columns); };
  }
  if (first.isCommaSeparated() && first.size() == 15) return fromDet3d;
  if (first.isCommaSeparated() && first.size() == 6) {
    const std::string folder = std::filesystem::absolute(path).parent_path().filename().string();
    const auto object_class = objectClassFrom(folder);
    if (!object_class) {
      first.fail("rows of 2D boxes contain no class, and the file's folder '" + folder +
                 "' is not a class name; move the file to a folder such as 'Car'");
    }
    return [object_class](const TextRows& rows) { return fromDet2d(rows, *object_class); };
  }
  if (!first.isCommaSeparated() && (first.size() == 17 || first.size() == 18)) {
    return [](const TextRows& rows) { return fromKitti(kittiRow(rows)); };
  }
  first.fail("has " + std::to_string(first.size()) +
             " fields: neither KITTI's labels or results, nor detector rows of 6 or 15 fields, nor "
             "a CSV file whose header starts with 'frame'");
}

/// Writes values as CSV fields, each after a comma; empty fields without values.
template <std::size_t N>
void writeFields(std::ostream& out, const std::optional<std::array<double, N>>& values) {
  for (std::size_t i = 0; i < N; ++i) {
    out << ',';
    if (values) out << (*values)[i];
  }
}

}  // namespace

std::string detectionCsvHeader() { return kCsvKnown; }

void writeDetectionCsv(std::ostream& out, std::size_t frame, const Detection& detection) {
  std::optional<std::array<double, 4>> image;
  if (const auto& b = detection.box2d) image = {b->left, b->top, b->right, b->bottom};
  std::optional<std::array<double, 7>> space;
  if (const auto& b = detection.box3d) {
    space = {b->centre.x(), b->centre.y(), b->centre.z(), b->length, b->width, b->height, b->yaw};
  }
  std::optional<std::array<double, 6>> covariance;
  if (const auto& c = detection.centre_covariance) {
    covariance = {(*c)(0, 0), (*c)(0, 1), (*c)(0, 2), (*c)(1, 1), (*c)(1, 2), (*c)(2, 2)};
  }
  std::ostringstream row;
  row << std::setprecision(7) << frame << ',' << toString(detection.object_class) << ','
      << detection.score << ',';
  if (detection.detector_id) row << *detection.detector_id;
  writeFields(row, image);
  writeFields(row, space);
  writeFields(row, covariance);
  out << row.str() << '\n';
}

std::map<std::size_t, Detections> readDetections(const std::string& path,
                                                 std::map<std::string, std::size_t>& dropped) {
  std::map<std::size_t, Detections> frames;
  TextRows rows(path);
  if (!rows.next()) return frames;
  bool is_header = false;
  const RowReader reader = readerFor(path, rows, is_header);
  const std::size_t size = rows.size();
  if (is_header && !rows.next()) return frames;
  do {
    try {
      if (rows.size() != size) throw RowDropped{"bad_row"};
      auto [frame, detection] = reader(rows);
      if (!isPlausible(detection)) throw RowDropped{"implausible_box"};
      removeBadCovariance(detection, dropped);
      frames[frame].items.push_back(std::move(detection));
    } catch (const RowDropped& drop) {
      ++dropped[drop.reason];
    } catch (const InputError&) {
      ++dropped["bad_row"];
    }
  } while (rows.next());
  return frames;
}

}  // namespace headway::io
