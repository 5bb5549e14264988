// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/trajectory_error.h>

#include <nlohmann/json.hpp>
#include <random>

namespace headway::eval {
namespace {

constexpr double kDegree = M_PI / 180.0;

/// A path that turns in all directions, so that its alignment is determined.
std::vector<Pose> winding(std::size_t frames, double step_m = 1.0) {
  std::vector<Pose> poses;
  Pose pose = Pose::Identity();
  for (std::size_t i = 0; i < frames; ++i) {
    poses.push_back(pose);
    const double t = static_cast<double>(i);
    Pose motion = Pose::Identity();
    motion.translation().x() = step_m;
    motion.linear() =
        expSo3({0.02 * std::sin(0.1 * t), 0.01 * std::cos(0.2 * t), 0.05 * std::sin(0.05 * t)});
    pose = pose * motion;
  }
  return poses;
}

std::vector<Pose> straight(std::size_t frames, double step_m) {
  std::vector<Pose> poses(frames, Pose::Identity());
  for (std::size_t i = 0; i < frames; ++i) {
    poses[i].translation().x() = step_m * static_cast<double>(i);
  }
  return poses;
}

Pose somePose() {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.4, -1.1, 2.0});
  pose.translation() << 12.0, -7.0, 3.0;
  return pose;
}

TrajectoryError compare(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                        Alignment alignment = Alignment::kSe3) {
  TrajectoryErrorParams params;
  params.alignment = alignment;
  return trajectoryError(pairByIndex(truth, estimate), params);
}

TEST(TrajectoryErrorTest, OriginMakesTheFirstPosesEqualAndFitsNothingElse) {
  const auto truth = winding(100);
  auto estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].translation().z() += 0.01 * static_cast<double>(i);
    estimate[i] = somePose() * estimate[i];
  }
  const auto error = compare(truth, estimate, Alignment::kOrigin);
  EXPECT_LT(error.errors_m.front(), 1e-9);
  EXPECT_NEAR(0.99, error.errors_m.back(), 1e-9);
  EXPECT_LT(compare(truth, estimate).ate_m.rmse, error.ate_m.rmse);
  EXPECT_NO_THROW((void)compare({truth[0], truth[1]}, {truth[0], truth[1]}, Alignment::kOrigin));
}

/// The estimate with noise, and the truth of a body that is turned on the robot.
TrajectoryError compareTurned(std::vector<Pose> truth, const Eigen::Matrix3d& R_robot_truth,
                              double noise_m, TrajectoryErrorParams params = {}) {
  params.finds_rotation = true;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  auto estimate = truth;
  for (auto& pose : truth) pose.linear() *= R_robot_truth;
  for (auto& pose : estimate) {
    pose.translation() += noise_m * Eigen::Vector3d(noise(random), noise(random), noise(random));
    pose.linear() *= expSo3(0.002 * Eigen::Vector3d(noise(random), noise(random), noise(random)));
    pose = somePose() * pose;
  }
  return trajectoryError(pairByIndex(truth, estimate), params);
}

TEST(TrajectoryErrorTest, TheAxesOfTheTruthsBodyAreFoundByTheMotion) {
  using Source = BodyRotation::Source;
  const Eigen::Matrix3d optical = robotFromOptical().linear();
  const auto same = compareTurned(winding(300, 0.1), Eigen::Matrix3d::Identity(), 0.002);
  EXPECT_EQ(Source::kAssumed, same.body.source) << "not significant";
  // In the hand, on a plane, and in a curve alone.
  auto turning = winding(300, 0.001);
  std::vector<Pose> planar;
  Pose pose = Pose::Identity(), step = Pose::Identity();
  step.translation().x() = 0.1;
  step.linear() = expSo3({0.0, 0.0, 0.02});
  for (int i = 0; i < 300; ++i, pose = pose * step) planar.push_back(pose);
  for (const auto& truth : {winding(300, 0.1), turning, planar}) {
    const double exact = compareTurned(truth, Eigen::Matrix3d::Identity(), 0.002).rpe_trans_rmse_m;
    const auto found = compareTurned(truth, optical, 0.002);
    EXPECT_EQ(Source::kFound, found.body.source);
    EXPECT_LT(found.body.sigma_rad, kDegree);
    EXPECT_LT(logSo3(found.body.R_robot_truth.transpose() * optical).norm(),
              4.0 * found.body.sigma_rad);
    EXPECT_NEAR(exact, found.rpe_trans_rmse_m, 0.1 * exact);
    EXPECT_LT(found.rpe_rot_rmse_deg, 0.4);
  }
}

