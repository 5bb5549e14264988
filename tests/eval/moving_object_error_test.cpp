// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/eval/moving_object_error.h>

#include <cmath>

namespace headway::eval {
namespace {

using testing::ElementsAre;
using testing::Pair;

constexpr int kFrames = 20;

/// A standing camera and one object that crosses at 2 m/s, 20 m ahead, with a track on it.
struct Scene {
  Scene() {
    input.labels.resize(kFrames);
    input.end_frame = kFrames;
    input.image_width = 1000;
    input.image_height = 400;
    for (int k = 0; k < kFrames; ++k) {
      input.T_world_cam.push_back({0.1 * k, robotFromOptical()});
      input.T_map_cam[static_cast<std::size_t>(k)] = robotFromOptical();
    }
  }

  /// Labels an object that moves along the camera's x axis.
  void addLabels(std::int64_t id, ObjectClass object_class, double x, double z, double speed,
                 int frames = kFrames, int occlusion = 0) {
    for (int k = 0; k < frames; ++k) {
      LabelledBox box;
      box.id = id;
      box.object_class = object_class;
      box.box3d = Box3d{{x + 0.1 * speed * k, 1.0, z}, 4.0, 1.8, 1.5, 0.0};
      box.occlusion = occlusion;
      input.labels[static_cast<std::size_t>(k)].truth.push_back(box);
    }
  }

  TrackRow& addRow(int frame, std::int64_t id, ObjectClass object_class, double x, double z) {
    TrackRow row;
    row.frame = static_cast<std::size_t>(frame);
    row.id = id;
    row.object_class = object_class;
    row.moving = true;
    row.centre = {x, 1.0, z};
    row.box2d = Box2d{480.0, 180.0, 520.0, 220.0};
    row.T_map_object.linear() =
        Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    row.T_map_object.translation() = robotFromOptical() * row.centre;
    input.rows.push_back(row);
    return input.rows.back();
  }

  MovingObjectError evaluate(const MovingObjectParams& params = {}) const {
    return movingObjectError(input, params);
  }

  MovingObjectInput input;
};

TEST(LabelledObjectErrorTest, CountsNearVisibleLabelsAndTheClassOfTheirTracks) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kVan, 0.0, 15.0, 0.0);
  scene.addLabels(2, ObjectClass::kCyclist, 6.0, 20.0, 0.0);
  scene.addLabels(3, ObjectClass::kCar, 6.0, 35.0, 0.0);               // too far
  scene.addLabels(4, ObjectClass::kCar, -6.0, 15.0, 0.0, kFrames, 2);  // too occluded
  for (int k = 0; k < 15; ++k) scene.addRow(k, 7, ObjectClass::kCar, 0.5, 15.0).moving = false;
  for (int k = 0; k < 10; ++k) scene.addRow(k, 8, ObjectClass::kPedestrian, 6.0, 20.5);
  scene.addRow(11, 8, ObjectClass::kCyclist, 6.0, 20.5).coasting = true;
  scene.addRow(12, 9, ObjectClass::kCar, 12.0, 20.0);  // of an object without label
  const auto error = labelledObjectError(scene.input, {});
  EXPECT_EQ(40u, error.all.labels);
  EXPECT_EQ(25u, error.all.found);
  EXPECT_EQ(15u, error.all.found_as_class) << "a van may be called a car";
  EXPECT_NEAR(15.0 / 25.0, *error.all.classRatio(), 1e-12);
  EXPECT_NEAR(0.5, *error.classes.at("Cyclist").recall(), 1e-12);
  EXPECT_EQ(0u, error.classes.count("Car"));
}

