// SPDX-License-Identifier: BSD-3-Clause
// Local frames on the earth (WGS 84).
#include <headway/geo/geodetic_frame.h>
#include <mrpt/topography/conversions.h>

#include <algorithm>
#include <cmath>

namespace headway::geo {
namespace {

mrpt::topography::TGeodeticCoords mrptCoords(const GeodeticPosition& position) {
  return {position.latitude_deg, position.longitude_deg, position.altitude_m};
}

}  // namespace

Eigen::Vector3d GeodeticFrame::enuOf(const GeodeticPosition& position) const {
  mrpt::math::TPoint3D enu;
  mrpt::topography::geodeticToENU_WGS84(mrptCoords(position), enu, mrptCoords(origin_));
  return {enu.x, enu.y, enu.z};
}

GeodeticPosition GeodeticFrame::positionOf(const Eigen::Vector3d& enu) const {
  const auto ellipsoid = mrpt::topography::TEllipsoid::Ellipsoid_WGS84();
  mrpt::topography::TGeocentricCoords geocentric;
  mrpt::topography::ENUToGeocentric({enu.x(), enu.y(), enu.z()}, mrptCoords(origin_), geocentric,
                                    ellipsoid);
  mrpt::topography::TGeodeticCoords geodetic;
  mrpt::topography::geocentricToGeodetic(geocentric, geodetic, ellipsoid);
  return refined({geodetic.lat.getDecimalValue(), geodetic.lon.getDecimalValue(), geodetic.height},
                 enu);
}

/// MRPT's inverse deviates by up to 3 m; its forward conversion is exact, and corrects it.
GeodeticPosition GeodeticFrame::refined(GeodeticPosition position,
                                        const Eigen::Vector3d& enu) const {
  const double radius = mrpt::topography::TEllipsoid::Ellipsoid_WGS84().sa;  // [m]
  constexpr int kIterations = 4;  // each leaves a hundredth of the error
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Vector3d error = enu - enuOf(position);
    const double parallel = std::max(std::cos(position.latitude_deg * kDegree), 1e-6);
    position.latitude_deg += error.y() / (kDegree * radius);
    position.longitude_deg += error.x() / (kDegree * radius * parallel);
    position.altitude_m += error.z();
  }
  return position;
}

}  // namespace headway::geo
