// SPDX-License-Identifier: BSD-3-Clause
// Degraded images (weather, camera faults) through the whole pipeline with the poses of its own
// SLAM: fewer objects may be detected, and unused data is counted, but there must not be many
// false tracks.

#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/degraded_images.h>
#include <headway_test/painted_street.h>
#include <headway_test/repeats.h>

#include <set>

namespace headway::pipeline {
namespace {

using test::PaintedBox;
using test::PaintedStreet;
using test::Trouble;

constexpr int kFrames = 16;
constexpr int kBlackFrame = 8;

const std::vector<PaintedBox> kStillStreet = {{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12},
                                              {{-4.5, 1.6, 22.0}, 0.5, 1.7, {0.0, 0.0, 0.0}, 13},
                                              {{-6.0, 1.6, 18.0}, 2.2, 1.8, {0.0, 0.0, 0.0}, 14}};
const PaintedBox kMovingBox{{-2.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11};

struct Outcome {
  std::set<TrackId> moving_tracks;  ///< confirmed ones found moving at some time
  DropCounts dropped;
  int lost = 0;
};

Outcome run(const PaintedStreet& street, const Trouble& trouble) {
  PerceptionParams params;
  params.detection.detector = "stereo_motion";
  Perception perception(street.camera(), params);
  Outcome outcome;
  for (int i = 0; i < kFrames; ++i) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = street.timeOf(i);
    frame.stereo = street.frame(i, trouble.right_late_s);
    trouble.spoil(i, *frame.stereo);
    const auto update = perception.process(frame);
    outcome.lost += update.camera.status == slam::TrackingStatus::kLost ? 1 : 0;
    for (const auto& [reason, count] : update.objects.detections_dropped) {
      outcome.dropped[reason] += count;
    }
    for (const auto& track : update.objects.tracks) {
      if (track.status == TrackStatus::kConfirmed && isMoving(track)) {
        outcome.moving_tracks.insert(track.id);
      }
    }
  }
  return outcome;
}

class InTroubleTest : public testing::TestWithParam<int> {};

TEST_P(InTroubleTest, AStaticStreetHasNoMovingObjects) {
  EXPECT_LE(run(PaintedStreet(kStillStreet), test::troubles(kBlackFrame)[GetParam()])
                .moving_tracks.size(),
            1u);
}

TEST_P(InTroubleTest, OneMovingObjectGivesAtMostTwoMovingTracks) {
  auto boxes = kStillStreet;
  boxes.push_back(kMovingBox);
  EXPECT_LE(run(PaintedStreet(boxes), test::troubles(kBlackFrame)[GetParam()]).moving_tracks.size(),
            2u);
}

INSTANTIATE_TEST_SUITE_P(Troubles, InTroubleTest, testing::Range(0, test::repeats(5, 2)),
                         [](const auto& index) {
                           return std::string(test::troubles(kBlackFrame)[index.param].name);
                         });

TEST(TroubleTest, ContinuesAfterABlackImage) {
  const auto outcome = run(PaintedStreet(kStillStreet), test::troubles(kBlackFrame)[3]);
  // One image of a pair is missing: its pose does not count until both have agreed for a second.
  EXPECT_LE(outcome.dropped.at("no_pose"), 11u) << "at 10 frames a second";
  EXPECT_EQ(1u, outcome.dropped.size());
  EXPECT_LE(outcome.lost, 2);
}

/// Runs a street whose clock is set by `step_s` before frame kSetFrame.
void runWithClockSet(double step_s, const std::string& warning) {
  constexpr int kSetFrame = 10;
  auto boxes = kStillStreet;
  boxes.push_back(kMovingBox);
  const PaintedStreet street(boxes);
  PerceptionParams params;
  params.detection.detector = "stereo_motion";
  Perception perception(street.camera(), params);
  std::set<TrackId> before, after;
  for (int i = 0; i < 2 * kSetFrame + 4; ++i) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = street.timeOf(i) + (i < kSetFrame ? 0.0 : step_s);
    frame.stereo = street.frame(i);
    frame.stereo->time = frame.time;
    const auto update = perception.process(frame);
    EXPECT_EQ(slam::TrackingStatus::kTracked, update.camera.status) << i;
    EXPECT_EQ(frame.time, perception.map().movingObjects().time());
    for (const auto& track : update.objects.tracks) {
      (i < kSetFrame ? before : after).insert(track.id);
    }
  }
  EXPECT_EQ(1u, perception.warnings().at(warning).count);
  EXPECT_EQ(static_cast<std::size_t>(kSetFrame), perception.warnings().at(warning).first_frame);
  EXPECT_FALSE(before.empty());
  EXPECT_FALSE(after.empty());
  for (const auto& id : after) EXPECT_EQ(0u, before.count(id)) << "tracks start anew";
}

TEST(TroubleTest, TracksGoOnOverATimeThatComesAgain) {
  const PaintedStreet street({kMovingBox});
  PerceptionParams params;
  params.detection.detector = "stereo_motion";
  Perception perception(street.camera(), params);
  std::set<TrackId> before, after;
  for (int i = 0; i < 18; ++i) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = street.timeOf(i == 12 ? 11 : i);
    frame.stereo = street.frame(i);
    frame.stereo->time = frame.time;
    const auto update = perception.process(frame);
    EXPECT_EQ(slam::TrackingStatus::kTracked, update.camera.status) << i;
    for (const auto& track : update.objects.tracks) {
      if (track.status == TrackStatus::kConfirmed) (i < 12 ? before : after).insert(track.id);
    }
  }
  EXPECT_EQ(1u, before.size());
  EXPECT_EQ(before, after);
  EXPECT_EQ(1u, perception.warnings().size());
  EXPECT_EQ(1u, perception.warnings().at("time_repeated").count);
}

TEST(TroubleTest, GoesOnAfterTheClockIsSetBack) { runWithClockSet(-3600.0, "clock_set_back"); }

TEST(TroubleTest, GoesOnAfterTheClockIsSetBackByOneSecond) {
  runWithClockSet(-1.0, "clock_set_back");
}

TEST(TroubleTest, GoesOnAfterTheClockIsSetAhead) { runWithClockSet(3600.0, "clock_jumps_ahead"); }

}  // namespace
}  // namespace headway::pipeline
