// SPDX-License-Identifier: BSD-3-Clause
#include "geo_files.h"

#include <headway/core/output_file.h>
#include <headway/geo/geojson.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

namespace headway::replay {
namespace {

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

}  // namespace

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

}  // namespace headway::replay