TEST(MovingObjectErrorTest, CountsFoundLabelsByClassRangeAndOcclusion) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kVan, 0.0, 15.0, 2.0, kFrames, 2);
  scene.addLabels(2, ObjectClass::kPedestrian, -8.0, 50.0, 1.5);
  for (int k = 0; k < 15; ++k) scene.addRow(k, 7, ObjectClass::kCar, 0.2 * k + 1.9, 15.0);
  for (int k = 0; k < 10; ++k) scene.addRow(k, 8, ObjectClass::kCyclist, -8.0, 54.5);
  const auto error = scene.evaluate();
  EXPECT_EQ(20u, error.frames);
  EXPECT_EQ(40u, error.all.labels);
  EXPECT_EQ(25u, error.all.found);           // 4.5 m at 50 m is within 10 % of the range
  EXPECT_EQ(15u, error.all.found_as_class);  // a van may be called a car
  EXPECT_NEAR(15.0 / 20.0, *error.within_40m.recall(), 1e-12);
  EXPECT_NEAR(15.0 / 20.0, *error.classes.at("Van").recall(), 1e-12);
  EXPECT_NEAR(0.5, *error.classes.at("Pedestrian").recall(), 1e-12);
  EXPECT_NEAR(0.0, *error.classes.at("Pedestrian").recallAsClass(), 1e-12);
  EXPECT_EQ(10u, error.classes.at("Cyclist").right);
  EXPECT_EQ(0u, error.classes.at("Cyclist").right_as_class);
  EXPECT_EQ(20u, error.ranges.at("10-20").labels);
  EXPECT_EQ(20u, error.ranges.at("40-").labels);
  EXPECT_EQ(15u, error.occlusion.at("2").found);
  EXPECT_NEAR(1.0, *error.all.precision(), 1e-12);
  EXPECT_EQ(0u, error.false_tracks);
}

TEST(MovingObjectErrorTest, TheDistanceLimitIsTwoMetresNearby) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kCar, 0.0, 10.0, 2.0);
  scene.addRow(0, 7, ObjectClass::kCar, 1.99, 10.0);
  scene.addRow(1, 7, ObjectClass::kCar, 0.2 + 2.05, 10.0);
  const auto error = scene.evaluate();
  EXPECT_EQ(1u, error.all.found);
  EXPECT_EQ(1u, error.all.right);
  EXPECT_EQ(2u, error.all.rows);
}

TEST(MovingObjectErrorTest, RowsOnSlowLabelsAreRightAndOnStillOnesWrong) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kPedestrian, -5.0, 10.0, 0.7);
  scene.addLabels(2, ObjectClass::kCar, 5.0, 10.0, 0.3);
  for (int k = 0; k < 8; ++k) {
    scene.addRow(k, 7, ObjectClass::kPedestrian, -5.0, 10.0);
    scene.addRow(k, 8, ObjectClass::kCar, 5.0, 10.0);
  }
  const auto error = scene.evaluate();
  EXPECT_EQ(0u, error.all.labels);  // none is faster than 1 m/s
  EXPECT_FALSE(error.all.recall());
  EXPECT_EQ(16u, error.all.rows);
  EXPECT_EQ(8u, error.all.right);
  ASSERT_EQ(2u, error.tracks.size());
  EXPECT_FALSE(error.tracks[0].isFalse());
  EXPECT_TRUE(error.tracks[1].isFalse());
  EXPECT_EQ(0u, error.tracks[1].first_frame);
  EXPECT_EQ(7u, error.tracks[1].last_frame);
  EXPECT_NEAR(5.0, *error.falseTracksPer100Frames(), 1e-12);
}

TEST(MovingObjectErrorTest, StaticAndCoastingRowsDoNotCount) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kCar, 0.0, 10.0, 2.0);
  scene.addRow(0, 7, ObjectClass::kCar, 0.0, 10.0).moving = false;
  scene.addRow(1, 7, ObjectClass::kCar, 0.2, 10.0).coasting = true;
  EXPECT_EQ(0u, scene.evaluate().all.found);
  EXPECT_EQ(0u, scene.evaluate().all.rows);
  MovingObjectParams params;
  params.with_coasting = true;
  EXPECT_EQ(1u, scene.evaluate(params).all.found);
}

