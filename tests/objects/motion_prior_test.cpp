// SPDX-License-Identifier: BSD-3-Clause
#include "motion_prior.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace headway::objects {
namespace {

struct Case {
  std::vector<PlaceMeasurement> measurements;
  std::vector<Eigen::Vector3d> start;
};

// A noisy walk with uneven steps of time, noise ellipses that turn, and two outliers.
Case noisyWalk(std::size_t length, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise;
  Case result;
  Time time = 5.0;
  for (std::size_t j = 0; j < length; ++j) {
    PlaceMeasurement m;
    m.time = time;
    m.measured = {3.0 * time + 0.2 * noise(random), std::sin(time) + 0.2 * noise(random),
                  0.1 * noise(random)};
    if (j % 9 == 5) m.measured.y() += 4.0;
    const Eigen::Rotation2Dd turn(0.7 * static_cast<double>(j));
    m.information = turn.toRotationMatrix() * Eigen::Vector2d(4.0, 40.0).asDiagonal() *
                    turn.toRotationMatrix().transpose();
    m.vertical_information = 80.0;
    result.measurements.push_back(m);
    result.start.push_back(m.measured +
                           0.3 * Eigen::Vector3d(noise(random), noise(random), noise(random)));
    time += 0.05 + 0.1 * static_cast<double>(j % 3);
  }
  return result;
}

PriorStiffness stiffness(MotionPriorKind kind) {
  return {kind, kind == MotionPriorKind::kLeastKinetic ? 1.9 : 2.0, 2.0};
}

/// The same walk with measured velocities, one of them an outlier.
Case walkWithVelocities(std::size_t length, unsigned seed) {
  Case walk = noisyWalk(length, seed);
  for (std::size_t j = 0; j < length; j += 2) {
    auto& m = walk.measurements[j];
    const Eigen::Rotation2Dd turn(0.4 * static_cast<double>(j));
    GroundVelocity velocity;
    velocity.value = {3.0 + 0.1 * static_cast<double>(j % 5), std::cos(m.time)};
    if (j == 6) velocity.value.x() -= 5.0;
    velocity.covariance = turn.toRotationMatrix() * Eigen::Vector2d(0.04, 0.3).asDiagonal() *
                          turn.toRotationMatrix().transpose();
    m.velocity = velocity;
  }
  return walk;
}

class EveryPriorTest : public ::testing::TestWithParam<MotionPriorKind> {};

INSTANTIATE_TEST_SUITE_P(Named, EveryPriorTest,
                         ::testing::Values(MotionPriorKind::kLeastKinetic,
                                           MotionPriorKind::kLeastForce));

void expectGradientOfTheCost(const Case& walk, MotionPriorKind kind) {
  const MotionPriorProblem problem(walk.measurements, stiffness(kind));
  const auto gradient = problem.gradient(walk.start);
  constexpr double kStep = 1e-6;
  for (std::size_t j = 0; j < walk.start.size(); ++j) {
    for (int axis = 0; axis < 3; ++axis) {
      auto above = walk.start;
      auto below = walk.start;
      above[j](axis) += kStep;
      below[j](axis) -= kStep;
      const double numeric = (problem.cost(above) - problem.cost(below)) / (2.0 * kStep);
      EXPECT_NEAR(gradient[j](axis), numeric, 1e-5 * (1.0 + std::abs(numeric)));
    }
  }
}

TEST_P(EveryPriorTest, HasTheGradientOfItsCost) {
  expectGradientOfTheCost(noisyWalk(12, 1), GetParam());
  expectGradientOfTheCost(walkWithVelocities(12, 1), GetParam());
}

TEST_P(EveryPriorTest, EndsWhereNoPlaceCanBeBettered) {
  for (const std::size_t length : {2u, 3u, 4u, 21u, 100u}) {
    Case walk = length % 2 == 0 ? walkWithVelocities(length, 2) : noisyWalk(length, 2);
    MotionPriorProblem problem(walk.measurements, stiffness(GetParam()));
    const auto summary = problem.refine(walk.start, 1000, 1e-7);
    EXPECT_LE(summary.final_cost, summary.initial_cost);
    const double least = problem.cost(walk.start);
    EXPECT_NEAR(summary.final_cost, least, 1e-9 * least);
    for (std::size_t j = 0; j < length; ++j) {
      for (const double step : {-1e-3, 1e-3}) {
        for (int axis = 0; axis < 3; ++axis) {
          auto neighbour = walk.start;
          neighbour[j](axis) += step;
          EXPECT_GT(problem.cost(neighbour), least) << "place " << j << " of " << length;
        }
      }
    }
  }
}

TEST(MotionPriorTest, AMeanVelocityIsThatOfTheStepInTheMiddleOfItsTime) {
  Case walk;
  for (int j = 0; j < 8; ++j) {
    PlaceMeasurement m;
    m.time = 0.1 * j;
    m.measured = {0.1 * j, 0.0, 0.0};
    walk.measurements.push_back(m);
    walk.start.push_back(m.measured);
  }
  walk.measurements[7].velocity =
      GroundVelocity{{3.0, 0.0}, 0.01 * Eigen::Matrix2d::Identity(), 0.35};
  const auto costOf = [&](std::size_t step) {
    auto places = walk.start;
    for (std::size_t j = step; j < places.size(); ++j) places[j].x() += 0.2;
    return MotionPriorProblem(walk.measurements, {MotionPriorKind::kLeastForce, 1e-6}).cost(places);
  };
  for (std::size_t step = 1; step < 8; ++step) {
    if (step == 4) continue;
    EXPECT_LT(costOf(4), costOf(step) - 1.0) << "0.3 to 0.4 s, not step " << step;
  }
}

TEST(MotionPriorTest, StiffPriorsAndCorrelatedErrorsAreSolvedExactly) {
  constexpr std::size_t kPlaces = 62;  // two seconds at 30 Hz
  constexpr double kStiffness = 1e6;   // of neighbours against a measurement there
  BandedSystem<2> banded;
  banded.reset(kPlaces);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(2 * kPlaces, 2 * kPlaces);
  const auto add = [&](std::size_t row, std::size_t column, const Eigen::Matrix2d& block) {
    auto& blocks = row == column       ? banded.diagonal
                   : row == column + 1 ? banded.first
                                       : banded.second;
    blocks[column] += block;
    const auto r = static_cast<Eigen::Index>(2 * row), c = static_cast<Eigen::Index>(2 * column);
    dense.block<2, 2>(r, c) += block;
    if (row != column) dense.block<2, 2>(c, r) += block.transpose();
  };
  const Eigen::Matrix2d information = (Eigen::Matrix2d() << 50.0, 5.0, 5.0, 10.0).finished();
  for (std::size_t j = 0; j < kPlaces; ++j) add(j, j, information);
  const double second_difference[] = {1.0, -2.0, 1.0};
  for (std::size_t j = 0; j + 2 < kPlaces; ++j) {
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const double weight = kStiffness * second_difference[a] * second_difference[b];
        add(j + a, j + b, weight * Eigen::Matrix2d::Identity());
      }
    }
  }
  Eigen::VectorXd right(2 * kPlaces);
  for (std::size_t j = 0; j < kPlaces; ++j) {
    banded.right[j] << std::sin(1.0 * static_cast<double>(j)),
        std::cos(2.0 * static_cast<double>(j));
    right.segment<2>(static_cast<Eigen::Index>(2 * j)) = banded.right[j];
  }
  const Eigen::VectorXd expected = dense.ldlt().solve(right);
  banded.solve();
  for (std::size_t j = 0; j < kPlaces; ++j) {
    const auto row = static_cast<Eigen::Index>(2 * j);
    EXPECT_LT((banded.right[j] - expected.segment<2>(row)).norm(), 1e-6 * expected.norm()) << j;
  }
}

