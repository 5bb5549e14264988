// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/eval/trajectory_error.h>

#include <limits>

namespace headway::eval {
namespace {

using Trajectory = std::vector<Stamped<Pose>>;

Pose at(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

/// Poses whose x is their time.
Trajectory atTimes(const std::vector<double>& times) {
  Trajectory trajectory;
  for (const double time : times) trajectory.push_back({time, at(time)});
  return trajectory;
}

std::vector<std::pair<double, double>> pairedTimes(const PosePairs& pairs) {
  std::vector<std::pair<double, double>> result;
  for (const auto& p : pairs.pairs) {
    result.emplace_back(p.truth.translation().x(), p.estimate.translation().x());
  }
  return result;
}

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

TEST(PosePairsTest, PairsTheNearestWithinTheTolerance) {
  const auto pairs = pairByTime(atTimes({0.0, 0.1, 0.2, 0.3}), atTimes({0.11, 0.26, 0.9}), 0.05);
  EXPECT_THAT(pairedTimes(pairs), ElementsAre(Pair(0.1, 0.11), Pair(0.3, 0.26)));
  EXPECT_EQ(4u, pairs.truth_poses);
  EXPECT_EQ(3u, pairs.estimate_poses);
}

TEST(PosePairsTest, PairsATruePoseOnlyWithTheNearestEstimate) {
  const auto pairs = pairByTime(atTimes({0.0, 1.0}), atTimes({0.9, 0.98, 1.05}), 0.2);
  EXPECT_THAT(pairedTimes(pairs), ElementsAre(Pair(1.0, 0.98)));
}

TEST(PosePairsTest, OrderOfRowsDoesNotMatter) {
  const auto pairs = pairByTime(atTimes({0.2, 0.0, 0.1}), atTimes({0.1, 0.2, 0.0}), 0.01);
  EXPECT_THAT(pairedTimes(pairs), ElementsAre(Pair(0.0, 0.0), Pair(0.1, 0.1), Pair(0.2, 0.2)));
}

TEST(PosePairsTest, ByIndexEndsWithTheShorter) {
  const auto pairs = pairByIndex({at(0), at(1), at(2)}, {at(5), at(6)});
  EXPECT_THAT(pairedTimes(pairs), ElementsAre(Pair(0, 5), Pair(1, 6)));
  EXPECT_EQ(3u, pairs.truth_poses);
  EXPECT_EQ(2u, pairs.estimate_poses);
}

TEST(PosePairsTest, NoOverlapInTimeNamesBothSpans) {
  try {
    (void)pairByTime(atTimes({0.0, 1.0}), atTimes({100.0, 101.0}), 0.02);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("0.000000 .. 1.000000 s"));
    EXPECT_THAT(error.what(), HasSubstr("100.000000 .. 101.000000 s"));
  }
}

TEST(PosePairsTest, EmptyAndNotFiniteAreErrors) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)pairByTime({}, atTimes({0.0}), 1.0), InputError);
  EXPECT_THROW((void)pairByTime(atTimes({0.0}), {}, 1.0), InputError);
  EXPECT_THROW((void)pairByTime(atTimes({0.0}), {{0.0, at(nan)}}, 1.0), InputError);
  EXPECT_THROW((void)pairByTime({{nan, at(0.0)}}, atTimes({0.0}), 1.0), InputError);
  EXPECT_THROW((void)pairByIndex({}, {at(0)}), InputError);
  EXPECT_THROW((void)pairByIndex({at(0)}, {}), InputError);
  EXPECT_THROW((void)pairByIndex({at(nan)}, {at(0)}), InputError);
}

}  // namespace
}  // namespace headway::eval
