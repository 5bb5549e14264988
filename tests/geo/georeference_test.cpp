// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/random.h>
#include <headway/geo/georeference.h>

#include <cmath>

namespace headway::geo {
namespace {

using ::testing::HasSubstr;

constexpr double kDegree = M_PI / 180.0;

/// A drive of 300 m around a corner, with a receiver on the robot.
struct Drive {
  double length_m = 300.0;
  double rate_m = 1.5;  ///< between two fixes
  double sigma_m = 1.0;
  double outlier_ratio = 0.05;
  double heading_deg = 30.0;
  double tilt_deg = 0.0;  ///< of the map about its y axis
  bool is_straight = false;
  std::uint64_t seed = 1;

  [[nodiscard]] GeodeticFrame world() const { return GeodeticFrame({48.0, 11.0, 500.0}); }
  [[nodiscard]] Pose T_enu_map() const {
    Pose pose = Pose::Identity();
    pose.linear() = (Eigen::AngleAxisd((90.0 - heading_deg) * kDegree, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(tilt_deg * kDegree, Eigen::Vector3d::UnitY()))
                        .toRotationMatrix();
    return pose;
  }
  [[nodiscard]] Eigen::Vector3d positionAt(double way) const {
    const double corner = 0.5 * length_m;
    if (is_straight || way < corner) return {way, 0.0, 0.0};
    return {corner, way - corner, 0.0};
  }
  [[nodiscard]] std::vector<FixOnMap> fixes() const {
    Random random(seed);
    std::vector<FixOnMap> result;
    for (double way = 0.0; way <= length_m; way += rate_m) {
      FixOnMap sample;
      sample.in_map = positionAt(way);
      sample.fix.time = way / 7.0;
      Eigen::Vector3d enu = T_enu_map() * sample.in_map;
      enu += sigma_m * Eigen::Vector3d(random.normal(), random.normal(), 1.7 * random.normal());
      if (random.chance(outlier_ratio)) {
        const double direction = random.uniform(0.0, 2.0 * M_PI);
        const double distance = random.uniform(10.0, 60.0);
        enu += distance * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.3);
      }
      const auto position = world().positionOf(enu);
      sample.fix.latitude_deg = position.latitude_deg;
      sample.fix.longitude_deg = position.longitude_deg;
      sample.fix.altitude_m = position.altitude_m;
      sample.fix.sigma_m = sigma_m;
      result.push_back(sample);
    }
    return result;
  }
};

Georeference placed(const std::vector<FixOnMap>& fixes) {
  const auto result = georeference(fixes);
  const auto* reference = std::get_if<Georeference>(&result);
  if (reference != nullptr) return *reference;
  ADD_FAILURE() << std::get<NoGeoreference>(result).reason;
  return {};
}

std::string reasonOf(const std::vector<FixOnMap>& fixes) {
  const auto result = georeference(fixes);
  const auto* none = std::get_if<NoGeoreference>(&result);
  return none != nullptr ? none->reason : "";
}

double headingError(const Georeference& reference, const Drive& drive) {
  return std::remainder(reference.headingDeg() - drive.heading_deg, 360.0);
}

Eigen::Vector3d originError(const Georeference& reference, const Drive& drive) {
  return drive.world().enuOf(reference.frame.origin());
}

TEST(GeoreferenceTest, ExactFixesGiveTheExactPlace) {
  Drive drive;
  drive.sigma_m = 0.0;
  drive.outlier_ratio = 0.0;
  for (const double heading : {0.0, 90.0, 200.0, 359.0}) {
    drive.heading_deg = heading;
    const auto reference = placed(drive.fixes());
    EXPECT_NEAR(0.0, headingError(reference, drive), 1e-3) << heading;
    EXPECT_LT(originError(reference, drive).norm(), 0.01) << heading;
    EXPECT_EQ(0u, reference.rejected);
  }
}

TEST(GeoreferenceTest, NoiseAndOutliersOnThreeHundredMetres) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Drive drive;
    drive.seed = seed;
    const auto reference = placed(drive.fixes());
    EXPECT_LT(std::abs(headingError(reference, drive)), 0.5) << seed;
    EXPECT_LT(originError(reference, drive).head<2>().norm(), 0.5) << seed;
    EXPECT_GE(reference.rejected, 3u) << seed;
  }
}

