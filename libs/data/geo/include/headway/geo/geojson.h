// SPDX-License-Identifier: BSD-3-Clause
// Lines of positions as GeoJSON.
#pragma once

#include <headway/core/pose.h>
#include <headway/geo/geodetic_frame.h>

#include <ostream>
#include <string>
#include <vector>

namespace headway::geo {

/// A position at a time.
struct GeoPoint {
  Time time = 0.0;
  GeodeticPosition position;
};

/// Writes lines of positions as a GeoJSON feature collection (RFC 7946), one feature a row:
/// coordinates are longitude, latitude [deg] and height above the ellipsoid [m]; the property
/// `times` has the time of each position.
///
///     GeoJsonLines lines(file.stream());
///     lines.add("\"track_id\": 7", points);
///     lines.end();
class GeoJsonLines {
 public:
  explicit GeoJsonLines(std::ostream& out);

  /// A line, or a point if there is only one; nothing if there is none.
  ///
  /// @param properties  further members of `properties`, as JSON; may be empty
  void add(const std::string& properties, const std::vector<GeoPoint>& points);
  void end();

 private:
  std::ostream& out_;
  bool is_first_ = true;
};

}  // namespace headway::geo