TEST(TrajectoryErrorTest, AxesThatTheMotionDoesNotTellAreAskedForAndCanBeStated) {
  const Eigen::Matrix3d optical = robotFromOptical().linear();
  const auto unknown = compareTurned(straight(100, 0.5), optical, 0.0);
  EXPECT_EQ(BodyRotation::Source::kUnknown, unknown.body.source);
  EXPECT_GT(unknown.rpe_trans_rmse_m, 0.3);
  EXPECT_THAT(toJson(unknown).at("truth_rotation"), "unknown");
  TrajectoryErrorParams params;
  params.R_robot_truth = optical;
  const auto stated = compareTurned(straight(100, 0.5), optical, 0.0, params);
  EXPECT_EQ(BodyRotation::Source::kStated, stated.body.source);
  EXPECT_LT(stated.rpe_trans_rmse_m, 0.003);
  EXPECT_NEAR(-90.0, toJson(stated).at("truth_rotation_deg").at(0).get<double>(), 1e-6);
  for (const auto& [step_m, noise_m] : {std::pair(0.5, 0.01), std::pair(0.002, 0.02)}) {
    const auto same = compareTurned(straight(100, step_m), Eigen::Matrix3d::Identity(), noise_m);
    EXPECT_EQ(BodyRotation::Source::kAssumed, same.body.source) << "or below the noise";
  }
  std::vector<Pose> panning(100, Pose::Identity());
  for (int i = 0; i < 100; ++i) {
    panning[static_cast<std::size_t>(i)].linear() = expSo3({0.0, 0.0, 0.03 * i});
  }
  EXPECT_EQ(BodyRotation::Source::kUnknown, compareTurned(panning, optical, 0.01).body.source);
}

TEST(TrajectoryErrorTest, AlignsARigidMotion) {
  const auto truth = winding(200);
  auto estimate = truth;
  for (auto& pose : estimate) pose = somePose() * pose;
  const auto error = compare(truth, estimate);
  EXPECT_LT(error.ate_m.max, 1e-9);
  EXPECT_LT(error.rpe_trans_rmse_m, 1e-9);
  EXPECT_LT(error.rpe_rot_rmse_deg, 1e-6);
  EXPECT_TRUE(error.T_truth_estimate.isApprox(somePose().inverse(), 1e-9));
  EXPECT_NEAR(1.0, error.path_ratio.value(), 1e-12);
}

TEST(TrajectoryErrorTest, WithoutAlignmentAnOffsetIsTheError) {
  const auto truth = winding(50);
  auto estimate = truth;
  for (auto& pose : estimate) pose.translation() += Eigen::Vector3d(0.3, 0.0, -0.4);
  const auto error = compare(truth, estimate, Alignment::kNone);
  EXPECT_NEAR(0.5, error.ate_m.rmse, 1e-12);
  EXPECT_NEAR(0.5, error.ate_m.mean, 1e-12);
  EXPECT_NEAR(0.5, error.ate_m.median, 1e-12);
  EXPECT_NEAR(0.5, error.ate_m.max, 1e-12);
  EXPECT_NEAR(0.0, error.ate_m.sd, 1e-9);
  EXPECT_LT(error.rpe_trans_rmse_m, 1e-12);
}

TEST(TrajectoryErrorTest, EstimatesScaleOnlyOnRequest) {
  const auto truth = winding(100);
  auto estimate = truth;
  for (auto& pose : estimate) {
    pose.translation() *= 0.5;
    pose = somePose() * pose;
  }
  const auto scaled = compare(truth, estimate, Alignment::kScale);
  EXPECT_NEAR(2.0, scaled.scale, 1e-9);
  EXPECT_LT(scaled.ate_m.max, 1e-9);
  EXPECT_NEAR(0.5, scaled.path_ratio.value(), 1e-12) << "the ratio is of the unscaled path";
  const auto rigid = compare(truth, estimate, Alignment::kSe3);
  EXPECT_EQ(1.0, rigid.scale);
  EXPECT_GT(rigid.ate_m.rmse, 1.0);
}

TEST(TrajectoryErrorTest, AlignmentIsOptimal) {
  const auto truth = winding(100);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.1);
  auto estimate = truth;
  for (auto& pose : estimate) {
    pose.translation() += Eigen::Vector3d(noise(random), noise(random), noise(random));
  }
  const auto best = compare(truth, estimate);
  for (const double sign : {-1.0, 1.0}) {
    for (int axis = 0; axis < 6; ++axis) {
      Pose nudge = Pose::Identity();
      Eigen::Vector3d turn = Eigen::Vector3d::Zero();
      if (axis < 3) nudge.translation()[axis] = sign * 0.01;
      if (axis >= 3) turn[axis - 3] = sign * 0.001;
      nudge.linear() = expSo3(turn);
      auto moved = estimate;
      for (auto& pose : moved) pose = nudge * best.T_truth_estimate * pose;
      EXPECT_GT(compare(truth, moved, Alignment::kNone).ate_m.rmse, best.ate_m.rmse);
    }
  }
}

TEST(TrajectoryErrorTest, AStraightPathIsAlignedWithoutMirroring) {
  const auto truth = straight(51, 1.2);
  auto estimate = truth;
  for (auto& pose : estimate) pose = somePose() * pose;
  const auto error = compare(truth, estimate);
  EXPECT_LT(error.ate_m.max, 1e-9);
  EXPECT_NEAR(1.0, error.T_truth_estimate.linear().determinant(), 1e-9);
}