TEST(MovingObjectErrorTest, WrongRowsAreIgnoredWhereNothingIsKnown) {
  Scene scene;
  scene.input.labels[0].dont_care.push_back({470.0, 170.0, 530.0, 230.0});
  scene.addRow(0, 7, ObjectClass::kCar, 0.0, 30.0);
  scene.addRow(1, 7, ObjectClass::kCar, 0.0, 30.0);                // no region in this frame
  scene.addRow(2, 8, ObjectClass::kCar, 0.0, 30.0).box2d.reset();  // behind the camera
  scene.addRow(3, 8, ObjectClass::kCar, 0.0, 30.0).box2d->left = -700.0;
  scene.addLabels(1, ObjectClass::kPedestrian, 10.0, 10.0, 2.0, 2);  // labelled for 0.1 s
  scene.addRow(0, 9, ObjectClass::kPedestrian, 10.0, 10.0);
  const auto error = scene.evaluate();
  EXPECT_THAT(error.ignored, ElementsAre(Pair("dont_care", 1u), Pair("outside_image", 2u),
                                         Pair("unknown_speed", 1u)));
  EXPECT_EQ(1u, error.all.rows);
  EXPECT_EQ(0u, error.all.labels);  // its speed is unknown
  EXPECT_EQ(1u, error.false_tracks);
  EXPECT_EQ(3u, error.tracks.size());
}

TEST(MovingObjectErrorTest, PiecesOfOneObjectAreDuplicates) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kTruck, 0.0, 15.0, 2.0);
  for (int k = 0; k < 5; ++k) {
    scene.addRow(k, 7, ObjectClass::kCar, 0.2 * k + 0.1, 15.0);
    scene.addRow(k, 8, ObjectClass::kCar, 0.2 * k + 1.0, 15.0);
  }
  const auto error = scene.evaluate();
  EXPECT_EQ(10u, error.all.right);
  EXPECT_EQ(5u, error.duplicate_rows);
  ASSERT_EQ(5u, error.matches.size());
  EXPECT_EQ(7, error.matches[0].track);  // the nearest one
}

TEST(MovingObjectErrorTest, SpeedIsInTheWorldNotInTheCamera) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kCar, 0.0, 15.0, -2.0);  // a still car passed at 2 m/s
  for (int k = 0; k < kFrames; ++k) {
    scene.input.T_world_cam[static_cast<std::size_t>(k)].value =
        robotFromOptical() * Eigen::Translation3d(0.2 * k, 0.0, 0.0);
  }
  EXPECT_EQ(0u, scene.evaluate().all.labels);
}

TEST(MovingObjectErrorTest, OnlyFramesOfTheReplayAreEvaluated) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kCar, 0.0, 15.0, 2.0);
  scene.input.first_frame = 5;
  scene.input.end_frame = 12;
  EXPECT_EQ(7u, scene.evaluate().all.labels);
  scene.input.T_world_cam.resize(8);
  EXPECT_THROW((void)scene.evaluate(), InputError);
}

/// Rows that are exact but for an offset of the track's frame and of its map.
Scene exactScene(const Pose& T_map_world) {
  Scene scene;
  scene.addLabels(1, ObjectClass::kCar, 0.0, 15.0, 2.0);
  for (int k = 0; k < kFrames; ++k) {
    auto& row = scene.addRow(k, 7, ObjectClass::kCar, 0.2 * k, 15.0);
    row.T_map_object = T_map_world * row.T_map_object;
    row.velocity = T_map_world.linear() * Eigen::Vector3d(0.0, -2.0, 0.0);
    scene.input.T_map_cam[row.frame] = T_map_world * robotFromOptical();
  }
  return scene;
}

