// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/eval/track_error.h>

#include <cmath>
#include <functional>

namespace headway::eval {
namespace {

/// Image box in lane `lane`, shifted by `shift` of its 50 px: overlap (50 - s) / (50 + s).
LabelledBox box2dAt(std::int64_t id, int lane, double shift = 0.0, double height = 50.0,
                    ObjectClass object_class = ObjectClass::kCar) {
  LabelledBox box;
  box.id = id;
  box.object_class = object_class;
  box.box2d = Box2d{200.0 * lane + shift, 0.0, 200.0 * lane + shift + 50.0, height};
  box.score = 1.0;
  return box;
}

LabelledBox scored(LabelledBox box, double score) {
  box.score = score;
  return box;
}

LabelledBox box3dAt(std::int64_t id, double x, double z) {
  LabelledBox box;
  box.id = id;
  box.object_class = ObjectClass::kCar;
  box.box3d = Box3d{{x, 1.0, z}, 4.0, 2.0, 1.5, 0.0};
  return box;
}

LabelledSequence sequenceOf(std::size_t frames) {
  return {"0000", std::vector<LabelledFrame>(frames)};
}

TrackErrorParams imageParams(double min_overlap = 0.5) {
  TrackErrorParams params;
  params.metric = BoxMetric::k2d;
  params.min_overlap = min_overlap;
  return params;
}

TrackError evaluateCars(const LabelledSequence& sequence,
                        const TrackErrorParams& params = imageParams()) {
  return trackErrors({sequence}, params).classes.at(ObjectClass::kCar);
}

TEST(TrackErrorTest, PerfectTracksArePerfectInEveryFigure) {
  auto sequence = sequenceOf(10);
  for (auto& frame : sequence.frames) {
    frame.truth = {box2dAt(7, 0), box2dAt(9, 1)};
    frame.estimates = {box2dAt(100, 1), box2dAt(3, 0)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(20u, error.truth_boxes);
  EXPECT_EQ(20u, error.tp);
  EXPECT_EQ(0u, error.fp + error.fn + error.idsw + error.frag);
  for (const auto& figure : {error.mota, error.motp, error.hota, error.deta, error.assa,
                             error.samota, error.amota, error.precision, error.recall, error.f1}) {
    EXPECT_NEAR(1.0, figure.value(), 1e-12);
  }
}

TEST(TrackErrorTest, AGapAndANewIdentityAreOneFragmentationAndOneSwitch) {
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0), box2dAt(2, 3)};
    sequence.frames[k].estimates = {box2dAt(8, 3)};
    if (k != 4) sequence.frames[k].estimates.push_back(box2dAt(k < 4 ? 1 : 2, 0));
  }
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(19u, error.tp);
  EXPECT_EQ(1u, error.fn);
  EXPECT_EQ(1u, error.idsw);
  EXPECT_EQ(1u, error.frag);
  EXPECT_NEAR(1.0 - 2.0 / 20.0, error.mota.value(), 1e-12);
}

/// Two objects with a track each; the first is changed in frames 4 and 5.
std::size_t fragmentationsOf(const std::function<void(LabelledFrame&)>& change) {
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0), box2dAt(2, 3)};
    sequence.frames[k].estimates = {box2dAt(1, 0), box2dAt(2, 3)};
    if (k == 4 || k == 5) change(sequence.frames[k]);
  }
  return evaluateCars(sequence).frag;
}

TEST(TrackErrorTest, FragmentationsAreCountedAsTrackEvalDoes) {
  EXPECT_EQ(1u,
            fragmentationsOf([](auto& frame) { frame.estimates.erase(frame.estimates.begin()); }));
  EXPECT_EQ(1u, fragmentationsOf([](auto& frame) { frame.truth.erase(frame.truth.begin()); }));
  EXPECT_EQ(1u, fragmentationsOf([](auto& frame) { frame.truth[0].occlusion = 3; }));
  // Frames without any estimate, or without any truth that counts, are passed over.
  EXPECT_EQ(0u, fragmentationsOf([](auto& frame) { frame.estimates.clear(); }));
  EXPECT_EQ(0u, fragmentationsOf([](auto& frame) { frame.truth.clear(); }));
  EXPECT_EQ(0u, fragmentationsOf([](auto& frame) {
              for (auto& truth : frame.truth) truth.occlusion = 3;
            }));
  // The only estimate is small and unmatched, so it does not count.
  EXPECT_EQ(0u,
            fragmentationsOf([](auto& frame) { frame.estimates = {box2dAt(9, 6, 0.0, 20.0)}; }));
}

TEST(TrackErrorTest, MissesAtTheEndsAreNoFragmentation) {
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0)};
    if (k >= 3 && k < 7) sequence.frames[k].estimates = {box2dAt(5, 0)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(6u, error.fn);
  EXPECT_EQ(0u, error.frag);
  EXPECT_EQ(0u, error.idsw);
}

