// SPDX-License-Identifier: BSD-3-Clause
// When a place that was recognised without odometry is accepted.
#include "place_check.h"

#include <gmock/gmock.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/textured_world.h>

#include <random>

namespace headway::slam {
namespace {

constexpr double kRepeated_m = 10.24;  ///< after which the texture of a test's world repeats [m]

Pose shiftedTo(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

/// A map of landmarks all over a view, 10 columns and 8 rows of them, each in a cell of its own.
class EvidenceTest : public testing::Test {
 protected:
  EvidenceTest() {
    const KeyframeId keyframe = map_.addKeyframe(0, 0.0, Pose::Identity()).id;
    for (int i = 0; i < 80; ++i) {
      TrackedLandmark landmark;
      landmark.measurement.uv = {25.0 + 30.0 * (i % 10), 10.0 + 30.0 * (i / 10)};
      const Eigen::Vector3d uvd(landmark.measurement.uv.x(), landmark.measurement.uv.y(), 20.0);
      landmark.id = map_.addLandmark(*triangulate(uvd, camera_), keyframe, landmark.measurement).id;
      stereo::ReferencePatch patch;  // that is found nowhere
      patch.centre.setConstant(stereo::ReferencePatch::kSize / 2.0F);
      map_.findToChange(landmark.id)->patch = std::make_shared<stereo::ReferencePatch>(patch);
      expected_.push_back(landmark.id);
      all_.landmarks.push_back(landmark);
    }
    frame_.left = stereo::buildPyramid(cv::Mat::zeros(240, 320, CV_8U), 1);
    frame_.right.disparities = cv::Mat(240, 320, CV_32F, cv::Scalar(20.0F));
  }

  /// With the first landmarks found again, the others not.
  [[nodiscard]] int evidenceWith(int found) const {
    TrackedPose seen;
    seen.landmarks.assign(all_.landmarks.begin(), all_.landmarks.begin() + found);
    return evidenceOf(seen, expected_, frame_, map_, camera_, SlamParams(), within_m_).sum();
  }

  /// Gives each landmark a descriptor of its own, and the first ones a twin.
  void repeat(int landmarks, const Eigen::Vector3d& shift) {
    std::mt19937 random(3);
    for (std::size_t i = 0; i < expected_.size(); ++i) {
      Landmark* landmark = map_.findToChange(expected_[i]);
      for (auto& byte : landmark->descriptor) byte = static_cast<std::uint8_t>(random());
      if (i >= static_cast<std::size_t>(landmarks)) continue;
      const Eigen::Vector3d place = landmark->position + shift;
      const Descriptor descriptor = landmark->descriptor;
      const LandmarkId twin = map_.addLandmark(place, KeyframeId{0}, {}).id;
      map_.findToChange(twin)->descriptor = descriptor;
    }
  }

  double within_m_ = 100.0;
  StereoCamera camera_ = test::smallCamera();
  SparseMap map_;
  TrackedPose all_;
  std::vector<LandmarkId> expected_;
  TrackingFrame frame_;
};

TEST_F(EvidenceTest, CountsWhatIsFoundLessWhatIsMissing) {
  EXPECT_EQ(80, evidenceWith(80));
  EXPECT_EQ(0, evidenceWith(40));
  EXPECT_EQ(-80, evidenceWith(0));
}

TEST_F(EvidenceTest, WhatPeopleStandBeforeIsNotMissing) {
  frame_.right.disparities(cv::Rect(0, 120, 320, 120)).setTo(60.0F);
  EXPECT_EQ(40, evidenceWith(40)) << "the upper half is found, something nearer is below";
  frame_.right.disparities(cv::Rect(0, 120, 320, 120)).setTo(10.0F);
  EXPECT_EQ(0, evidenceWith(40)) << "one sees farther than the map";
}

TEST_F(EvidenceTest, CountsLandmarksOfOneCellOnce) {
  for (TrackedLandmark& landmark : all_.landmarks) landmark.measurement.uv = {25.0, 10.0};
  EXPECT_EQ(1 - 79, evidenceWith(80)) << "a poster";
}

TEST_F(EvidenceTest, WhatTheMapHasElsewhereTooSaysNothing) {
  repeat(30, {3.0, 0.0, 0.0});
  EXPECT_EQ(50, evidenceWith(80)) << "a floor that repeats itself";
  within_m_ = 2.0;
  EXPECT_EQ(80, evidenceWith(80)) << "it is known that the camera is not so far off";
}

TEST_F(EvidenceTest, AFewTwinsAreChance) {
  repeat(5, {3.0, 0.0, 0.0});
  EXPECT_EQ(80, evidenceWith(80));
}

/// Frames with cells of one landmark each, from `first` on.
LocatedCamera seenAt(double x, int found, int missed = 0, int first = 0) {
  LocatedCamera located;
  located.tracked.T_map_cam = shiftedTo(x);
  for (int i = 0; i < found + missed; ++i) {
    auto& cells = i < found ? located.evidence.found : located.evidence.missed;
    cells.push_back({LandmarkId{first + i}});
  }
  return located;
}

constexpr int kWeak = kPlaceProof - 1;

/// A camera that moves at 1 m/s, as odometry knows.
class PlaceCheckTest : public testing::Test {
 protected:
  /// Whether a frame's place is accepted.
  bool accepts(Time time, const LocatedCamera& located) {
    return check_.add(time, {located}, shiftedTo(time)) != nullptr;
  }

  PlaceCheck check_;
};

TEST_F(PlaceCheckTest, AProofIsAcceptedAtOnce) {
  EXPECT_TRUE(accepts(1.0, seenAt(5.0, kPlaceProof)));
  check_.restart();
  EXPECT_FALSE(accepts(1.0, seenAt(5.0, kPlaceProof + 7, 4))) << "what is missed counts double";
  EXPECT_TRUE(accepts(1.0, seenAt(5.0, kPlaceProof + 8, 4)));
}

TEST_F(PlaceCheckTest, WhatWasSeenBeforeTheClockWasSetBackIsNoRival) {
  EXPECT_FALSE(accepts(1000.0, seenAt(20.0, kPlaceProof - 1)));
  EXPECT_TRUE(accepts(1.0, seenAt(5.0, kPlaceProof)));
}

TEST_F(PlaceCheckTest, AProofIsNoneIfAnotherPlaceIsAlike) {
  EXPECT_EQ(nullptr, check_.add(1.0, {seenAt(5.0, kPlaceProof), seenAt(20.0, 1)}, shiftedTo(1.0)));
}

TEST_F(PlaceCheckTest, AProofIsNoneIfAnotherPlaceHasMoreThanHalfOfIt) {
  const auto isAccepted = [this](int other) {
    check_.restart();
    return check_.add(1.0, {seenAt(5.0, 4 * kPlaceProof), seenAt(20.0, other)}, shiftedTo(1.0)) !=
           nullptr;
  };
  EXPECT_TRUE(isAccepted(2 * kPlaceProof));
  EXPECT_FALSE(isAccepted(2 * kPlaceProof + 1));
}

TEST_F(PlaceCheckTest, WeakEvidenceIsAcceptedWhenItHasAgreedWithOdometryForAFifthOfASecond) {
  EXPECT_FALSE(accepts(1.0, seenAt(5.0, kWeak, 0, 0)));
  EXPECT_FALSE(accepts(1.1, seenAt(5.1, kWeak, 0, 100)));
  EXPECT_TRUE(accepts(1.2, seenAt(5.2, kWeak, 0, 200)));
  check_.restart();
  EXPECT_FALSE(accepts(1.3, seenAt(8.0, kWeak, 0, 0))) << "elsewhere";
  EXPECT_FALSE(accepts(1.4, seenAt(5.4, kWeak, 0, 100))) << "there and back";
  EXPECT_FALSE(accepts(1.5, seenAt(5.5, kWeak, 0, 200)));
  EXPECT_TRUE(accepts(1.6, seenAt(5.6, kWeak, 0, 300)));
  EXPECT_FALSE(accepts(9.0, seenAt(13.0, kWeak, 0, 400))) << "long ago";
}

TEST_F(PlaceCheckTest, APlaceThatIsNotWhereOdometryLeadsIsNeverAccepted) {
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(accepts(0.1 * i, seenAt(5.0 * i, kWeak, 0, 100 * i)));
  }
}

TEST_F(PlaceCheckTest, WhoSeesNothingNewLearnsNothing) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(accepts(0.1 * i, seenAt(0.1 * i, kWeak)));
}

TEST_F(PlaceCheckTest, LittleIsAcceptedIfItIsOfManyParts) {
  int frames = 1;
  while (frames < 50 && !accepts(0.1 * frames, seenAt(0.1 * frames, 5, 1, 100 * frames))) {
    ++frames;
  }
  EXPECT_EQ((kPlaceProof + 2) / 3, frames) << "five found less twice the missed one each";
}

TEST_F(PlaceCheckTest, APlaceThatIsAlikeInPartIsNeverAccepted) {
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(accepts(0.1 * i, seenAt(0.1 * i, 20, 10, 100 * i)));
  }
}