// The same cost, written for Ceres' automatic derivatives.
struct DataResidual {
  PlaceMeasurement m;
  Eigen::Matrix2d root;
  template <typename T>
  bool operator()(const T* p, T* residual) const {
    const T x = p[0] - m.measured.x();
    const T y = p[1] - m.measured.y();
    residual[0] = root(0, 0) * x + root(0, 1) * y;
    residual[1] = root(1, 0) * x + root(1, 1) * y;
    residual[2] = std::sqrt(m.vertical_information) * (p[2] - m.measured.z());
    return true;
  }
};
struct KineticResidual {
  double weight, dt;
  template <typename T>
  bool operator()(const T* a, const T* b, T* residual) const {
    for (int i = 0; i < 3; ++i) residual[i] = std::sqrt(weight * dt) * (b[i] - a[i]) / dt;
    return true;
  }
};
struct ForceResidual {
  double weight, before, after;
  template <typename T>
  bool operator()(const T* a, const T* b, const T* c, T* residual) const {
    const double middle = 0.5 * (before + after);
    for (int i = 0; i < 3; ++i) {
      const T change = (c[i] - b[i]) / after - (b[i] - a[i]) / before;
      residual[i] = std::sqrt(weight * middle) * change / middle;
    }
    return true;
  }
};

