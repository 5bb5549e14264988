// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/detection.h>
#include <headway/core/error.h>
#include <headway/io/track_file.h>

#include <array>
#include <filesystem>
#include <functional>
#include <iomanip>
#include <sstream>

#include "text_rows.h"

namespace headway::io {
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
