// SPDX-License-Identifier: BSD-3-Clause
#include "pose_graph.h"

#include <gtest/gtest.h>
#include <headway/stereo/pose_refiner.h>

namespace headway::slam {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Pose somePose(double a, double b, double c) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({a, b, c});
  pose.translation() << 2.0 * b, -c, 3.0 * a;
  return pose;
}

TEST(EdgeResidualTest, JacobiansAreThoseOfNumericDifferences) {
  PoseGraphEdge edge;
  edge.T_a_b = somePose(0.2, -0.1, 0.4);
  edge.sigma_m = 0.3;
  edge.sigma_rad = 0.05;
  const Pose a = somePose(0.5, 0.3, -0.2);
  const Pose b = somePose(-0.3, 0.6, 0.3);
  Matrix6 by_a, by_b;
  static_cast<void>(edgeResidual(edge, a, b, &by_a, &by_b));
  constexpr double kStep = 1e-6;
  for (int axis = 0; axis < 6; ++axis) {
    const Vector6 step = kStep * Vector6::Unit(axis);
    const Vector6 numeric_a = (edgeResidual(edge, stereo::retract(a, step), b, nullptr, nullptr) -
                               edgeResidual(edge, stereo::retract(a, -step), b, nullptr, nullptr)) /
                              (2.0 * kStep);
    const Vector6 numeric_b = (edgeResidual(edge, a, stereo::retract(b, step), nullptr, nullptr) -
                               edgeResidual(edge, a, stereo::retract(b, -step), nullptr, nullptr)) /
                              (2.0 * kStep);
    EXPECT_LT((by_a.col(axis) - numeric_a).norm(), 1e-5) << axis;
    EXPECT_LT((by_b.col(axis) - numeric_b).norm(), 1e-5) << axis;
  }
}

/// Keyframes on a circle.
Pose onCircle(int i, int count) {
  const double angle = 2.0 * M_PI * i / count;
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, 0.0, angle});
  pose.translation() << 10.0 * std::sin(angle), 10.0 - 10.0 * std::cos(angle), 0.0;
  return pose;
}

TEST(OptimisePoseGraphTest, SpreadsTheErrorOfALoopOverIt) {
  constexpr int kCount = 40;
  const Pose drift = somePose(0.0, 0.0, 0.004);
  std::map<KeyframeId, Pose> poses;
  std::vector<PoseGraphEdge> edges;
  poses[KeyframeId{0}] = onCircle(0, kCount);
  for (int i = 1; i < kCount; ++i) {
    PoseGraphEdge edge;
    edge.a = KeyframeId{i - 1};
    edge.b = KeyframeId{i};
    edge.T_a_b = onCircle(i - 1, kCount).inverse() * onCircle(i, kCount) * drift;
    edges.push_back(edge);
    poses[edge.b] = poses[edge.a] * edge.T_a_b;
  }
  const auto worst = [&](const std::map<KeyframeId, Pose>& estimate) {
    double distance = 0.0;
    for (const auto& [id, pose] : estimate) {
      distance = std::max(
          distance,
          (pose.translation() - onCircle(static_cast<int>(id.value), kCount).translation()).norm());
    }
    return distance;
  };
  const double before = worst(poses);
  PoseGraphEdge loop;
  loop.a = KeyframeId{0};
  loop.b = KeyframeId{kCount - 1};
  loop.T_a_b = onCircle(0, kCount).inverse() * onCircle(kCount - 1, kCount);
  loop.sigma_m = 0.01;
  loop.sigma_rad = 0.001;
  edges.push_back(loop);
  const auto corrected = optimisePoseGraph(poses, edges);
  EXPECT_EQ(corrected.at(KeyframeId{0}).matrix(), poses.at(KeyframeId{0}).matrix());
  EXPECT_LT(worst(corrected), 0.35 * before);
  int asked = 0;
  const auto stopped = optimisePoseGraph(poses, edges, [&asked] { return ++asked > 0; });
  EXPECT_EQ(1, asked) << "it ends at once";
  EXPECT_GT(worst(stopped), worst(corrected));
}

TEST(OptimisePoseGraphTest, LeavesPosesThatAgreeAlone) {
  std::map<KeyframeId, Pose> poses;
  std::vector<PoseGraphEdge> edges;
  for (int i = 0; i < 5; ++i) {
    poses[KeyframeId{i}] = onCircle(i, 30);
    if (i == 0) continue;
    PoseGraphEdge edge;
    edge.a = KeyframeId{i - 1};
    edge.b = KeyframeId{i};
    edge.T_a_b = poses.at(edge.a).inverse() * poses.at(edge.b);
    edges.push_back(edge);
  }
  for (const auto& [id, pose] : optimisePoseGraph(poses, edges)) {
    EXPECT_LT((pose.matrix() - poses.at(id).matrix()).norm(), 1e-9);
  }
  EXPECT_TRUE(optimisePoseGraph({}, {}).empty());
}

}  // namespace
}  // namespace headway::slam