TEST(ObjectMotionErrorTest, ExactMotionsHaveNoErrorInAnyMap) {
  Pose T_map_world = Pose::Identity();
  T_map_world.translate(Eigen::Vector3d(30.0, -4.0, 2.0));
  T_map_world.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.1, 0.2, 1.0).normalized()));
  const auto scene = exactScene(T_map_world);
  for (const auto motion : {ObjectMotion::kPoses, ObjectMotion::kVelocity}) {
    const auto errors = objectMotionErrors(scene.input, scene.evaluate().matches, motion);
    ASSERT_EQ(1u, errors.objects.size());
    EXPECT_EQ(19u, errors.frames);
    EXPECT_NEAR(0.0, *errors.translation_rmse_m, 1e-9);
    EXPECT_NEAR(0.0, *errors.rotation_rmse_deg, 1e-5);
  }
}

TEST(ObjectMotionErrorTest, ErrorsAreThoseOfTheMotionInTheObjectsFrame) {
  auto scene = exactScene(Pose::Identity());
  // Every second frame is 0.1 m too far: errors of +0.1 and -0.1 m.
  for (std::size_t k = 1; k < scene.input.rows.size(); k += 2) {
    scene.input.rows[k].T_map_object.translation().y() -= 0.1;
  }
  const auto matches = scene.evaluate().matches;
  const auto errors = objectMotionErrors(scene.input, matches, ObjectMotion::kPoses);
  EXPECT_NEAR(0.1, *errors.translation_rmse_m, 1e-9);
  EXPECT_NEAR(0.1, *errors.translation_mean_m, 1e-9);
  EXPECT_NEAR(0.0, *errors.rotation_rmse_deg, 1e-5);
  const auto by_velocity = objectMotionErrors(scene.input, matches, ObjectMotion::kVelocity);
  EXPECT_NEAR(0.0, *by_velocity.translation_rmse_m, 1e-9);
}

TEST(ObjectMotionErrorTest, RotationsAreInDegreesAndRmseWeighsLargeErrors) {
  auto scene = exactScene(Pose::Identity());
  // One step of 2 degrees at frame 10, on the spot.
  for (std::size_t k = 10; k < scene.input.rows.size(); ++k) {
    scene.input.rows[k].T_map_object.rotate(
        Eigen::AngleAxisd(2.0 * M_PI / 180.0, Eigen::Vector3d::UnitZ()));
  }
  const auto errors =
      objectMotionErrors(scene.input, scene.evaluate().matches, ObjectMotion::kPoses);
  EXPECT_NEAR(2.0 / 19.0, *errors.rotation_mean_deg, 1e-6);
  EXPECT_NEAR(2.0 / std::sqrt(19.0), *errors.rotation_rmse_deg, 1e-6);
  EXPECT_NEAR(0.0, *errors.translation_rmse_m, 1e-9);
}

TEST(ObjectMotionErrorTest, ObjectsAreWeightedEquallyAndGapsLeftOut) {
  auto scene = exactScene(Pose::Identity());
  scene.addLabels(2, ObjectClass::kCyclist, -6.0, 8.0, 3.0);
  for (const int k : {4, 5, 9}) {  // frames 5 and 9 are matched, but 8 has no row
    auto& row = scene.addRow(k, 9, ObjectClass::kCyclist, -6.0 + 0.3 * k, 8.0);
    if (k == 5) row.T_map_object.translation().y() -= 0.4;
  }
  const auto errors =
      objectMotionErrors(scene.input, scene.evaluate().matches, ObjectMotion::kPoses);
  ASSERT_EQ(2u, errors.objects.size());
  EXPECT_EQ(1u, errors.objects[1].frames);
  EXPECT_NEAR(0.4, errors.objects[1].translation_rmse_m, 1e-9);
  EXPECT_NEAR(0.2, *errors.translation_rmse_m, 1e-9);
  EXPECT_EQ(20u, errors.frames);
}

TEST(ObjectMotionErrorTest, WithoutMatchesThereIsNoFigure) {
  const Scene scene;
  const auto errors = objectMotionErrors(scene.input, {}, ObjectMotion::kPoses);
  EXPECT_TRUE(errors.objects.empty());
  EXPECT_FALSE(errors.translation_rmse_m);
}

}  // namespace
}  // namespace headway::eval