TEST(GeoreferenceTest, FortyPercentOfWrongFixesAreRejected) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Drive drive;
    drive.seed = seed;
    drive.outlier_ratio = 0.4;
    const auto reference = placed(drive.fixes());
    EXPECT_LT(std::abs(headingError(reference, drive)), 0.7) << seed;
    EXPECT_LT(originError(reference, drive).head<2>().norm(), 1.0) << seed;
  }
}

TEST(GeoreferenceTest, StatedCovarianceCoversTheErrors) {
  double heading = 0.0, origin = 0.0;
  constexpr int kDrives = 100;
  for (int i = 0; i < kDrives; ++i) {
    Drive drive;
    drive.seed = 1000 + static_cast<std::uint64_t>(i);
    const auto reference = placed(drive.fixes());
    heading += std::pow(headingError(reference, drive) / reference.headingSigmaDeg(), 2) / kDrives;
    origin += originError(reference, drive).head<2>().squaredNorm() /
              std::pow(reference.originSigma(), 2) / kDrives;
  }
  EXPECT_GT(heading, 0.4);
  EXPECT_LT(heading, 1.5);
  EXPECT_GT(origin, 0.4);
  EXPECT_LT(origin, 1.5);
}

TEST(GeoreferenceTest, AccurateFixesCountMore) {
  Drive good, bad;
  good.sigma_m = 0.1;
  bad.sigma_m = 6.0;
  bad.seed = 7;
  auto fixes = good.fixes();
  for (const auto& fix : bad.fixes()) fixes.push_back(fix);
  const auto reference = placed(fixes);
  EXPECT_LT(std::abs(headingError(reference, good)), 0.05);
  EXPECT_LT(originError(reference, good).head<2>().norm(), 0.1);
}

TEST(GeoreferenceTest, AltitudesTiltAMapThatIsNotLevel) {
  Drive drive;
  drive.tilt_deg = 3.0;
  drive.sigma_m = 0.2;
  const auto reference = placed(drive.fixes());
  EXPECT_LT(logSo3(drive.T_enu_map().linear().transpose() * reference.T_enu_map.linear()).norm(),
            0.3 * kDegree);
}

TEST(GeoreferenceTest, AStraightWayLeavesTheTiltAboutItLevel) {
  Drive drive;
  drive.is_straight = true;
  const auto reference = placed(drive.fixes());
  EXPECT_LT(std::abs(headingError(reference, drive)), 0.5);
  const Eigen::Vector3d left = reference.T_enu_map.linear().col(1);
  EXPECT_NEAR(0.0, left.z(), 1e-3);
}

TEST(GeoreferenceTest, TooFewFixesAreRefused) {
  auto fixes = Drive().fixes();
  fixes.resize(9);
  EXPECT_THAT(reasonOf(fixes), HasSubstr("only 9 fixes"));
  EXPECT_THAT(reasonOf({}), HasSubstr("only 0 fixes"));
}

TEST(GeoreferenceTest, AShortWayIsRefused) {
  Drive drive;
  drive.length_m = 4.0;
  drive.rate_m = 0.1;
  EXPECT_THAT(reasonOf(drive.fixes()), HasSubstr("too short for a heading (2"));
  drive.length_m = 12.0;
  drive.sigma_m = 4.0;
  EXPECT_THAT(reasonOf(drive.fixes()), HasSubstr("too short for a heading (8."));
}

TEST(GeoreferenceTest, FixesOfAnotherWayAreRefused) {
  auto fixes = Drive().fixes();
  Random random(5);
  for (auto& sample : fixes) {
    sample.in_map = {random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), 0.0};
  }
  EXPECT_NE("", reasonOf(fixes));
}

TEST(GeoreferenceTest, AMapOfAWrongScaleIsRefused) {
  auto fixes = Drive().fixes();
  for (auto& sample : fixes) sample.in_map *= 3.0;  // of three times the scale
  EXPECT_NE("", reasonOf(fixes));
}

}  // namespace
}  // namespace headway::geo