TEST_F(PlaceCheckTest, OfTwoPlacesThatAreSeenAlikeNeitherIsAccepted) {
  for (int i = 0; i < 50; ++i) {
    const double x = 0.1 * i;
    EXPECT_EQ(nullptr,
              check_.add(0.1 * i, {seenAt(x, 10, 0, 100 * i), seenAt(x + 20, 10, 0, 100 * i)},
                         shiftedTo(x)));
  }
}

TEST_F(PlaceCheckTest, KnowsWhereTheLikeliestPlaceIsSeenNext) {
  EXPECT_FALSE(check_.likeliest(0.0, shiftedTo(0.0)));
  EXPECT_EQ(nullptr, check_.add(1.0, {seenAt(5.0, 10), seenAt(9.0, 12)}, shiftedTo(1.0)));
  const auto place = check_.likeliest(1.1, shiftedTo(1.1));
  ASSERT_TRUE(place);
  EXPECT_NEAR(9.1, place->T_map_cam.translation().x(), 1e-9);
  EXPECT_FALSE(check_.likeliest(9.0, shiftedTo(0.1))) << "long ago";
}

/// A wall that repeats itself, with a shelf before it.
test::TexturedWorld repeatedWall() {
  test::TexturedWorld world(test::smallCamera());
  world.boards.push_back({{-20.0, -5.0, 2.0}, {1, 0, 0}, {0, 1, 0}, 60.0, 10.0, {0.0, 0.0}});
  world.boards.push_back({{-20.0, 0.3, 1.4}, {1, 0, 0}, {0, 1, 0}, 60.0, 0.4, {1.0, 2.0}});
  return world;
}

