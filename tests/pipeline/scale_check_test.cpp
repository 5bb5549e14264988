// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/pipeline/perception.h>
#include <headway_test/textured_world.h>

#include <cstdio>
#include <random>

#include "input_health.h"

namespace headway::pipeline {
namespace {

Pose wheelStep(double metres, double turn = 0.0) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, 0.0, turn});
  pose.translation().x() = metres;
  return pose;
}

StereoCamera wheeledCamera() {
  StereoCamera camera = test::smallCamera();
  camera.baseline_m = 0.12;
  return camera;
}

struct WheelDrive {
  ScaleCheck check{wheeledCamera()};
  Findings findings;
  std::mt19937 random{3};
  std::size_t frame = 0;

  /// So many frames of 0.1 m by the wheels; `slip` of the pieces of 20 frames with twice as much.
  void go(double camera_ratio, int frames, double slip = 0.0, double noise_m = 0.002) {
    std::normal_distribution<double> noise(0.0, noise_m);
    std::bernoulli_distribution slips(slip);
    bool is_slipping = false;
    for (int i = 0; i < frames; ++i) {
      if (i % 20 == 0) is_slipping = slips(random);
      const double wheels = is_slipping ? 0.2 : 0.1;
      add(wheelStep(0.1 * camera_ratio + noise(random), 0.002), wheelStep(wheels, 0.002));
    }
  }

  void add(const Pose& by_camera, const std::optional<Pose>& by_odometry) {
    for (Finding& one : check.add(by_camera, by_odometry, frame++)) {
      findings.push_back(std::move(one));
    }
  }
};

TEST(ScaleCheckTest, EqualScalesAreNotMentioned) {
  WheelDrive drive;
  drive.go(1.0, 600);
  ASSERT_TRUE(drive.check.ratio());
  EXPECT_NEAR(1.0, drive.check.ratio()->value, 0.002);
  EXPECT_TRUE(drive.findings.empty());
}

TEST(ScaleCheckTest, MoreThanAPercentIsSaidWithTheFigure) {
  for (const double ratio : {0.97, 1.03}) {
    WheelDrive drive;
    drive.go(ratio, 300);
    ASSERT_FALSE(drive.findings.empty());
    for (const Finding& finding : drive.findings) EXPECT_EQ("odometry_scale", finding.name);
    EXPECT_LT(drive.findings.front().frame, 130U);
    EXPECT_NEAR(ratio, drive.check.ratio()->value, 3.0 * drive.check.ratio()->sigma + 1e-4);
    EXPECT_LT(drive.check.ratio()->sigma, 0.003);
  }
  WheelDrive half;
  half.go(1.006, 600);
  EXPECT_TRUE(half.findings.empty()) << "within what wheels tell";
}

TEST(ScaleCheckTest, SlipInAThirdOfThePiecesIsNoScale) {
  WheelDrive drive;
  drive.go(1.0, 1200, 0.3);
  EXPECT_NEAR(1.0, drive.check.ratio()->value, 0.01);
  EXPECT_TRUE(drive.findings.empty());
}

TEST(ScaleCheckTest, AFewMetresOrNoiseTellNothing) {
  WheelDrive few;
  few.go(1.5, 90);
  EXPECT_FALSE(few.check.ratio());
  WheelDrive noisy;
  noisy.go(1.02, 300, 0.0, 0.08);
  EXPECT_TRUE(noisy.findings.empty());
}

TEST(ScaleCheckTest, APieceNeedsOdometryWithoutGaps) {
  WheelDrive drive;
  for (int i = 0; i < 600; ++i) {
    const bool gap = i % 15 == 0;  // each 1.5 m
    drive.add(wheelStep(0.1), gap ? std::nullopt : std::optional<Pose>(wheelStep(0.1)));
  }
  EXPECT_FALSE(drive.check.ratio());
}

TEST(ScaleCheckTest, AnotherCalibrationStartsAgain) {
  WheelDrive drive;
  drive.go(1.2, 300);
  drive.check.restart();
  EXPECT_FALSE(drive.check.ratio());
  drive.go(1.0, 300);
  EXPECT_NEAR(1.0, drive.check.ratio()->value, 0.002);
}

/// The first 3 m by odometry, of which the camera measured `ratio` times as much.
Findings afterRatio(double ratio) {
  WheelDrive drive;
  for (int i = 0; i < 30; ++i) drive.add(wheelStep(0.1 * ratio), wheelStep(0.1));
  return drive.findings;
}