TEST(TrackErrorTest, KeepsAValidMatchDespiteABetterOverlap) {
  auto sequence = sequenceOf(6);
  for (std::size_t k = 0; k < 6; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0)};
    sequence.frames[k].estimates = {box2dAt(1, 0, 5.0)};
    if (k >= 3) sequence.frames[k].estimates.push_back(box2dAt(2, 0, 0.0));
  }
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(0u, error.idsw);
  EXPECT_EQ(3u, error.fp);
  EXPECT_NEAR(45.0 / 55.0, error.motp.value(), 1e-12);
}

TEST(TrackErrorTest, OverlapBelowTheLimitIsAMissAndAFalsePositive) {
  auto sequence = sequenceOf(1);
  sequence.frames[0].truth = {box2dAt(1, 0)};
  sequence.frames[0].estimates = {box2dAt(1, 0, 20.0)};  // overlap 3/7
  EXPECT_EQ(1u, evaluateCars(sequence, imageParams(0.5)).fp);
  EXPECT_EQ(1u, evaluateCars(sequence, imageParams(0.5)).fn);
  EXPECT_EQ(1u, evaluateCars(sequence, imageParams(0.4)).tp);
}

TEST(TrackErrorTest, ScaledAccuracyMatchesAHandComputedCase) {
  // Two objects; a sure right track, a false one in the middle, an unsure right one.
  auto sequence = sequenceOf(10);
  for (auto& frame : sequence.frames) {
    frame.truth = {box2dAt(1, 0), box2dAt(2, 1)};
    frame.estimates = {scored(box2dAt(1, 0), 0.9), scored(box2dAt(2, 2), 0.5),
                       scored(box2dAt(3, 1), 0.1)};
  }
  const auto error = evaluateCars(sequence);
  double samota = 20.0;  // recalls up to one half: nothing wrong that the recall does not ask for
  for (int k = 21; k <= 40; ++k) samota += 0.5 / (k / 40.0);
  EXPECT_NEAR(samota / 40.0, error.samota.value(), 1e-12);
  EXPECT_NEAR(0.5, error.amota.value(), 1e-12);
  EXPECT_NEAR(0.5, error.mota.value(), 1e-12);
  EXPECT_EQ(40u, error.curve.size());
  EXPECT_DOUBLE_EQ(0.9, error.curve.front().score_threshold);
  EXPECT_DOUBLE_EQ(0.1, error.curve.back().score_threshold);
}

