// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/appearance.h>
#include <headway/core/error.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/objects/predictor.h>
#include <headway_test/input_error.h>

#include <functional>
#include <limits>
#include <random>
#include <set>
#include <sstream>

#include "scene.h"

namespace headway::objects {
namespace {

using test::confirmed;
using test::kFrame_s;
using test::Replay;
using test::seenCar;
using test::seenPerson;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(MovingObjectTrackerTest, ConfirmsATrackAfterEnoughDetections) {
  ObjectsParams params;
  params.lifecycle.confirm_time_s = 0.3;
  params.lifecycle.confirm_anyway_time_s = 0.3;
  Replay replay(params);
  EXPECT_EQ(replay.frame({seenCar(10, 0)}).tracks.at(0).status, TrackStatus::kTentative);
  EXPECT_EQ(replay.frame({seenCar(10, 0)}).tracks.at(0).status, TrackStatus::kTentative);
  EXPECT_EQ(replay.frame({seenCar(10, 0)}).tracks.at(0).status, TrackStatus::kConfirmed);
  EXPECT_EQ(replay.used, 3u);
}

TEST(MovingObjectTrackerTest, OneObservationAloneNeverConfirms) {
  ObjectsParams params;
  params.lifecycle.confirm_time_s = 0.0;
  params.lifecycle.confirm_anyway_time_s = 0.0;
  Replay replay(params);
  EXPECT_EQ(replay.frame({seenCar(10, 0)}).tracks.at(0).status, TrackStatus::kTentative);
  EXPECT_EQ(replay.frame({seenCar(10, 0)}).tracks.at(0).status, TrackStatus::kConfirmed);
}

/// Number of detections until a track is confirmed, at a rate of frames.
int detectionsUntilConfirmed(double rate_hz, const ObjectsParams& params, double score) {
  Replay replay(params);
  int frame = 0;
  for (; frame < 10; ++frame) replay.frameAt(frame / rate_hz, {});
  for (int hits = 1; hits < 100; ++hits, ++frame) {
    Detection car = seenCar(10, 0);
    car.score = score;
    replay.frameAt(frame / rate_hz, {car});
    if (!confirmed(replay.last).empty()) return hits;
  }
  return 0;
}

TEST(MovingObjectTrackerTest, ConfirmsAfterTheSameTimeAtEveryRate) {
  ObjectsParams params;
  params.lifecycle.confirm_time_s = 0.4;
  ObjectsParams by_score;
  by_score.lifecycle.confirm_score.vehicle = 2.0;
  by_score.lifecycle.confirm_anyway_time_s = 2.0;
  for (const int rate_hz : {5, 10, 15, 20, 30}) {
    EXPECT_EQ(detectionsUntilConfirmed(rate_hz, params, 1.0), rate_hz * 2 / 5) << rate_hz;
    EXPECT_EQ(detectionsUntilConfirmed(rate_hz, by_score, 0.5), rate_hz * 2 / 5) << rate_hz;
  }
}

TEST(MovingObjectTrackerTest, DroppedFramesDoNotChangeTheRate) {
  ObjectsParams params;
  params.lifecycle.confirm_time_s = 0.4;
  Replay replay(params);
  for (const double time : {0.0, 0.1, 0.2, 0.4, 0.5, 0.7, 0.8}) replay.frameAt(time, {});
  for (const double time : {0.9, 1.0, 1.2}) replay.frameAt(time, {seenCar(10, 0)});
  EXPECT_THAT(confirmed(replay.last), IsEmpty());
  replay.frameAt(1.3, {seenCar(10, 0)});
  EXPECT_EQ(confirmed(replay.last).size(), 1u);
}

TEST(MovingObjectTrackerTest, ConfirmsByTheSumOfScores) {
  ObjectsParams params;
  params.lifecycle.confirm_time_s = 0.2;
  params.lifecycle.confirm_score.vehicle = 2.0;
  params.lifecycle.confirm_anyway_time_s = 1.0;
  Replay replay(params);
  Detection certain = seenCar(10, 0);
  Detection uncertain = seenCar(10, 8);
  certain.score = 5.0;
  uncertain.score = 0.3;
  for (int k = 1; k <= 10; ++k) {
    replay.frame({certain, uncertain});
    const std::size_t expected = k < 2 ? 0 : k < 7 ? 1 : 2;  // 7 * 0.3 > 2
    EXPECT_EQ(confirmed(replay.last).size(), expected) << "frame " << k;
  }
}

TEST(MovingObjectTrackerTest, ContinuesTracksWithUnlikelyDetectionsButStartsNone) {
  ObjectsParams params;
  params.lifecycle.start_score = 0.5;
  Replay replay(params);
  Detection unlikely = seenCar(10, 0);
  unlikely.score = 0.1;
  replay.frame({unlikely});
  EXPECT_THAT(replay.last.tracks, IsEmpty());
  EXPECT_THAT(replay.dropped, ElementsAre(Pair("low_score", 1u)));
  for (int k = 0; k < 5; ++k) replay.frame({seenCar(10, 0)});
  replay.frame({unlikely});
  EXPECT_EQ(confirmed(replay.last).size(), 1u);
  EXPECT_EQ(replay.used, 6u);
}

TEST(MovingObjectTrackerTest, DoesNotShowALostObjectThatLeftTheView) {
  Replay replay;
  for (int k = 0; k < 20; ++k) replay.frame({seenCar(14 - 0.7 * k, 3)});  // it passes by
  replay.frame({});
  EXPECT_THAT(replay.last.tracks, IsEmpty()) << "beside the robot, outside the field of view";
}

TEST(MovingObjectTrackerTest, AFalseAlarmDoesNotWidenTheView) {
  Replay replay;
  replay.frame({seenCar(1, 9)});  // far beside the camera
  for (int k = 0; k < 15; ++k) replay.frame({seenCar(14 - 0.7 * k, 3)});
  replay.frame({});
  EXPECT_THAT(replay.last.tracks, IsEmpty()) << "farther to the side than it was ever followed";
}

TEST(MovingObjectTrackerTest, RemovesASingleFalseAlarm) {
  Replay replay;
  replay.frame({seenCar(10, 0)});
  for (int k = 0; k < 5; ++k) replay.frame({});
  EXPECT_THAT(replay.last.tracks, IsEmpty());
  EXPECT_THAT(replay.finalised, IsEmpty()) << "it never was a track";
}

TEST(MovingObjectTrackerTest, TracksAConstantVelocityWithoutLag) {
  ObjectsParams params;
  params.smoothing.motion_prior = MotionPriorKind::kLeastForce;
  Replay replay(params);
  for (int k = 0; k < 60; ++k) replay.frame({seenCar(5.0 + 0.8 * k, 2.0)});
  const Track& track = replay.last.tracks.at(0);
  EXPECT_NEAR(track.position.x(), 5.0 + 0.8 * 59, 0.01);
  EXPECT_NEAR(track.velocity.x(), 8.0, 0.02);
  EXPECT_TRUE(isMoving(track));
}

TEST(MovingObjectTrackerTest, LagsWithTheLeastKineticPriorOfThePaper) {
  ObjectsParams params;
  params.smoothing.motion_prior = MotionPriorKind::kLeastKinetic;
  Replay replay(params);
  for (int k = 0; k < 60; ++k) replay.frame({seenCar(5.0 + 0.8 * k, 2.0)});
  EXPECT_LT(replay.last.tracks.at(0).position.x(), 5.0 + 0.8 * 59 - 0.01);
}

TEST(MovingObjectTrackerTest, DoesNotRotateAStaticObject) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.15);
  std::bernoulli_distribution flipped(0.05);
  Replay replay;
  std::optional<double> converged_yaw;
  for (int k = 0; k < 300; ++k) {
    const double yaw = 0.5 + noise(random) + (flipped(random) ? M_PI : 0.0);
    replay.frame({seenCar(12 + noise(random), 3 + noise(random), yaw)});
    const Track& track = replay.last.tracks.at(0);
    EXPECT_FALSE(isMoving(track)) << "frame " << k;
    EXPECT_LT(std::abs(wrapAngle(track.yaw - 0.5)), 0.5);
    if (k == 20) converged_yaw = track.yaw;
    EXPECT_EQ(track.yaw, k > 20 ? *converged_yaw : track.yaw) << "frozen, frame " << k;
    EXPECT_EQ(track.yaw_rate, 0.0);
  }
}

