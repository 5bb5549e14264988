// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/geo/geodetic_frame.h>

#include <cmath>

namespace headway::geo {
namespace {

TEST(GeodeticFrameTest, ItsOriginIsZero) {
  const GeodeticFrame frame({49.01, 8.43, 115.0});
  EXPECT_LT(frame.enuOf({49.01, 8.43, 115.0}).norm(), 1e-6);
}

TEST(GeodeticFrameTest, AxesAreEastNorthUp) {
  const GeodeticFrame frame({49.0, 8.0, 100.0});
  // A minute of latitude at 49 degrees is 1853.5 m, one of longitude 1219.9 m (WGS 84).
  const Eigen::Vector3d north = frame.enuOf({49.0 + 1.0 / 60.0, 8.0, 100.0});
  EXPECT_NEAR(1853.5, north.y(), 1.0);
  EXPECT_NEAR(0.0, north.x(), 0.01);
  EXPECT_NEAR(1219.9, frame.enuOf({49.0, 8.0 + 1.0 / 60.0, 100.0}).x(), 1.0);
  EXPECT_NEAR(7.0, frame.enuOf({49.0, 8.0, 107.0}).z(), 1e-6);
}

TEST(GeodeticFrameTest, PositionOfIsTheInverse) {
  for (const double latitude : {-77.5, -0.001, 0.0, 35.2, 84.0}) {
    for (const double longitude : {-179.9, -8.0, 0.0, 144.9}) {
      const GeodeticFrame frame({latitude, longitude, 320.0});
      const Eigen::Vector3d enu(1830.0, -940.0, 25.0);
      EXPECT_LT((frame.enuOf(frame.positionOf(enu)) - enu).norm(), 1e-3)
          << latitude << ", " << longitude;
    }
  }
}

}  // namespace
}  // namespace headway::geo
