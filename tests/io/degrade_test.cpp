// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/degrade.h>
#include <headway_test/input_error.h>

#include <cmath>

namespace headway::io {
namespace {

constexpr int kBoxes = 20000;

Detections manyBoxes(double depth, double score = 1.0) {
  Detections detections;
  for (int i = 0; i < kBoxes; ++i) {
    Detection detection;
    detection.score = score;
    detection.detector_id = i;
    detection.box2d = Box2d{1, 2, 3, 4};
    detection.box3d = Box3d{{0, 1, depth}, 4, 2, 1.5, 0.25};
    detections.items.push_back(detection);
  }
  return detections;
}

DegradeParams nothing() {
  DegradeParams params;
  params.position_sigma_m = 0.0;
  params.drop_probability = params.duplicate_probability = params.flip_probability = 0.0;
  return params;
}

double deviation(const Detections& detections, int axis, double mean) {
  double sum = 0.0;
  for (const auto& item : detections.items) sum += std::pow(item.box3d->centre[axis] - mean, 2);
  return std::sqrt(sum / static_cast<double>(detections.items.size()));
}

TEST(DegradeTest, KeepsBoxesWithoutNoise) {
  const auto result = Degrader(nothing()).degrade(manyBoxes(20));
  ASSERT_EQ(kBoxes, static_cast<int>(result.items.size()));
  EXPECT_EQ(Eigen::Vector3d(0, 1, 20), result.items[7].box3d->centre);
  EXPECT_EQ(0.25, result.items[7].box3d->yaw);
  EXPECT_EQ(7, result.items[7].detector_id);
}

TEST(DegradeTest, NoiseGrowsWithDepthAndIsHalfAcrossTheRay) {
  auto params = nothing();
  params.position_sigma_m = 0.3;
  const auto near = Degrader(params).degrade(manyBoxes(10));
  EXPECT_NEAR(0.3, deviation(near, 2, 10), 0.01);
  EXPECT_NEAR(0.15, deviation(near, 0, 0), 0.005);
  EXPECT_EQ(0.0, deviation(near, 1, 1));
  const auto far = Degrader(params).degrade(manyBoxes(60));
  EXPECT_NEAR(0.9, deviation(far, 2, 60), 0.03);
  EXPECT_NEAR(0.45, deviation(far, 0, 0), 0.015);
}

TEST(DegradeTest, DropsDuplicatesAndFlipsAtTheGivenRates) {
  auto params = nothing();
  params.drop_probability = 0.15;
  EXPECT_NEAR(0.85 * kBoxes,
              static_cast<double>(Degrader(params).degrade(manyBoxes(20)).items.size()),
              0.01 * kBoxes);
  params = nothing();
  params.duplicate_probability = 0.1;
  const auto doubled = Degrader(params).degrade(manyBoxes(20));
  EXPECT_NEAR(1.1 * kBoxes, static_cast<double>(doubled.items.size()), 0.01 * kBoxes);
  std::size_t without_id = 0;
  for (const auto& item : doubled.items) without_id += item.detector_id ? 0 : 1;
  EXPECT_EQ(doubled.items.size() - kBoxes, without_id);
  params = nothing();
  params.flip_probability = 0.05;
  std::size_t flipped = 0;
  for (const auto& item : Degrader(params).degrade(manyBoxes(20)).items) {
    const double turn = std::abs(wrapAngle(item.box3d->yaw - 0.25));
    EXPECT_TRUE(turn < 1e-12 || std::abs(turn - M_PI) < 1e-12);
    flipped += turn > 1.0 ? 1 : 0;
  }
  EXPECT_NEAR(0.05 * kBoxes, static_cast<double>(flipped), 0.01 * kBoxes);
}

TEST(DegradeTest, RemovesLowScores) {
  EXPECT_TRUE(Degrader(nothing()).degrade(manyBoxes(20, 0.0)).items.empty());
  EXPECT_TRUE(Degrader(nothing()).degrade(manyBoxes(20, NAN)).items.empty());
}

TEST(DegradeTest, DependsOnTheSeed) {
  const auto centresWith = [](int seed) {
    DegradeParams params;
    params.seed = seed;
    std::vector<double> centres;
    for (const auto& item : Degrader(params).degrade(manyBoxes(20)).items) {
      centres.push_back(item.box3d->centre.z());
    }
    return centres;
  };
  EXPECT_EQ(centresWith(1), centresWith(1));
  EXPECT_NE(centresWith(1), centresWith(2));
}

TEST(DegradeTest, OnlyDropsAndDuplicatesBoxesWithout3d) {
  Detections flat;
  Detection detection;
  detection.box2d = Box2d{1, 2, 3, 4};
  flat.items.assign(100, detection);
  for (const auto& item : Degrader(DegradeParams()).degrade(flat).items) {
    EXPECT_EQ(1.0, item.box2d->left);
    EXPECT_FALSE(item.box3d);
  }
}

TEST(DegradeTest, ParametersOutOfRangeAreRefused) {
  DegradeParams degrade;
  Params params;
  degrade.describe(params.section("degrade"));
  params.set("degrade.seed=5");
  EXPECT_EQ(5, degrade.seed);
  EXPECT_THROW(params.set("degrade.drop_probability=1.5"), InputError);
}

TEST(DegradeTest, RefusesAStructOutOfRange) {
  DegradeParams degrade;
  degrade.flip_probability = 2.0;
  EXPECT_EQ("[degrade] flip_probability: '2' is out of range [0 .. 1]",
            test::inputErrorOf([&] { Degrader degrader(degrade); }));
}

}  // namespace
}  // namespace headway::io