TEST(MovingObjectTrackerTest, IsNotTurnedByFlippedDetections) {
  std::mt19937 random(4);
  std::bernoulli_distribution flipped(0.2);
  Replay replay;
  for (int k = 0; k < 200; ++k) {
    const bool flip = k > 3 && flipped(random);
    replay.frame({seenCar(5 + 0.7 * k, 0, flip ? M_PI : 0.0)});
    EXPECT_LT(std::abs(replay.last.tracks.at(0).yaw), 0.3) << "frame " << k;
  }
}

TEST(MovingObjectTrackerTest, EstimatesTheFrontFromThePath) {
  Replay replay;
  for (int k = 0; k < 30; ++k) replay.frame({seenCar(5 + 0.7 * k, 0, k < 2 ? M_PI : 0.0)});
  EXPECT_LT(std::abs(replay.last.tracks.at(0).yaw), 0.1);
}

TEST(MovingObjectTrackerTest, IsIndependentOfTheOrderOfDetections) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.2);
  Replay one;
  Replay other;
  for (int k = 0; k < 40; ++k) {
    std::vector<Detection> items;
    for (int i = 0; i < 12; ++i) {
      items.push_back(seenCar(8 + 2 * i + 0.3 * k + noise(random), 3.0 * (i % 3) + noise(random)));
      items.push_back(seenPerson(8 + i + noise(random), -5 + 0.1 * k + noise(random)));
    }
    one.frame(items);
    std::shuffle(items.begin(), items.end(), random);
    other.frame(items);
    ASSERT_EQ(one.last.tracks.size(), other.last.tracks.size());
    for (std::size_t i = 0; i < one.last.tracks.size(); ++i) {
      EXPECT_EQ(one.last.tracks[i].id, other.last.tracks[i].id);
      EXPECT_EQ(one.last.tracks[i].position, other.last.tracks[i].position);
      EXPECT_EQ(one.last.tracks[i].yaw, other.last.tracks[i].yaw);
    }
  }
}

