// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/eval/prediction_error.h>

#include <cmath>

namespace headway::eval {
namespace {

TrueObject objectAlongX(std::int64_t id, std::size_t frames, double speed, double y = 0.0,
                        ObjectClass object_class = ObjectClass::kCar) {
  TrueObject object;
  object.id = id;
  object.object_class = object_class;
  for (std::size_t k = 0; k < frames; ++k) {
    const double time = 0.1 * static_cast<double>(k);
    object.path.push_back({k, time, {speed * time, y, 0.0}, 0.0});
  }
  return object;
}

TrackPrediction predictionOf(const TrueObject& object, std::size_t frame, double offset,
                             std::int64_t track) {
  TrackPrediction prediction;
  prediction.frame = frame;
  prediction.time = 0.1 * static_cast<double>(frame);
  prediction.id.value = track;
  prediction.object_class = object.object_class;
  prediction.paths.resize(1);
  for (std::size_t j = 0; j < kHorizons; ++j) {
    PredictedPoint point;
    point.horizon_s = kHorizonStep_s * static_cast<double>(j + 1);
    const auto truth = object.positionAt(prediction.time + point.horizon_s, 1.0);
    point.position = truth.value_or(Eigen::Vector3d::Zero()) + Eigen::Vector3d(0, offset, 0);
    prediction.paths[0].points.push_back(point);
  }
  return prediction;
}

TEST(TrueObjectTest, InterpolatesBetweenFrames) {
  auto object = objectAlongX(1, 10, 5.0);
  EXPECT_NEAR(1.25, object.positionAt(0.25, 0.15)->x(), 1e-12);
  EXPECT_NEAR(4.5, object.positionAt(0.9, 0.15)->x(), 1e-12);
  EXPECT_FALSE(object.positionAt(0.95, 0.15).has_value());
  EXPECT_FALSE(object.positionAt(-0.05, 0.15).has_value());
  object.path.erase(object.path.begin() + 3, object.path.begin() + 6);
  EXPECT_FALSE(object.positionAt(0.4, 0.15).has_value());
  EXPECT_NEAR(2.0, object.positionAt(0.4, 0.45)->x(), 1e-12);
}

TEST(TrueObjectTest, TransformsLabelsToTheMap) {
  // A car 10 m ahead of a camera that drives forward and faces along the map's x axis.
  std::vector<LabelledFrame> frames(2);
  std::vector<Stamped<Pose>> T_map_cam;
  for (std::size_t k = 0; k < 2; ++k) {
    LabelledBox box;
    box.id = 4;
    box.object_class = ObjectClass::kCar;
    box.box3d = Box3d{{2.0, 1.0, 10.0}, 4.0, 2.0, 1.5, -M_PI / 2};  // facing away
    frames[k].truth = {box};
    Pose pose = robotFromOptical();
    pose.translation().x() = 3.0 * static_cast<double>(k);
    T_map_cam.push_back({0.1 * static_cast<double>(k), pose});
  }
  const auto objects = trueObjects(frames, T_map_cam);
  ASSERT_EQ(1u, objects.size());
  ASSERT_EQ(2u, objects[0].path.size());
  EXPECT_TRUE(objects[0].path[1].position.isApprox(Eigen::Vector3d(13.0, -2.0, -1.0), 1e-12));
  EXPECT_NEAR(0.0, objects[0].path[1].yaw, 1e-12);
  EXPECT_EQ(1u, objects[0].path[1].frame);
  EXPECT_TRUE(estimatedObjects(frames, T_map_cam).empty());
  std::swap(frames[0].truth, frames[0].estimates);
  EXPECT_EQ(1u, estimatedObjects(frames, T_map_cam).size());
  T_map_cam.pop_back();
  EXPECT_THROW((void)trueObjects(frames, T_map_cam), InputError);
}

TEST(HistoryCasesTest, NeedTwentyFramesBeforeAndThreeSecondsAfter) {
  EXPECT_EQ(0u, historyCases({objectAlongX(1, 50, 5.0)}, 0.1).size());
  const auto cases = historyCases({objectAlongX(1, 53, 5.0)}, 0.1);
  ASSERT_EQ(3u, cases.size());
  EXPECT_EQ(21u, cases[0].history.size());
  EXPECT_EQ(20u, cases[0].history.back().frame);
  EXPECT_NEAR(10.0 + 0.5, cases[0].future[0].x(), 1e-9);
  EXPECT_NEAR(10.0 + 15.0, cases[0].future[29].x(), 1e-9);
}

TEST(HistoryCasesTest, AreInterruptedByGaps) {
  auto object = objectAlongX(1, 101, 5.0);
  EXPECT_EQ(51u, historyCases({object}, 0.1).size());
  object.path.erase(object.path.begin() + 50);
  EXPECT_EQ(0u, historyCases({object}, 0.1).size());
}

TEST(HistoryCasesTest, AreOfMovableClassesOnly) {
  for (const auto object_class : {ObjectClass::kMisc, ObjectClass::kPersonSitting}) {
    EXPECT_EQ(0u, historyCases({objectAlongX(1, 60, 5.0, 0.0, object_class)}, 0.1).size());
  }
  for (const auto object_class : {ObjectClass::kTram, ObjectClass::kCyclist}) {
    EXPECT_EQ(10u, historyCases({objectAlongX(1, 60, 5.0, 0.0, object_class)}, 0.1).size());
  }
}

TEST(TrackCasesTest, EachPredictionFindsTheNearestObjectOfItsClass) {
  const std::vector<TrueObject> objects = {objectAlongX(1, 60, 5.0, 0.0),
                                           objectAlongX(2, 60, 5.0, 1.5),
                                           objectAlongX(3, 60, 5.0, 0.0, ObjectClass::kPedestrian)};
  // Both are nearest to object 1; the assignment gives one of them object 0's neighbour.
  const auto found = trackCases(
      objects, {predictionOf(objects[0], 10, 0.1, 7), predictionOf(objects[0], 10, 0.6, 8)}, 2.0,
      0.25);
  ASSERT_EQ(2u, found.cases.size());
  EXPECT_EQ(0u, found.cases[0].object);
  EXPECT_EQ(1u, found.cases[1].object);
  EXPECT_NEAR(5.0 + 15.0, found.cases[0].future[29].x(), 1e-9);
}

TEST(TrackCasesTest, AnUnknownClassMayBeAnyObject) {
  const std::vector<TrueObject> objects = {objectAlongX(1, 60, 5.0, 0.0, ObjectClass::kPedestrian)};
  auto prediction = predictionOf(objects[0], 10, 0.1, 7);
  prediction.object_class = ObjectClass::kUnknown;
  EXPECT_EQ(1u, trackCases(objects, {prediction}, 2.0, 0.25).cases.size());
}

TEST(TrackCasesTest, CountsUnmatchedAndTruncatedPredictions) {
  const std::vector<TrueObject> objects = {objectAlongX(1, 60, 5.0)};
  auto pedestrian = predictionOf(objects[0], 10, 0.0, 1);
  pedestrian.object_class = ObjectClass::kPedestrian;
  const auto found = trackCases(objects,
                                {predictionOf(objects[0], 10, 2.1, 1),  // too far off
                                 predictionOf(objects[0], 40, 0.0, 1),  // ends at frame 59
                                 predictionOf(objects[0], 29, 0.0, 1),  // just long enough
                                 pedestrian},
                                2.0, 0.25);
  EXPECT_EQ(1u, found.cases.size());
  EXPECT_EQ(2u, found.unmatched);
  EXPECT_EQ(1u, found.cut_short);
}

}  // namespace
}  // namespace headway::eval
