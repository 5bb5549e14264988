// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/track_file.h>

#include <ostream>

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

}  // namespace

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

}  // namespace headway::io