TEST(MovingObjectTrackerTest, RedetectsALostObjectWithItsId) {
  ObjectsParams params;
  params.lifecycle.retrack_time_s = 3.0;
  Replay replay(params);
  int k = 0;
  for (; k < 20; ++k) replay.frame({seenPerson(8 + 0.14 * k, 0)});
  const TrackId id = replay.last.tracks.at(0).id;
  for (; k < 40; ++k) replay.frame({});  // two seconds behind a van
  EXPECT_THAT(replay.last.tracks, IsEmpty()) << "lost for long: not shown";
  replay.frame({seenPerson(8 + 0.14 * k, 0)});
  ASSERT_EQ(replay.last.tracks.size(), 1u);
  EXPECT_EQ(replay.last.tracks[0].id, id);
  EXPECT_EQ(replay.last.tracks[0].status, TrackStatus::kConfirmed);
}

TEST(MovingObjectTrackerTest, CoastsAlongWhileAnObjectIsHiddenForAMoment) {
  Replay replay;
  for (int k = 0; k < 20; ++k) replay.frame({seenCar(5 + 1.0 * k, 0)});
  for (int k = 20; k < 23; ++k) {
    replay.frame({});
    const Track& track = replay.last.tracks.at(0);
    EXPECT_EQ(track.status, TrackStatus::kCoasting);
    EXPECT_NEAR(track.position.x(), 5 + 1.0 * k, 0.2);
    EXPECT_FALSE(track.predictions.empty());
  }
}

TEST(MovingObjectTrackerTest, DoesNotCoastBeyondTheRangeThatIsMeasuredOrAllowed) {
  for (const bool is_measured : {true, false}) {
    ObjectsParams params;
    auto& bound = is_measured ? params.consistency.max_depth_m : params.consistency.max_range_m;
    bound = 24.5;
    Replay replay(params);
    for (int k = 0; k < 20; ++k) replay.frame({seenCar(5 + 1.0 * k, 0)});
    EXPECT_EQ(replay.last.tracks.size(), 1u) << "24 m away";
    replay.frame({});
    EXPECT_THAT(replay.last.tracks, IsEmpty()) << "25 m away";
    EXPECT_THAT(replay.last.detections_dropped, ElementsAre(Pair("track_too_far", 1u)));
  }
}

TEST(MovingObjectTrackerTest, ATrackThatCoastsStartsWhereItWasShown) {
  Replay replay;
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 0.4);
  double x = 10.0;
  for (int k = 0; k < 20; ++k) {
    x += 6.0 * kFrame_s;
    replay.frame({seenCar(x + noise(random), noise(random))});
  }
  ASSERT_EQ(replay.last.tracks.size(), 1u);
  const Track seen = replay.last.tracks[0];
  const Track coasting = replay.frame({}).tracks.at(0);
  ASSERT_EQ(coasting.status, TrackStatus::kCoasting);
  const Eigen::Vector3d step = coasting.position - seen.position;
  EXPECT_LT((step - kFrame_s * seen.velocity).norm(), 0.02);
}

TEST(MovingObjectTrackerTest, PredictsTheImageBoxOfACoastingTrack) {
  Replay replay;
  const auto seenWithBox = [](double x) {  // by a camera of 700 px focal length, centre (600, 200)
    Detection car = seenCar(x, -2);
    const double height_px = 700.0 * 1.5 / x;
    const double u = 600 + 700.0 * 2.0 / x;
    car.box2d =
        Box2d{u - 2 * height_px, 200 - 0.5 * height_px, u + 2 * height_px, 200 + 0.5 * height_px};
    return car;
  };
  const Detection lateral = seenCar(10, 6);  // widens the field of view
  for (int k = 0; k < 20; ++k) replay.frame({seenWithBox(30 - 0.5 * k), lateral});
  replay.frame({lateral});
  ASSERT_EQ(replay.last.tracks.size(), 2u);
  const bool first_coasts = replay.last.tracks[0].status == TrackStatus::kCoasting;
  const Track& track = replay.last.tracks[first_coasts ? 0 : 1];
  ASSERT_EQ(track.status, TrackStatus::kCoasting);
  const Box2d expected = *seenWithBox(20).box2d;
  ASSERT_TRUE(track.box2d);
  EXPECT_NEAR(track.box2d->left, expected.left, 1.0);
  EXPECT_NEAR(track.box2d->right, expected.right, 1.0);
  EXPECT_NEAR(track.box2d->height(), expected.height(), 0.5);
}

TEST(MovingObjectTrackerTest, DoesNotCoastAnUncertainTrack) {
  for (const double score : {-0.2, 5.0}) {
    Replay replay;
    for (int k = 0; k < 20; ++k) {
      replay.frame({test::seen(ObjectClass::kCar, {10, 0, 0}, 0.0, score)});
    }
    EXPECT_EQ(confirmed(replay.last).size(), 1u);
    replay.frame({});
    EXPECT_EQ(replay.last.tracks.empty(), score < 0.0);
  }
}

TEST(MovingObjectTrackerTest, ShowsTheBestScoredOfTwoClassesAtOnePosition) {
  Replay replay;
  for (int k = 0; k < 10; ++k) {
    replay.frame({test::seen(ObjectClass::kPedestrian, {10, 0, 0}, 0.0, 2.0),
                  test::seen(ObjectClass::kCyclist, {10.2, 0, 0}, 0.0, 5.0),
                  test::seen(ObjectClass::kPedestrian, {10, 3, 0}, 0.0, 2.0)});
  }
  ASSERT_EQ(confirmed(replay.last).size(), 2u);
  for (const Track& track : confirmed(replay.last)) {
    const bool alone = track.position.y() > 1.5;
    EXPECT_EQ(track.object_class, alone ? ObjectClass::kPedestrian : ObjectClass::kCyclist);
  }
}