TEST(TrackErrorTest, RecallsThatAreNotReachedCountAsZero) {
  auto sequence = sequenceOf(10);
  for (auto& frame : sequence.frames) {
    frame.truth = {box2dAt(1, 0), box2dAt(2, 1)};
    frame.estimates = {box2dAt(1, 0)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(20u, error.curve.size());
  EXPECT_NEAR(20.0 / 40.0, error.samota.value(), 1e-12);
  EXPECT_NEAR(20.0 * 0.5 / 40.0, error.amota.value(), 1e-12);
}

TEST(TrackErrorTest, BestAccuracyExcludesFalseTracksOfLowScore) {
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    auto& frame = sequence.frames[k];
    frame.truth = {box2dAt(1, 0)};
    // The mean over the track decides, not the score of one frame.
    frame.estimates = {scored(box2dAt(1, 0), k == 0 ? 0.1 : 0.9), scored(box2dAt(2, 1), 0.3)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_NEAR(1.0, error.mota.value(), 1e-12);
  EXPECT_NEAR(0.82, error.score_threshold.value(), 1e-12);
  EXPECT_EQ(10u, error.tp);
  EXPECT_NEAR(0.5, error.precision.value(), 1e-12) << "positions are judged without threshold";
}

TEST(TrackErrorTest, HotaOfATrackInTwoHalves) {
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0)};
    sequence.frames[k].estimates = {box2dAt(k < 5 ? 1 : 2, 0)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_NEAR(1.0, error.deta.value(), 1e-12);
  EXPECT_NEAR(0.5, error.assa.value(), 1e-12);
  EXPECT_NEAR(std::sqrt(0.5), error.hota.value(), 1e-12);
}

TEST(TrackErrorTest, HotaOfADriftingTrack) {
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0)};
    sequence.frames[k].estimates = {box2dAt(1, k < 5 ? 0 : 1)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_NEAR(1.0 / 3.0, error.deta.value(), 1e-12);  // 5 / (5 + 5 + 5)
  EXPECT_NEAR(1.0 / 3.0, error.assa.value(), 1e-12);
  EXPECT_NEAR(1.0 / 3.0, error.hota.value(), 1e-12);
}

TEST(TrackErrorTest, HotaCountsTheOverlapsThatAreReached) {
  auto sequence = sequenceOf(4);
  for (auto& frame : sequence.frames) {
    frame.truth = {box2dAt(1, 0)};
    frame.estimates = {box2dAt(1, 0, 12.5)};  // overlap 0.6
  }
  EXPECT_NEAR(12.0 / 19.0, evaluateCars(sequence).hota.value(), 1e-12);
}

TEST(TrackErrorTest, HotaPrefersTheMatchOfTheCompleteTrack) {
  // Track 1 follows all along; track 2 overlaps more for one frame. Giving that frame to track 2
  // would leave an association of (9 * 9/10 + 1 * 1/10) / 10 = 0.82.
  auto sequence = sequenceOf(10);
  for (std::size_t k = 0; k < 10; ++k) {
    sequence.frames[k].truth = {box2dAt(1, 0)};
    sequence.frames[k].estimates = {box2dAt(1, 0, 1.0)};
    if (k == 5) sequence.frames[k].estimates.push_back(box2dAt(2, 0, 0.0));
  }
  const auto error = evaluateCars(sequence);
  EXPECT_NEAR(1.0, error.assa.value(), 1e-12);
  EXPECT_NEAR(10.0 / 11.0, error.deta.value(), 1e-12);
}

TEST(TrackErrorTest, NeighbouringClassesAndIgnoredTruthAreNotCounted) {
  auto sequence = sequenceOf(1);
  auto& frame = sequence.frames[0];
  auto van = box2dAt(1, 0, 0.0, 50.0, ObjectClass::kVan);
  auto unseen_van = box2dAt(2, 1, 0.0, 50.0, ObjectClass::kVan);
  auto occluded = box2dAt(3, 2);
  occluded.occlusion = 3;
  auto truncated = box2dAt(4, 3);
  truncated.truncation = 1.0;
  frame.truth = {van, unseen_van, occluded, truncated, box2dAt(5, 4)};
  frame.estimates = {box2dAt(1, 0), box2dAt(2, 2), box2dAt(3, 3), box2dAt(4, 4)};
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(1u, error.truth_boxes);
  EXPECT_EQ(1u, error.tp);
  EXPECT_EQ(0u, error.fp);
  EXPECT_EQ(0u, error.fn);
  EXPECT_NEAR(1.0, error.hota.value(), 1e-12);
  EXPECT_NEAR(1.0, error.precision.value(), 1e-12);
  EXPECT_NEAR(1.0, error.recall.value(), 1e-12);
}

TEST(TrackErrorTest, OtherClassesAreNoNeighbours) {
  auto sequence = sequenceOf(1);
  sequence.frames[0].truth = {box2dAt(1, 0, 0.0, 50.0, ObjectClass::kTruck), box2dAt(2, 1)};
  sequence.frames[0].estimates = {box2dAt(1, 0)};
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(1u, error.fp);
  EXPECT_EQ(1u, error.fn);
}

TEST(TrackErrorTest, UnmatchedSmallBoxesAndDontCareRegionsAreIgnored) {
  auto sequence = sequenceOf(1);
  auto& frame = sequence.frames[0];
  frame.truth = {box2dAt(1, 0, 0.0, 20.0), box2dAt(2, 5)};
  frame.dont_care = {Box2d{400, 0, 426, 50}, Box2d{600, 0, 624, 50}};
  frame.estimates = {box2dAt(1, 0, 0.0, 20.0),  // small but right
                     box2dAt(2, 1, 0.0, 25.0),  // small: no harm
                     box2dAt(3, 2),             // 52 % inside: no harm
                     box2dAt(4, 3)};            // 48 % inside: wrong
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(1u, error.tp);
  EXPECT_EQ(1u, error.fp);
  EXPECT_EQ(1u, error.fn);
}

TEST(TrackErrorTest, HistoryRestartsAfterIgnoredTruth) {
  auto sequence = sequenceOf(9);
  for (std::size_t k = 0; k < 9; ++k) {
    auto truth = box2dAt(1, 0);
    if (k >= 3 && k < 6) truth.occlusion = 3;
    sequence.frames[k].truth = {truth};
    if (k < 3) sequence.frames[k].estimates = {box2dAt(1, 0)};
    if (k >= 6) sequence.frames[k].estimates = {box2dAt(2, 0)};
  }
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(6u, error.tp);
  EXPECT_EQ(0u, error.idsw + error.frag + error.fn);
}

TEST(TrackErrorTest, PositionsAreCorrectWithinTwoMetresOnTheGround) {
  auto sequence = sequenceOf(2);
  for (auto& frame : sequence.frames) {
    frame.truth = {box3dAt(1, 0.0, 10.0), box3dAt(2, 10.0, 10.0), box3dAt(3, 20.0, 10.0)};
    auto lifted = box3dAt(2, 10.0, 10.5);
    lifted.box3d->centre.y() += 5.0;  // height does not matter on the ground
    frame.estimates = {box3dAt(1, 0.3, 10.4), lifted, box3dAt(3, 20.0, 12.1)};
  }
  const auto error = evaluateCars(sequence, TrackErrorParams());
  EXPECT_NEAR(0.5, error.rmse_m.value(), 1e-12);
  EXPECT_NEAR(2.0 / 3.0, error.precision.value(), 1e-12);
  EXPECT_NEAR(2.0 / 3.0, error.recall.value(), 1e-12);
  EXPECT_NEAR(2.0 / 3.0, error.f1.value(), 1e-12);
  EXPECT_EQ(2u, error.tp) << "the lifted box does not overlap";
}

TEST(TrackErrorTest, ClassesAndSequencesArePooled) {
  auto cars = sequenceOf(4);
  auto people = sequenceOf(4);
  for (auto& frame : cars.frames) {
    frame.truth = {box2dAt(1, 0)};
    frame.estimates = {box2dAt(1, 0)};
  }
  for (auto& frame : people.frames) {
    frame.truth = {box2dAt(1, 0, 0.0, 50.0, ObjectClass::kPedestrian)};
  }
  const auto errors = trackErrors({cars, people}, imageParams());
  EXPECT_NEAR(1.0, errors.classes.at(ObjectClass::kCar).mota.value(), 1e-12);
  EXPECT_NEAR(0.0, errors.classes.at(ObjectClass::kPedestrian).mota.value(), 1e-12);
  EXPECT_NEAR(0.5, errors.all.mota.value(), 1e-12);
  EXPECT_NEAR(0.5, errors.all.samota.value(), 1e-12);
  EXPECT_EQ(8u, errors.all.truth_boxes);
}

TEST(TrackErrorTest, IdentitiesOfDifferentSequencesAreIndependent) {
  auto first = sequenceOf(3);
  auto second = sequenceOf(3);
  for (auto& frame : first.frames) {
    frame.truth = {box2dAt(1, 0)};
    frame.estimates = {box2dAt(1, 0)};
  }
  for (auto& frame : second.frames) {
    frame.truth = {box2dAt(1, 0)};
    frame.estimates = {box2dAt(2, 0)};
  }
  EXPECT_EQ(0u, trackErrors({first, second}, imageParams()).all.idsw);
}

TEST(TrackErrorTest, WithoutTruthOnlyFalsePositivesAreCounted) {
  auto sequence = sequenceOf(2);
  sequence.frames[0].estimates = {box2dAt(1, 0)};
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(1u, error.fp);
  EXPECT_FALSE(error.mota || error.samota || error.hota || error.recall || error.rmse_m);
  EXPECT_EQ(0.0, error.precision.value());
}

TEST(TrackErrorTest, WithoutEstimatesEverythingIsMissed) {
  auto sequence = sequenceOf(2);
  sequence.frames[0].truth = {box2dAt(1, 0)};
  const auto error = evaluateCars(sequence);
  EXPECT_EQ(1u, error.fn);
  EXPECT_EQ(0.0, error.mota.value());
  EXPECT_EQ(0.0, error.hota.value());
  EXPECT_EQ(0.0, error.samota.value());
  EXPECT_FALSE(error.precision || error.motp || error.rmse_m);
}

TEST(TrackErrorTest, OrderOfRowsDoesNotMatter) {
  auto sequence = sequenceOf(12);
  for (std::size_t k = 0; k < 12; ++k) {
    for (int lane = 0; lane < 5; ++lane) {
      sequence.frames[k].truth.push_back(box2dAt(lane, lane));
      if ((k + static_cast<std::size_t>(lane)) % 4 == 0) continue;
      const int id = static_cast<int>(k) / 5 + 10 * lane;
      sequence.frames[k].estimates.push_back(scored(box2dAt(id, lane, 3.0 * lane), 0.1 * id));
    }
  }
  auto turned = sequence;
  for (auto& frame : turned.frames) {
    frame.truth = {frame.truth.rbegin(), frame.truth.rend()};
    frame.estimates = {frame.estimates.rbegin(), frame.estimates.rend()};
  }
  const auto a = evaluateCars(sequence);
  const auto b = evaluateCars(turned);
  EXPECT_EQ(a.idsw, b.idsw);
  EXPECT_EQ(a.frag, b.frag);
  EXPECT_NEAR(a.mota.value(), b.mota.value(), 1e-12);
  EXPECT_NEAR(a.samota.value(), b.samota.value(), 1e-12);
  EXPECT_NEAR(a.hota.value(), b.hota.value(), 1e-12);
}

}  // namespace
}  // namespace headway::eval