TEST(TrajectoryErrorTest, KnownDriftGivesKnownRelativeErrors) {
  // Each step is 2 % too long and turned by 0.1 degrees too much.
  const std::size_t frames = 1001;
  const auto truth = straight(frames, 1.0);
  std::vector<Pose> estimate(1, Pose::Identity());
  Pose motion = Pose::Identity();
  motion.translation().x() = 1.02;
  while (estimate.size() < frames) estimate.push_back(estimate.back() * motion);
  const auto longer = compare(truth, estimate, Alignment::kNone);
  EXPECT_NEAR(0.02, longer.rpe_trans_rmse_m, 1e-9);
  EXPECT_NEAR(1.02, longer.path_ratio.value(), 1e-9);
  // Segments of L m end one frame after L: errors are 2 % of (L + 1) m.
  const auto& kitti = longer.kitti.value();
  const std::vector<double> lengths = {100, 200, 300, 400, 500, 600, 700, 800};
  double expected = 0.0;
  std::size_t segments = 0;
  for (const double length : lengths) {
    for (double first = 0; first + length + 1 <= 1000; first += 10) {
      expected += 2.0 * (length + 1) / length;
      ++segments;
    }
  }
  EXPECT_EQ(segments, kitti.segments);
  EXPECT_NEAR(expected / static_cast<double>(segments), kitti.trans_percent, 1e-6);
  EXPECT_NEAR(0.0, kitti.rot_deg_per_m, 1e-6);
}

TEST(TrajectoryErrorTest, KnownRotationGivesKnownRotationErrors) {
  const auto truth = straight(102, 1.0);
  std::vector<Pose> estimate(1, Pose::Identity());
  Pose motion = Pose::Identity();
  motion.translation().x() = 1.0;
  motion.linear() = expSo3({0.0, 0.0, 0.1 * kDegree});
  while (estimate.size() < truth.size()) estimate.push_back(estimate.back() * motion);
  const auto error = compare(truth, estimate);
  EXPECT_NEAR(0.1, error.rpe_rot_rmse_deg, 1e-9);
  ASSERT_TRUE(error.kitti.has_value());
  EXPECT_EQ(1u, error.kitti->segments);  // 100 m from frame 0, ends at frame 101
  EXPECT_NEAR(0.1 * 101.0 / 100.0, error.kitti->rot_deg_per_m, 1e-9);
}

TEST(TrajectoryErrorTest, ShortPathsHaveSegmentErrorsOnlyForShortSegments) {
  const auto truth = straight(51, 1.2);
  EXPECT_FALSE(compare(truth, truth).kitti.has_value());
  TrajectoryErrorParams params;
  params.segment_lengths_m = {5, 10};
  const auto error = trajectoryError(pairByIndex(truth, truth), params);
  ASSERT_TRUE(error.kitti.has_value());
  EXPECT_NEAR(0.0, error.kitti->trans_percent, 1e-9);
}

TEST(TrajectoryErrorTest, AStandstillHasNoPathRatio) {
  const std::vector<Pose> still(10, Pose::Identity());
  const auto error = compare(still, still);
  EXPECT_FALSE(error.path_ratio.has_value());
  EXPECT_EQ(0.0, error.ate_m.rmse);
  EXPECT_THROW((void)compare(winding(10), still, Alignment::kScale), InputError);
}

TEST(TrajectoryErrorTest, TooFewPairsAreAnError) {
  EXPECT_THROW((void)compare(winding(2), winding(2)), InputError);
  EXPECT_NO_THROW((void)compare(winding(2), winding(2), Alignment::kNone));
  EXPECT_THROW((void)compare(winding(1), winding(1), Alignment::kNone), InputError);
}

TEST(ErrorStatisticsTest, MatchHandComputedValues) {
  const auto s = statisticsOf({4.0, 0.0, 1.0, 3.0});
  EXPECT_DOUBLE_EQ(2.0, s.mean);
  EXPECT_DOUBLE_EQ(2.0, s.median);
  EXPECT_DOUBLE_EQ(4.0, s.max);
  EXPECT_NEAR(std::sqrt(26.0 / 4.0), s.rmse, 1e-12);
  EXPECT_NEAR(std::sqrt(2.5), s.sd, 1e-12);
  EXPECT_DOUBLE_EQ(3.0, statisticsOf({9.0, 3.0, 1.0}).median);
  EXPECT_EQ(0.0, statisticsOf({}).rmse);
}

TEST(TrajectoryJsonTest, HasTheDocumentedKeysAndNullIfUndefined) {
  const auto json = toJson(compare(straight(20, 1.0), straight(20, 1.0)));
  for (const char* key : {"frames", "frames_matched", "path_m", "path_ratio", "ate_rmse_m",
                          "ate_mean_m", "ate_sd_m", "ate_median_m", "ate_max_m", "rpe_trans_rmse_m",
                          "rpe_rot_rmse_deg", "kitti_trans_percent", "kitti_rot_deg_per_m"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_TRUE(json["kitti_trans_percent"].is_null());
  EXPECT_EQ(20, json.at("frames"));
  EXPECT_NEAR(19.0, json.at("path_m").get<double>(), 1e-9);
  const auto still = toJson(compare(straight(5, 0.0), straight(5, 0.0)));
  EXPECT_TRUE(still["path_ratio"].is_null());
}

}  // namespace
}  // namespace headway::eval