TEST(MovingObjectTrackerTest, ScoresATrackByTheMeanOverItsLife) {
  ObjectsParams params;
  params.lifecycle.score_prior_time_s = 0.5;
  Replay replay(params);
  for (int k = 0; k < 10; ++k) replay.frame({test::seen(ObjectClass::kCar, {10, 0, 0}, 0, 3.0)});
  EXPECT_NEAR(replay.last.tracks.at(0).score, 30.0 / 15.0, 1e-12);
  replay.frame({});
  replay.frame({test::seen(ObjectClass::kCar, {10, 0, 0}, 0, 3.0)});
  EXPECT_NEAR(replay.last.tracks.at(0).score, 33.0 / 17.0, 1e-12) << "the frame unseen counts";
}

TEST(MovingObjectTrackerTest, AssignsANewIdAfterTheRetrackTime) {
  ObjectsParams params;
  params.lifecycle.retrack_time_s = 1.0;
  Replay replay(params);
  for (int k = 0; k < 20; ++k) replay.frame({seenPerson(8, 0)});
  const TrackId id = replay.last.tracks.at(0).id;
  for (int k = 0; k < 15; ++k) replay.frame({});
  EXPECT_EQ(replay.finalised.size(), 20u) << "the whole track was handed out when it ended";
  for (int k = 0; k < 3; ++k) replay.frame({seenPerson(8, 0)});
  EXPECT_NE(replay.last.tracks.at(0).id, id);
}

TEST(MovingObjectTrackerTest, KeepsTheIdsOfCrossingObjects) {
  Replay replay;
  std::optional<TrackId> upward;
  std::optional<TrackId> downward;
  for (int k = 0; k < 60; ++k) {
    const double t = kFrame_s * k - 3.0;
    replay.frame({seenPerson(12 + 1.2 * t, 1.0 * t + 0.05), seenPerson(12 + 1.2 * t, -1.0 * t)});
    if (k == 10) {
      for (const Track& track : replay.last.tracks) {
        (track.velocity.y() > 0.0 ? upward : downward) = track.id;
      }
    }
  }
  ASSERT_TRUE(upward && downward);
  ASSERT_EQ(confirmed(replay.last).size(), 2u);
  for (const Track& track : confirmed(replay.last)) {
    EXPECT_EQ(track.id, track.position.y() > 0.0 ? *upward : *downward);
  }
}

TEST(MovingObjectTrackerTest, MergesDetectionsOfOneObject) {
  Replay replay;
  for (int k = 0; k < 10; ++k) {
    Detection twin = seenCar(10.2, 0.1);
    twin.score = 0.5;
    replay.frame({seenCar(10, 0), twin, seenCar(10, 4)});
  }
  EXPECT_EQ(replay.last.tracks.size(), 2u);
  EXPECT_THAT(replay.dropped, ElementsAre(Pair("duplicate", 10u)));
  EXPECT_EQ(replay.used, 20u);
}

TEST(MovingObjectTrackerTest, MergesDetectionsOfOneImageBox) {
  Replay replay;
  Detection one = seenCar(20, 0);
  Detection deeper = seenCar(26, 0);
  one.box2d = Box2d{100, 100, 200, 150};
  deeper.box2d = Box2d{101, 100, 200, 151};
  replay.frame({one, deeper});
  EXPECT_THAT(replay.dropped, ElementsAre(Pair("duplicate", 1u)));
}

TEST(MovingObjectTrackerTest, KeepsAPersonAndACarApart) {
  Replay replay;
  for (int k = 0; k < 5; ++k) replay.frame({seenCar(10, 0), seenPerson(10, 0.6)});
  EXPECT_EQ(confirmed(replay.last).size(), 2u);
}

TEST(MovingObjectTrackerTest, RefusesTimesThatDoNotIncrease) {
  Replay replay;
  for (int k = 0; k < 5; ++k) replay.frame({seenCar(10, 0)});
  const Time now = replay.time() - kFrame_s;
  for (const Time time : {now, now - 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    replay.frameAt(time, {seenCar(30, 0), seenCar(40, 0)});
    EXPECT_THAT(replay.last.detections_dropped, ElementsAre(Pair("time_backwards", 2u)));
    EXPECT_EQ(replay.last.detections_used, 0u);
    ASSERT_EQ(replay.last.tracks.size(), 1u);
    EXPECT_NEAR(replay.last.tracks[0].position.x(), 10.0, 1e-6);
  }
}

TEST(MovingObjectTrackerTest, LivesThroughGapsOfTime) {
  for (const double gap : {0.05, 0.3, 1.0, 5.0, 60.0}) {
    ObjectsParams params;
    params.lifecycle.retrack_time_s = 3.0;
    Replay replay(params);
    for (int k = 0; k < 15; ++k) replay.frame({seenPerson(8 + 0.1 * k, 0)});
    const TrackId id = replay.last.tracks.at(0).id;
    replay.frameAt(replay.time() - kFrame_s + gap, {seenPerson(9.4 + gap, 0)});
    ASSERT_EQ(replay.last.tracks.size(), 1u) << gap;
    EXPECT_TRUE(replay.last.tracks[0].position.allFinite());
    EXPECT_EQ(replay.last.tracks[0].id == id, gap <= 3.0) << gap;
  }
}

TEST(MovingObjectTrackerTest, CountsUnusableDetections) {
  Replay replay;
  Detection broken = seenCar(10, 0);
  broken.box3d->centre.x() = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < 4; ++k) replay.frame({broken, seenCar(-5, 0), seenCar(10, 0)});
  EXPECT_THAT(replay.dropped, ElementsAre(Pair("behind_camera", 4u), Pair("nan_box", 4u)));
  EXPECT_EQ(confirmed(replay.last).size(), 1u);
}

