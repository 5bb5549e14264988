// SPDX-License-Identifier: BSD-3-Clause
// Lines of positions as GeoJSON.
#include <headway/geo/geojson.h>

#include <cstdio>

namespace headway::geo {
namespace {

void writeCoordinates(std::ostream& out, const GeodeticPosition& position) {
  char text[96];
  std::snprintf(text, sizeof text, "[%.9f,%.9f,%.3f]", position.longitude_deg,
                position.latitude_deg, position.altitude_m);
  out << text;
}

void writeTimes(std::ostream& out, const std::vector<GeoPoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    char text[48];
    std::snprintf(text, sizeof text, "%s%.6f", i == 0 ? "" : ",", points[i].time);
    out << text;
  }
}

}  // namespace

GeoJsonLines::GeoJsonLines(std::ostream& out) : out_(out) {
  out_ << "{\"type\":\"FeatureCollection\",\"features\":[";
}

void GeoJsonLines::add(const std::string& properties, const std::vector<GeoPoint>& points) {
  if (points.empty()) return;
  out_ << (is_first_ ? "\n" : ",\n") << "{\"type\":\"Feature\",\"properties\":{" << properties
       << (properties.empty() ? "" : ",") << "\"times\":[";
  is_first_ = false;
  writeTimes(out_, points);
  const bool is_line = points.size() > 1;
  out_ << "]},\"geometry\":{\"type\":\"" << (is_line ? "LineString" : "Point")
       << "\",\"coordinates\":" << (is_line ? "[" : "");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) out_ << ',';
    writeCoordinates(out_, points[i].position);
  }
  out_ << (is_line ? "]" : "") << "}}";
}

void GeoJsonLines::end() { out_ << "\n]}\n"; }

}  // namespace headway::geo