std::vector<Eigen::Vector3d> solvedByCeres(const Case& walk, const PriorStiffness& prior) {
  auto places = walk.start;
  const auto& m = walk.measurements;
  ceres::Problem problem;
  for (std::size_t j = 0; j < places.size(); ++j) {
    const Eigen::Matrix2d root = m[j].information.llt().matrixU();
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<DataResidual, 3, 3>(new DataResidual{m[j], root}),
        new ceres::HuberLoss(prior.outlier_sigma), places[j].data());
  }
  for (std::size_t j = 0; j + 1 < places.size(); ++j) {
    const double dt = m[j + 1].time - m[j].time;
    if (prior.kind == MotionPriorKind::kLeastKinetic) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<KineticResidual, 3, 3, 3>(
                                   new KineticResidual{prior.weight, dt}),
                               nullptr, places[j].data(), places[j + 1].data());
    } else if (j + 2 < places.size()) {
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<ForceResidual, 3, 3, 3, 3>(
              new ForceResidual{prior.weight, dt, m[j + 2].time - m[j + 1].time}),
          nullptr, places[j].data(), places[j + 1].data(), places[j + 2].data());
    }
  }
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return places;
}

TEST_P(EveryPriorTest, HasTheMinimumOfCeres) {
  for (const unsigned seed : {3u, 4u, 5u}) {
    Case walk = noisyWalk(21, seed);
    const auto reference = solvedByCeres(walk, stiffness(GetParam()));
    MotionPriorProblem problem(walk.measurements, stiffness(GetParam()));
    problem.refine(walk.start, 1000, 1e-7);
    EXPECT_NEAR(problem.cost(walk.start), problem.cost(reference), 1e-5 * problem.cost(reference));
    for (std::size_t j = 0; j < reference.size(); ++j) {
      EXPECT_LT((walk.start[j] - reference[j]).norm(), 0.01);
    }
  }
}

TEST_P(EveryPriorTest, TakesOneStepWhereNoResidualIsAnOutlier) {
  for (const unsigned seed : {8u, 9u}) {
    Case walk = seed == 8u ? noisyWalk(20, seed) : walkWithVelocities(20, seed);
    PriorStiffness prior = stiffness(GetParam());
    prior.outlier_sigma = 1e3;
    MotionPriorProblem problem(walk.measurements, prior);
    const auto steepest = [&] {
      double norm = 0.0;
      for (const auto& slope : problem.gradient(walk.start)) norm = std::max(norm, slope.norm());
      return norm;
    };
    const double before = steepest();
    EXPECT_EQ(problem.refine(walk.start, 100, 1e-9).iterations, 1);
    EXPECT_LT(steepest(), 1e-6 * before);
  }
}

TEST(LeastForceTest, LeavesAConstantVelocityAlone) {
  Case walk = noisyWalk(20, 6);
  for (auto& m : walk.measurements) m.measured = {4.0 * m.time, -2.0 * m.time, 0.1 * m.time};
  MotionPriorProblem problem(walk.measurements, stiffness(MotionPriorKind::kLeastForce));
  problem.refine(walk.start, 50, 1e-9);
  for (std::size_t j = 0; j < walk.start.size(); ++j) {
    EXPECT_LT((walk.start[j] - walk.measurements[j].measured).norm(), 1e-6) << "no lag";
  }
}

TEST(LeastKineticTest, PullsTheNewestPlaceTowardsThePast) {
  Case walk = noisyWalk(20, 7);
  for (auto& m : walk.measurements) m.measured = {4.0 * m.time, 0.0, 0.0};
  MotionPriorProblem problem(walk.measurements, stiffness(MotionPriorKind::kLeastKinetic));
  problem.refine(walk.start, 50, 1e-9);
  EXPECT_LT(walk.start.back().x(), walk.measurements.back().measured.x() - 0.01);
}

/// A vehicle at 4 m/s of which less and less is seen: its measured centre falls behind.
std::vector<Eigen::Vector3d> smoothedBehindAnEdge(bool with_velocities) {
  std::vector<PlaceMeasurement> measurements(20);
  std::vector<Eigen::Vector3d> places;
  for (std::size_t j = 0; j < measurements.size(); ++j) {
    PlaceMeasurement& m = measurements[j];
    m.time = 0.1 * static_cast<double>(j);
    const double hidden = j < 14 ? 0.0 : 0.2 * static_cast<double>(j - 13);
    m.measured = {4.0 * m.time - hidden, 0.0, 0.0};
    m.information = Eigen::Matrix2d::Identity() / 0.09;
    if (with_velocities) m.velocity = {{4.0, 0.0}, 0.01 * Eigen::Matrix2d::Identity()};
    places.push_back(m.measured);
  }
  PriorStiffness prior = stiffness(MotionPriorKind::kLeastForce);
  MotionPriorProblem(measurements, prior).refine(places, 100, 1e-6);
  return places;
}

TEST(MotionPriorTest, MeasuredVelocitiesKeepAPathWhosePositionsFallBehind) {
  const double truth = 4.0 * 1.9;
  EXPECT_LT(smoothedBehindAnEdge(false).back().x(), truth - 0.7);
  EXPECT_NEAR(smoothedBehindAnEdge(true).back().x(), truth, 0.35);
}

}  // namespace
}  // namespace headway::objects