TEST(MovingObjectTrackerTest, ProcessesTenThousandBoxes) {
  std::vector<Detection> items;
  for (int i = 0; i < 10000; ++i) items.push_back(seenPerson(2 + 1.1 * (i % 100), 1.1 * (i / 100)));
  ObjectsParams params;
  params.predictor = PredictorKind::kConstantVelocity;
  Replay replay(params);
  for (int k = 0; k < 3; ++k) replay.frame(items);
  EXPECT_EQ(replay.last.tracks.size(), 10000u);
  EXPECT_EQ(confirmed(replay.last).size(), 10000u);
  EXPECT_THAT(replay.dropped, IsEmpty());
}

TEST(MovingObjectTrackerTest, ReturnsEveryPositionOfATrackOnce) {
  Replay replay;
  for (int k = 0; k < 50; ++k) replay.frame({seenCar(10 + 0.5 * k, 0)});
  auto samples = replay.finalised;
  for (TrackSample& sample : replay.tracker().flush()) samples.push_back(std::move(sample));
  ASSERT_EQ(samples.size(), 50u);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    EXPECT_EQ(samples[k].frame, k);
    EXPECT_NEAR(samples[k].track.position.x(), 10 + 0.5 * static_cast<double>(k), 0.05);
    EXPECT_NEAR(samples[k].track.velocity.x(), 5.0, 0.5);
  }
  EXPECT_THAT(replay.tracker().flush(), IsEmpty());
}

TEST(MovingObjectTrackerTest, PredictsTracksInFramesWithoutDetection) {
  Replay replay;
  for (int k = 0; k < 20; ++k) replay.frame({seenCar(10 + 1.0 * k, 0)});
  const TrackUpdate coasted = replay.tracker().coast(20, replay.time());
  ASSERT_EQ(coasted.tracks.size(), 1u);
  EXPECT_EQ(coasted.tracks[0].status, TrackStatus::kCoasting);
  EXPECT_NEAR(coasted.tracks[0].position.x(), 30.0, 0.1);
}

TEST(MovingObjectTrackerTest, SmoothsANoisyPath) {
  std::mt19937 random(8);
  std::normal_distribution<double> noise(0.0, 0.3);
  double raw = 0.0;
  double ours = 0.0;
  ObjectsParams params;
  params.filter.position_sigma_m = 0.3;
  params.filter.across_sigma_ratio = 1.0;
  Replay replay(params);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d truth(10 + 0.12 * k, 4 * std::sin(0.03 * k));
    const Eigen::Vector2d seen = truth + Eigen::Vector2d(noise(random), noise(random));
    replay.frame({seenPerson(seen.x(), seen.y())});
    if (k < 7) continue;
    raw += (seen - truth).squaredNorm();
    ours += (replay.last.tracks.at(0).position.head<2>() - truth).squaredNorm();
  }
  EXPECT_LT(std::sqrt(ours), 0.75 * std::sqrt(raw));
}

TEST(MovingObjectTrackerTest, ClassifiesMotionWithoutFlicker) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 0.05);
  Replay replay;
  std::vector<bool> states;
  double x = 10.0;
  for (int k = 0; k < 240; ++k) {
    const bool drives = k >= 80 && k < 160;
    x += drives ? 0.4 : 0.0;
    replay.frame({seenCar(x + noise(random), noise(random))});
    states.push_back(isMoving(replay.last.tracks.at(0)));
  }
  EXPECT_FALSE(states[70]);
  EXPECT_TRUE(states[100]);
  EXPECT_FALSE(states[190]);
  int changes = 0;
  for (std::size_t k = 1; k < states.size(); ++k) changes += states[k] != states[k - 1];
  EXPECT_EQ(changes, 2);
}

/// A walker as a motion detector reports him, on his way to the left at 1.5 m/s.
Detection seenWalking(int frame) {
  Detection walker = seenPerson(10.0, 1.5 * test::kFrame_s * frame);
  walker.evidence.motion = true;
  walker.velocity = MeasuredVelocity{{-1.5, 0.0, 0.0}, 0.04 * Eigen::Matrix3d::Identity()};
  return walker;
}