/// How many of 6 frames are tracked of a camera that stands where a map begins which ends so far
/// on; for each gain, of which those over 1 overexpose the images.
std::vector<int> trackedInMapTo(double end, const std::vector<double>& gains) {
  const auto world = repeatedWall();
  SlamParams params;
  params.features = 300;
  StereoSlam mapper(world.camera(), params);
  std::size_t frame = 0;
  for (double x = 0.0; x < end; x += 0.1, ++frame) {
    const Time time = 0.1 * static_cast<double>(frame);
    EXPECT_EQ(TrackingStatus::kTracked,
              mapper.process(world.frame(frame, time, shiftedTo(x)), {}).status);
  }
  params.mapping = false;
  std::vector<int> tracked;
  for (const double gain : gains) {
    StereoSlam slam(world.camera(), params);
    slam.load(mapper.save());
    tracked.push_back(0);
    for (int i = 0; i < 6; ++i) {
      StereoFrame seen = world.frame(0, 900.0 + 0.1 * i, shiftedTo(0.6));
      for (cv::Mat* image : {&seen.left, &seen.right}) {
        if (gain > 1.0) image->convertTo(*image, CV_8U, gain, 60.0);
      }
      const auto update = slam.process(seen, {});
      if (!isTracked(update.status)) continue;
      ++tracked.back();
      EXPECT_LT((update.T_map_robot.translation() - shiftedTo(0.6).translation()).norm(), 0.05);
    }
  }
  return tracked;
}

TEST(RepeatedWallTest, OfTwoPlacesThatAreAlikeNeitherIsAccepted) {
  using testing::ElementsAre;
  EXPECT_THAT(trackedInMapTo(3.0, {1.0, 1.5}), ElementsAre(6, testing::Gt(0)));
  EXPECT_THAT(trackedInMapTo(kRepeated_m + 3.0, {1.0, 1.5, 2.5}), ElementsAre(0, 0, 0));
}

TEST(StandsOnGroundTest, NoPlaceIsAShelfTooHigh) {
  SparseMap map;
  map.addKeyframe(0, 0.0, Pose::Identity());
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  const auto stands = [&](double ahead_m, double up_m, double pitch_rad) {
    Pose place = Pose::Identity();
    place.translation() = ahead_m * Eigen::Vector3d::UnitZ() + up_m * up;
    place.linear() = Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return standsOnGround(place, up, map);
  };
  EXPECT_TRUE(stands(0.0, 0.0, 0.0));
  EXPECT_TRUE(stands(0.0, 0.09, 0.0)) << "a kerb";
  EXPECT_FALSE(stands(0.0, 0.8, 0.0));
  EXPECT_FALSE(stands(0.0, -0.8, 0.0));
  EXPECT_FALSE(stands(6.0, 0.84, 0.0)) << "as seen in identical racks from the next aisle";
  EXPECT_TRUE(stands(6.0, 0.6, 0.1)) << "on a ramp that begins between both";
  EXPECT_TRUE(stands(6.0, 0.0, 0.1));
}

TEST(IsAllowedTest, APlaceThatOdometryDoesNotLeadToNeedsTime) {
  EXPECT_TRUE(isAllowed(shiftedTo(0.1), shiftedTo(0.0), 0.0));
  EXPECT_FALSE(isAllowed(shiftedTo(3.2), shiftedTo(0.0), 0.4)) << "the next door that looks alike";
  EXPECT_TRUE(isAllowed(shiftedTo(3.2), shiftedTo(0.0), 2.1)) << "people may have led it astray";
  Pose turned = Pose::Identity();
  turned.linear() = expSo3({0.0, 1.0, 0.0});
  EXPECT_FALSE(isAllowed(turned, Pose::Identity(), 0.4));
  EXPECT_TRUE(isAllowed(turned, Pose::Identity(), 0.5));
}

}  // namespace
}  // namespace headway::slam