TEST(ScaleCheckTest, TheFirstMetresTellAFactor) {
  for (const double ratio : {1.0, 2.0, 0.5}) EXPECT_TRUE(afterRatio(ratio).empty()) << ratio;
  for (const double ratio : {4.0, 0.2, 0.0}) {
    const Findings findings = afterRatio(ratio);
    ASSERT_EQ(1U, findings.size()) << ratio;
    EXPECT_EQ("odometry_scale", findings[0].name);
    EXPECT_EQ(Severity::kWarning, findings[0].severity);
    EXPECT_NEAR(20.0, static_cast<double>(findings[0].frame), 1.0);
    EXPECT_THAT(findings[0].text,
                ::testing::AllOf(::testing::HasSubstr("check the baseline (0.12 m)"),
                                 ::testing::HasSubstr("where odometry")));
  }
}

TEST(ScaleCheckTest, AThousandfoldScaleIsFatalAndNamesTheBaselineToWrite) {
  const Findings findings = afterRatio(1000.0);
  ASSERT_EQ(1U, findings.size());
  EXPECT_EQ(Severity::kFatal, findings[0].severity);
  EXPECT_THAT(findings[0].text, ::testing::AllOf(::testing::HasSubstr("as if in another unit"),
                                                 ::testing::HasSubstr("0.00012 m")));
}

TEST(ScaleCheckTest, NoiseAtStandstillIsNoDistance) {
  // Half an hour at 30 Hz: the camera's steps sum up to 65 m, those of the wheels to 2.2 m.
  std::normal_distribution<double> noise(0.0, 0.0012);
  WheelDrive drive;
  const auto jitter = [&](double ratio) {
    Pose step = Pose::Identity();
    step.translation() << ratio * noise(drive.random), ratio * noise(drive.random), 0.0;
    return step;
  };
  for (int i = 0; i < 30 * 60 * 30; ++i) drive.add(jitter(1.0), jitter(1.0 / 40.0));
  EXPECT_TRUE(drive.findings.empty());
  EXPECT_FALSE(drive.check.ratio());
  drive.go(1.0, 300);
  EXPECT_TRUE(drive.findings.empty()) << "the way to the first metres does not count";
}

/// A drive of 14 m past exact wheels, by a camera whose calibration claims so much of its baseline.
struct CalibratedDrive {
  Warnings warnings;
  Pose T_map_robot = Pose::Identity();

  explicit CalibratedDrive(double baseline_ratio) {
    constexpr int kFrames = 56;
    const Pose step = wheelStep(0.25, 0.002);
    const StereoCamera exact = test::smallCamera();
    test::TexturedWorld hall(exact);
    hall.addRoom(30.0, 8.0, 4.0);
    auto claimed = std::make_shared<StereoCamera>(exact);
    claimed->baseline_m *= baseline_ratio;
    PerceptionParams params;
    params.slam.features = 250;
    params.detection.detector = "none";
    params.grid.period_s = 0.0;
    Perception perception(claimed, params);
    Pose truth = Pose::Identity();
    truth.translation().x() = -9.0;
    for (std::size_t i = 0; i < kFrames; ++i) {
      RecordedFrame frame;
      frame.index = i;
      frame.time = 0.1 * static_cast<double>(i);
      frame.stereo = hall.frame(i, frame.time, truth);
      frame.stereo->camera = claimed;
      if (i > 0) frame.stereo->motion_prior.T_previous_current = step;
      T_map_robot = perception.process(frame).camera.T_map_robot;
      truth = truth * step;
    }
    warnings = perception.warnings();
  }
};

TEST(ScaleCheckTest, ABaselineThatIsOffByTwoPercentIsSaidAndNotChanged) {
  const CalibratedDrive wrong(1.02);
  ASSERT_EQ(1U, wrong.warnings.count("odometry_scale"));
  double measured = 0.0;
  const std::string& text = wrong.warnings.at("odometry_scale").text;
  ASSERT_EQ(1, std::sscanf(text.c_str(), "the camera moves %lf", &measured)) << text;
  EXPECT_NEAR(measured, 1.02, 0.005) << text;
  EXPECT_EQ(1U, wrong.warnings.size());
  const CalibratedDrive right(1.0);
  EXPECT_TRUE(right.warnings.empty());
  // The map has the camera's scale, not that of the wheels.
  const double ratio =
      wrong.T_map_robot.translation().norm() / right.T_map_robot.translation().norm();
  EXPECT_NEAR(ratio, 1.02, 0.005);
}

}  // namespace
}  // namespace headway::pipeline