TEST(MovingObjectTrackerTest, AnErrorThatDetectionsShareIsNotAveragedOut) {
  Replay stated, silent;
  for (int k = 0; k < 30; ++k) {
    Detection walker = seenWalking(k);  // the same part of him every time: nothing scatters
    silent.frame({walker});
    walker.centre_covariance = 0.0225 * Eigen::Matrix3d::Identity();
    stated.frame({walker});
  }
  const auto sigmaOf = [](const Replay& replay) {
    return std::sqrt(replay.last.tracks.at(0).position_covariance(1, 1));
  };
  EXPECT_NEAR(sigmaOf(stated), 0.15, 0.03);
  EXPECT_LT(sigmaOf(silent), 0.1);
  const auto spreadOf = [](const Replay& replay) {
    return replay.last.tracks.at(0).predictions.at(0).points.at(9).covariance.trace();
  };
  EXPECT_GT(spreadOf(stated), spreadOf(silent) + 0.0225);
}

TEST(MovingObjectTrackerTest, ExpectsObjectsWithEvidenceOfMotion) {
  Replay replay;
  replay.frame({seenWalking(0), seenCar(20.0, 5.0)});
  ASSERT_EQ(replay.last.expected.size(), 1u) << "no evidence that the car moves";
  const ExpectedObject& first = replay.last.expected[0];
  EXPECT_EQ(first.track, replay.last.tracks[0].id);
  EXPECT_EQ(first.observations, 1);
  EXPECT_NEAR(first.velocity.value.y(), 1.5, 1e-9) << "in the map, as it was measured";
  replay.frame({seenWalking(1)});
  replay.frame({});
  ASSERT_EQ(replay.last.expected.size(), 1u);
  const ExpectedObject& later = replay.last.expected[0];
  EXPECT_EQ(later.observations, 2);
  EXPECT_NEAR(later.time, 0.2, 1e-9);
  EXPECT_NEAR(later.last_observed, 0.1, 1e-9);
  EXPECT_NEAR(later.last_motion, 0.1, 1e-9);
  EXPECT_NEAR(later.position.y(), 0.3, 0.05) << "predicted to this frame";
  EXPECT_NEAR(later.positionAt(0.4).y(), 0.6, 0.05);
}

TEST(MovingObjectTrackerTest, OnlyMotionRenewsTheEvidenceOfMotion) {
  Replay replay;
  replay.frame({seenWalking(0)});
  Detection by_appearance = seenWalking(1);
  by_appearance.evidence = {};
  by_appearance.evidence.appearance = true;
  by_appearance.velocity->value.x() = -9.0;
  replay.frame({by_appearance});
  ASSERT_EQ(replay.last.expected.size(), 1u);
  EXPECT_NEAR(replay.last.expected[0].last_observed, 0.1, 1e-9);
  EXPECT_NEAR(replay.last.expected[0].last_motion, 0.0, 1e-9);
  EXPECT_NEAR(replay.last.expected[0].velocity.value.y(), 1.5, 1e-9);
}

TEST(MovingObjectTrackerTest, KeepsTheNewestTemplateButNotOneFoundByItself) {
  const auto templateAt = [](Time time) {
    AppearanceTemplate appearance;
    appearance.time = time;
    return std::make_shared<const AppearanceTemplate>(appearance);
  };
  const auto keptTime = [](const Replay& replay) {
    const auto& appearance = replay.last.expected.at(0).appearance;
    return appearance != nullptr ? appearance->time : -1.0;
  };
  Replay replay;
  Detection walker = seenWalking(0);
  walker.appearance = templateAt(0.0);
  replay.frame({walker});
  EXPECT_EQ(keptTime(replay), 0.0);
  walker = seenWalking(1);
  walker.appearance = templateAt(0.1);
  replay.frame({walker});
  EXPECT_EQ(keptTime(replay), 0.1);
  walker = seenWalking(2);
  walker.evidence = {};
  walker.evidence.appearance = true;
  replay.frame({walker});
  EXPECT_EQ(keptTime(replay), 0.1) << "a match of the template brings no new one";
  replay.frame({seenWalking(3)});
  EXPECT_EQ(keptTime(replay), -1.0) << "too little contrast now";
}

TEST(MovingObjectTrackerTest, VotesOverProvisionalClasses) {
  Replay replay;
  for (int k = 0; k < 6; ++k) {
    Detection walker = seenWalking(k);
    if (k == 2) walker.object_class = ObjectClass::kCar;
    replay.frame({walker});
    ASSERT_EQ(replay.last.tracks.size(), 1u)
        << "a provisional class starts no second track, frame " << k;
    EXPECT_EQ(replay.last.tracks[0].object_class,
              k < 4 ? ObjectClass::kUnknown : ObjectClass::kPedestrian)
        << k;
  }
}

TEST(MovingObjectTrackerTest, AnObjectOfUnknownClassIsPredictedAsWidelyAsAPedestrian) {
  Replay by_motion, classified;
  for (int k = 0; k < 2; ++k) {
    Detection walker = seenWalking(k);
    by_motion.frame({walker});
    walker.evidence.classifier = true;
    classified.frame({walker});
  }
  const Track unknown = confirmed(by_motion.last).at(0), person = confirmed(classified.last).at(0);
  ASSERT_EQ(unknown.object_class, ObjectClass::kUnknown);
  ASSERT_EQ(person.object_class, ObjectClass::kPedestrian);
  const auto spread = [](const Track& track, std::size_t j) {
    double widest = 0.0;
    for (const auto& path : track.predictions) {
      widest = std::max(widest, path.points.at(j).covariance.determinant());
    }
    return widest;
  };
  for (std::size_t j = 0; j < kPredictionSamples; ++j) {
    EXPECT_GE(spread(unknown, j), spread(person, j)) << j;
  }
}

