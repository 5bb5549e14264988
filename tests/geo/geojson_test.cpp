// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/geo/geojson.h>

#include <sstream>

namespace headway::geo {
namespace {

TEST(GeoJsonTest, LinesAndPoints) {
  std::ostringstream out;
  GeoJsonLines lines(out);
  lines.add("\"name\":\"robot\"", {{1.5, {48.0, 11.0, 500.0}}, {2.0, {48.1, 11.25, 501.5}}});
  lines.add("", {{3.0, {-1.0, -2.0, 0.0}}});
  lines.add("\"name\":\"nothing\"", {});
  lines.end();
  EXPECT_EQ(
      "{\"type\":\"FeatureCollection\",\"features\":[\n"
      "{\"type\":\"Feature\",\"properties\":{\"name\":\"robot\",\"times\":[1.500000,2.000000]},"
      "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[11.000000000,48.000000000,500.000],"
      "[11.250000000,48.100000000,501.500]]}},\n"
      "{\"type\":\"Feature\",\"properties\":{\"times\":[3.000000]},"
      "\"geometry\":{\"type\":\"Point\",\"coordinates\":[-2.000000000,-1.000000000,0.000]}}\n"
      "]}\n",
      out.str());
}

TEST(GeoJsonTest, ACollectionMayBeEmpty) {
  std::ostringstream out;
  GeoJsonLines(out).end();
  EXPECT_EQ("{\"type\":\"FeatureCollection\",\"features\":[\n]}\n", out.str());
}

}  // namespace
}  // namespace headway::geo