/// The evidence of a frame that a network and a motion detector evaluated.
Detection tested(Detection detection, bool by_network, bool by_motion) {
  detection.evidence = {by_network, by_motion, false, false, true, true};
  if (!by_motion) detection.velocity.reset();
  return detection;
}

TEST(MovingObjectTrackerTest, ConfirmsABoxOfTheNetworkThatMovesAtOnce) {
  Replay replay;
  replay.frame({tested(seenWalking(0), true, true)});
  EXPECT_EQ(confirmed(replay.last).size(), 1u);
  Replay network_alone;
  network_alone.frame({tested(seenWalking(0), true, false)});
  EXPECT_TRUE(confirmed(network_alone.last).empty());
}

TEST(MovingObjectTrackerTest, MotionInWhichTheNetworkSeesNothingNeedsMoreEvidence) {
  Replay both, motion_alone, without_network;
  for (int k = 1; k <= 4; ++k) {
    both.frame({tested(seenWalking(k), k == 1, true)});
    motion_alone.frame({tested(seenWalking(k), false, true)});
    without_network.frame({seenWalking(k)});
    EXPECT_EQ(confirmed(both.last).size(), 1u) << k;
    EXPECT_EQ(confirmed(without_network.last).size(), k < 2 ? 0u : 1u) << k;
    EXPECT_EQ(confirmed(motion_alone.last).size(), k < 4 ? 0u : 1u) << k;
  }
}

/// A detection by a network that runs on each third frame, and by motion or not.
Detection byNetwork(Detection detection, bool by_motion) {
  detection = tested(detection, true, by_motion);
  detection.evidence.periodic = !by_motion;
  return detection;
}

TEST(MovingObjectTrackerTest, AFrameWithoutTheNetworkIsNoMissOfWhatItAloneSees) {
  Replay replay, each_frame;
  const Detection person =
      byNetwork(test::seen(ObjectClass::kPedestrian, {10, 0, 0}, 0, 0.7), false);
  for (int k = 0; k < 30; ++k) {
    replay.all_detectors_ran = k % 3 == 0;
    replay.frameAt(k / 15.0,
                   replay.all_detectors_ran ? std::vector{person} : std::vector<Detection>());
    each_frame.frameAt(k / 15.0, {person});
    ASSERT_EQ(replay.last.tracks.size(), 1u) << k;
    const Track& track = replay.last.tracks[0];
    EXPECT_EQ(track.id, TrackId{0}) << k;
    const auto between = k < 6 ? TrackStatus::kTentative : TrackStatus::kCoasting;
    EXPECT_EQ(track.status, replay.all_detectors_ran && k >= 6 ? TrackStatus::kConfirmed : between)
        << k;
    if (k % 3 > 0) continue;
    EXPECT_NEAR(track.score, each_frame.last.tracks.at(0).score, 1e-9) << k;
  }
  replay.all_detectors_ran = true;
  for (int k = 30; k < 40; ++k) replay.frameAt(k / 15.0, {});
  EXPECT_THAT(replay.last.tracks, IsEmpty()) << "now it is missed";
}

TEST(MovingObjectTrackerTest, MotionContinuesANetworksTrackOnEachFrame) {
  Replay replay;
  for (int k = 0; k < 30; ++k) {
    replay.all_detectors_ran = k % 3 == 0;
    Detection walker = seenPerson(10.0, 0.1 * k - 3.0);
    walker.evidence.motion = true;
    walker.velocity = MeasuredVelocity{{-1.5, 0.0, 0.0}, 0.04 * Eigen::Matrix3d::Identity()};
    if (replay.all_detectors_ran) {
      walker = byNetwork(walker, true);
    } else {
      walker.object_class = ObjectClass::kCyclist;  // provisional
    }
    replay.frameAt(k / 15.0, {walker});
    ASSERT_EQ(confirmed(replay.last).size(), 1u) << k;
    EXPECT_EQ(replay.last.tracks[0].object_class, ObjectClass::kPedestrian) << k;
    EXPECT_NEAR(replay.last.tracks[0].velocity.y(), 1.5, k > 0 ? 0.1 : 1.5) << k;
  }
  replay.all_detectors_ran = false;
  const double score = replay.last.tracks[0].score;
  replay.frameAt(2.0, {});
  EXPECT_LT(replay.last.tracks.at(0).score, score) << "stereo_motion did not see it";
}

TEST(MovingObjectTrackerTest, MotionNeedsMoreEvidenceUntilTheNetworkRunsAgain) {
  Replay replay;
  for (int k = 0; k < 4; ++k) {
    replay.all_detectors_ran = k % 2 == 0;
    const Detection walker = seenWalking(k);
    replay.frame({replay.all_detectors_ran ? tested(walker, false, true) : walker});
    EXPECT_EQ(confirmed(replay.last).size(), k < 3 ? 0u : 1u) << k;
  }
}

TEST(MovingObjectTrackerTest, ABoxWithoutMotionStands) {
  const auto moves = [](bool is_tested) {
    Replay replay;
    bool moved = false;
    for (int k = 0; k < 20; ++k) {
      Detection box = seenPerson(10.0, 1.5 * kFrame_s * k);  // its lifted position drifts
      box.evidence.classifier = true;
      box.evidence.classifier_tested = box.evidence.motion_tested = is_tested;
      moved = isMoving(replay.frame({box}).tracks.at(0)) || moved;
    }
    return moved;
  };
  EXPECT_TRUE(moves(false));
  EXPECT_FALSE(moves(true));
}

TEST(MovingObjectTrackerTest, ABicycleSeenSometimesMakesACyclist) {
  Replay replay;
  for (int k = 0; k < 12; ++k) {
    Detection rider = tested(seenWalking(k), true, true);
    if (k % 3 == 0) rider.object_class = ObjectClass::kCyclist;
    replay.frame({rider});
    ASSERT_EQ(replay.last.tracks.size(), 1u);
    EXPECT_EQ(replay.last.tracks[0].object_class, ObjectClass::kCyclist) << k;
  }
}

TEST(MovingObjectTrackerTest, AFastPersonRidesAHiddenBicycle) {
  Replay replay;
  for (int k = 0; k < 5; ++k) {
    Detection rider = tested(seenPerson(10.0, 4.5 * kFrame_s * k), true, true);
    rider.velocity = MeasuredVelocity{{-4.5, 0.0, 0.0}, 0.04 * Eigen::Matrix3d::Identity()};
    replay.frame({rider});
    ASSERT_EQ(replay.last.tracks.size(), 1u);
    EXPECT_EQ(replay.last.tracks[0].object_class, ObjectClass::kCyclist) << k;
  }
}

TEST(MovingObjectTrackerTest, ShrinksTheVelocityOfAStaticTrack) {
  Replay replay;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.15);
  int counted = 0;
  for (int k = 0; k < 40; ++k) {
    replay.frame({seenCar(30.0 + noise(random), 5.0 + noise(random))});
    const Track& track = replay.last.tracks.at(0);
    if (isMoving(track)) continue;
    ++counted;
    EXPECT_LT(track.velocity.norm(), 0.8) << "below the speed of moving objects, frame " << k;
    const Eigen::Matrix2d& covariance = track.velocity_covariance;
    EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-9));
    EXPECT_GT(covariance.determinant(), 0.0);
    EXPECT_LE(covariance(0, 0), 0.8 * 0.8) << "of the prior";
  }
  EXPECT_GT(counted, 30);
}

TEST(ObjectsParamsTest, DescribeEveryKeyOnceAndLoadTheirOutput) {
  ObjectsParams params;
  Params registry;
  params.describe(registry.section("objects"));
  registry.set("objects.predictor=paper_sv");
  registry.set("objects.motion_prior=least_kinetic");
  registry.set("objects.gaussian_smoothing=true");
  EXPECT_EQ(params.predictor, PredictorKind::kPaperSv);
  EXPECT_EQ(params.smoothing.motion_prior, MotionPriorKind::kLeastKinetic);
  EXPECT_TRUE(params.smoothing.gaussian_smoothing);
  EXPECT_THROW(registry.set("objects.predictor=crystal_ball"), InputError);
  EXPECT_THROW(registry.set("objects.gate_sigma=-1"), InputError);
}

std::string errorOf(const std::function<void(ObjectsParams&)>& change) {
  ObjectsParams params;
  change(params);
  return headway::test::inputErrorOf([&] { MovingObjectTracker tracker(params); });
}

TEST(ObjectsParamsTest, OutOfRangeAreRefusedByTheTracker) {
  using ::testing::StartsWith;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ("", errorOf([](ObjectsParams&) {}));
  EXPECT_EQ("[objects] max_range_m: '0' is out of range [m, 1 .. 10000]",
            errorOf([](ObjectsParams& p) { p.consistency.max_range_m = 0.0; }));
  EXPECT_THAT(errorOf([](ObjectsParams& p) { p.filter.acceleration_sigma_mps2.cyclist = -1.0; }),
              StartsWith("[objects] cyclist_filter_acceleration_mps2: '-1'"));
  EXPECT_THAT(errorOf([nan](ObjectsParams& p) { p.heading.flip_probability = nan; }),
              StartsWith("[objects] flip_probability: 'nan'"));
  EXPECT_THAT(errorOf([](ObjectsParams& p) { p.smoothing.window_s = 0.1; }),
              StartsWith("[objects] window_s: '0.1'"));
  EXPECT_THAT(errorOf([](ObjectsParams& p) { p.lifecycle.confirm_time_s = -1.0; }),
              StartsWith("[objects] confirm_time_s: '-1'"));
  EXPECT_THAT(errorOf([](ObjectsParams& p) { p.prediction.paper.spacing_s = 0.0; }),
              StartsWith("[objects] paper_spacing_s: '0'"));
  EXPECT_THAT(errorOf([](ObjectsParams& p) { p.prediction.manoeuvres.memory_s.vehicle = 0.0; }),
              StartsWith("[objects] vehicle_memory_s: '0'"));
}

TEST(ObjectsParamsTest, OutOfRangeAreRefusedByThePredictor) {
  PredictorParams params;
  params.velocity_window_s = 0.0;
  EXPECT_EQ("[objects] velocity_window_s: '0' is out of range [s, 0.05 .. 5]",
            headway::test::inputErrorOf(
                [&] { (void)makePredictor(PredictorKind::kConstantVelocity, params); }));
}

}  // namespace
}  // namespace headway::objects
