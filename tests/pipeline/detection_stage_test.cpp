// SPDX-License-Identifier: BSD-3-Clause
#include "detection_stage.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/pipeline/moving_regions.h>
#include <headway/pipeline/perception.h>
#include <headway_test/folders.h>
#include <headway_test/painted_street.h>

#include <set>

namespace headway::pipeline {
namespace {

using test::PaintedBox;
using test::PaintedStreet;
using ::testing::AllOf;
using ::testing::HasSubstr;

const PaintedBox kMoving{{-3.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11};
const PaintedBox kParked{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12};

DetectionParams paramsFor(const std::string& detector) {
  DetectionParams params;
  params.detector = detector;
  return params;
}

std::string errorOf(const std::string& detector, const PaintedStreet& street) {
  try {
    DetectionStage stage(street.camera(), paramsFor(detector));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

RecordedFrame frameOf(const PaintedStreet& street, int index) {
  RecordedFrame frame;
  frame.index = static_cast<std::size_t>(index);
  frame.time = street.timeOf(index);
  frame.stereo = street.frame(index);
  frame.T_map_robot = street.T_map_robot(index);
  return frame;
}

/// The front of a painted box as a perfect 2D detector sees it.
Detection seen(const PaintedBox& box, const PaintedStreet& street, int index) {
  const Eigen::Vector3d foot = street.placeInCamera(box, index);
  const auto corner = [&](double side, double height) {
    return *project(foot + Eigen::Vector3d(side * box.width, -height, 0.0), *street.camera());
  };
  Detection detection;
  detection.object_class = ObjectClass::kCar;
  detection.box2d = Box2d{corner(-0.5, 0.0).x(), corner(0.0, box.height).y(), corner(0.5, 0.0).x(),
                          corner(0.0, 0.0).y()};
  return detection;
}

Detections recorded(const PaintedStreet& street, int index, std::vector<Detection> items) {
  Detections detections = detect::emptyDetections(street.frame(index));
  detections.items = std::move(items);
  return detections;
}

std::optional<stereo::FrameContext> contextOf(const RecordedFrame& frame) {
  if (!frame.stereo) return std::nullopt;
  return stereo::FrameContext(*frame.stereo);
}

/// All that the stage detects in one frame.
FrameDetections detectAll(DetectionStage& stage, const RecordedFrame& frame) {
  return stage.detectMotion(frame, frame.T_map_robot, stage.detectObjects(frame, contextOf(frame)),
                            {}, {});
}

TEST(DetectionStageTest, NamesAreChecked) {
  for (const char* names :
       {"none", "auto", "recorded", "hog", "shape", "recorded+hog+stereo_motion+shape"}) {
    EXPECT_NO_THROW(checkDetectorNames(names)) << names;
  }
  for (const char* names : {"", "radar", "dnn+", "none+hog", "hog+hog"}) {
    EXPECT_THROW(checkDetectorNames(names), InputError) << names;
  }
  const PaintedStreet street({});
  EXPECT_THAT(errorOf("radar", street), AllOf(HasSubstr("radar"), HasSubstr("stereo_motion")));
  EXPECT_THAT(errorOf("dnn", street), HasSubstr("expected the path of"));
}

TEST(DetectionStageTest, WithoutImagesOnlyRecordedBoxesCanBeHad) {
  EXPECT_NO_THROW(DetectionStage(nullptr, paramsFor("recorded")));
  EXPECT_NO_THROW(DetectionStage(nullptr, paramsFor("auto")));
  EXPECT_THROW(DetectionStage(nullptr, paramsFor("hog")), InputError);
}

TEST(DetectionStageTest, NoDetectorMakesNoUseOfRecordedBoxes) {
  const PaintedStreet street({kParked});
  DetectionStage stage(street.camera(), paramsFor("none"));
  auto frame = frameOf(street, 0);
  frame.detections = recorded(street, 0, {seen(kParked, street, 0)});
  EXPECT_FALSE(detectAll(stage, frame).fused);
}

TEST(DetectionStageTest, EvaluatesAFrameInEachPeriodOnly) {
  const PaintedStreet street({});
  auto params = paramsFor("hog");
  params.detect.period_s = 0.3;
  DetectionStage stage(street.camera(), params);
  std::vector<bool> evaluated;
  for (int i = 0; i < 5; ++i) {
    const auto found = detectAll(stage, frameOf(street, i));
    evaluated.push_back(found.fused.has_value());
    EXPECT_EQ(evaluated.back(), found.images_used);
  }
  EXPECT_EQ(evaluated, (std::vector<bool>{true, false, false, true, false}));
}

TEST(DetectionStageTest, MotionIsDetectedInFramesInWhichSlowDetectorsRest) {
  const PaintedStreet street({kMoving});
  auto params = paramsFor("hog+stereo_motion");
  params.detect.period_s = 0.3;
  DetectionStage stage(street.camera(), params);
  for (int i = 0; i < 16; ++i) {
    const auto found = detectAll(stage, frameOf(street, i));
    ASSERT_TRUE(found.fused) << i;
    EXPECT_EQ(found.fused->all_detectors_ran, i % 3 == 0) << i;
    if (i < 9) continue;
    ASSERT_EQ(found.fused->items.size(), 1u) << i;
    EXPECT_TRUE(found.fused->items[0].evidence.motion) << i;
    EXPECT_FALSE(found.fused->items[0].evidence.periodic) << i;
  }
}

TEST(DetectionStageTest, APeriodIsTheSameTimeAtAHigherRate) {
  const PaintedStreet street({});
  auto params = paramsFor("hog");
  params.detect.period_s = 0.1;
  DetectionStage stage(street.camera(), params);
  std::vector<bool> evaluated;
  for (int i = 0; i < 7; ++i) {
    auto frame = frameOf(street, i);
    frame.time = i / 30.0;
    evaluated.push_back(detectAll(stage, frame).fused.has_value());
  }
  EXPECT_EQ(evaluated, (std::vector<bool>{true, false, false, true, false, false, true}));
}

TEST(DetectionStageTest, AutoPrefersRecordedBoxes) {
  const PaintedStreet street({kMoving, kParked});
  DetectionStage stage(street.camera(), paramsFor("auto"));
  EXPECT_TRUE(detectAll(stage, frameOf(street, 0)).images_used) << "nothing recorded so far";
  auto frame = frameOf(street, 1);
  frame.detections = recorded(street, 1, {});
  const auto found = detectAll(stage, frame);
  EXPECT_TRUE(found.fused);
  EXPECT_FALSE(found.images_used);
  EXPECT_FALSE(detectAll(stage, frameOf(street, 2)).fused) << "a frame without boxes coasts";
}

TEST(DetectionStageTest, RecordedBoxesWithoutDepthGetIt) {
  const PaintedStreet street({kParked});
  DetectionStage stage(street.camera(), paramsFor("recorded"));
  auto frame = frameOf(street, 0);
  frame.detections = recorded(street, 0, {seen(kParked, street, 0)});
  const auto found = detectAll(stage, frame);
  ASSERT_TRUE(found.fused && found.fused->items.size() == 1u && found.fused->items[0].box3d);
  const Box3d& box = *found.fused->items[0].box3d;
  EXPECT_NEAR(16.0, box.centre.z() - 0.5 * box.length, 0.8) << "its front is painted at 16 m";
  EXPECT_NEAR(3.5 / 16.0, box.centre.x() / box.centre.z(), 0.02);
  EXPECT_TRUE(found.images_used);
}

TEST(DetectionStageTest, BoxesOfAnotherSensorAreTurnedToTheCamera) {
  const PaintedStreet street({kParked});
  DetectionStage stage(street.camera(), paramsFor("recorded"));
  auto frame = frameOf(street, 0);
  Detection box;
  box.object_class = ObjectClass::kCar;
  box.box3d = Box3d{{0.0, 0.0, 10.0}, 4.0, 1.8, 1.5, 0.0};
  frame.detections = recorded(street, 0, {box});
  Pose T_cam_sensor = Pose::Identity();  // turned to the right by 90 degrees, a metre behind
  T_cam_sensor.linear() = expSo3({0.0, M_PI_2, 0.0});
  T_cam_sensor.translation().z() = -1.0;
  frame.detections->T_robot_sensor = street.camera()->T_robot_cam * T_cam_sensor;
  const auto found = detectAll(stage, frame).fused;
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->T_robot_sensor.isApprox(street.camera()->T_robot_cam));
  EXPECT_TRUE(found->items[0].box3d->centre.isApprox(Eigen::Vector3d(10.0, 0.0, -1.0), 1e-9));
  EXPECT_NEAR(M_PI_2, found->items[0].box3d->yaw, 1e-9) << "its front faced along the sensor's x";
}

TEST(DetectionStageTest, TwoSourcesOfOneObjectGiveOneDetection) {
  const PaintedStreet street({kMoving, kParked});
  DetectionStage alone(street.camera(), paramsFor("stereo_motion"));
  DetectionStage both(street.camera(), paramsFor("recorded+stereo_motion"));
  std::optional<Detections> one, fused;
  for (int i = 0; i < 10; ++i) {
    auto frame = frameOf(street, i);
    one = detectAll(alone, frame).fused;
    frame.detections = recorded(street, i, {seen(kMoving, street, i), seen(kParked, street, i)});
    fused = detectAll(both, frame).fused;
  }
  ASSERT_TRUE(one && fused);
  EXPECT_EQ(1u, one->items.size());
  EXPECT_EQ(2u, fused->items.size()) << "each car once";
}

TEST(DetectionStageTest, MovingRegionsAreExcludedFromTheNextFramesLandmarks) {
  const PaintedStreet street({kMoving, kParked});
  DetectionStage stage(street.camera(), paramsFor("stereo_motion"));
  MovingRegions regions;
  detect::MotionDetections motion;
  for (int i = 0; i < 10; ++i) {
    const auto frame = frameOf(street, i);
    const auto boxes = stage.detectObjects(frame, contextOf(frame));
    regions = movingRegions(boxes.sources, {}, motion, frame.time, *street.camera());
    motion = stage.detectMotion(frame, frame.T_map_robot, boxes, {}, motion).motion;
  }
  ASSERT_EQ(1u, regions.boxes.size());
  const Box2d truth = *seen(kMoving, street, 9).box2d;
  EXPECT_NEAR(truth.left, regions.boxes[0].left, 8.0);
  EXPECT_NEAR(truth.right, regions.boxes[0].right, 8.0);
  EXPECT_FALSE(regions.mask.empty());
}

TEST(DetectionStageTest, ImagesThatWereSeenBeforeAreNoNews) {
  const PaintedStreet street({kMoving});
  DetectionStage stage(street.camera(), paramsFor("stereo_motion"));
  const auto frame = frameOf(street, 0);
  EXPECT_FALSE(stage.detectObjects(frame, contextOf(frame), false).detectors_run);
  EXPECT_TRUE(stage.detectObjects(frame, contextOf(frame)).detectors_run);
}

TEST(DetectionStageTest, UnusableFramesAreCounted) {
  const PaintedStreet street({});
  DetectionStage stage(street.camera(), paramsFor("stereo_motion"));
  auto frame = frameOf(street, 0);
  frame.stereo->left.setTo(0);
  const auto found = detectAll(stage, frame);
  EXPECT_FALSE(found.fused);
  EXPECT_EQ((DropCounts{{"unusable_image", 1}}), found.dropped);
}

TEST(PerceptionTest, RangesBindWhicheverDetector) {
  const PaintedStreet street({kParked});
  auto depth_camera = std::make_shared<StereoCamera>(*street.camera());
  depth_camera->depth_reach_m = 14.0;
  for (const bool is_allowed : {true, false}) {
    PerceptionParams params;
    params.detection.detector = "recorded";
    if (is_allowed) params.detection.detect.stereo_motion.max_range_m = 14.0;
    Perception perception(is_allowed ? street.camera() : depth_camera, params);
    for (int i = 0; i < 3; ++i) {
      RecordedFrame frame;  // boxes and poses alone
      frame.index = static_cast<std::size_t>(i);
      frame.time = street.timeOf(i);
      frame.T_map_robot = street.T_map_robot(i);
      Detection far;
      far.object_class = ObjectClass::kCar;
      far.box3d = Box3d{{0.0, 1.0, 15.0}, 4.0, 1.8, 1.5, 0.0};
      frame.detections = recorded(street, i, {far});
      Detection near = far;
      near.box3d->centre.z() = 13.0;
      frame.detections->items.push_back(near);
      const auto update = perception.process(frame);
      ASSERT_TRUE(update.detections);
      ASSERT_EQ(1u, update.detections->items.size());
      EXPECT_EQ(13.0, update.detections->items[0].box3d->centre.z());
      ASSERT_EQ(1u, update.objects.tracks.size());
      EXPECT_LT(update.objects.tracks[0].position.head<2>().norm(), 14.0 + 3.0 * i);
      EXPECT_EQ((DropCounts{{"too_far", 1}}), update.objects.detections_dropped) << i;
    }
  }
}

TEST(PerceptionTest, ImagesAloneGiveTracksOfMovingObjects) {
  const PaintedStreet street({kMoving, kParked});
  PerceptionParams params;
  params.detection.detector = "stereo_motion";
  Perception perception(street.camera(), params);
  std::set<TrackId> moving;
  PerceptionUpdate update;
  for (int i = 0; i < 14; ++i) {
    update = perception.process(frameOf(street, i));
    for (const auto& track : update.objects.tracks) {
      if (track.status == TrackStatus::kConfirmed && isMoving(track)) moving.insert(track.id);
    }
  }
  ASSERT_EQ(1u, moving.size());
  ASSERT_EQ(1u, update.objects.tracks.size());
  const Track& track = update.objects.tracks.front();
  const Eigen::Vector3d place = street.placeInCamera(kMoving, 13);
  const Eigen::Vector3d found = street.T_map_robot(13).inverse() * track.position;
  EXPECT_NEAR(place.z(), found.x(), 3.0) << "its front; the box reaches behind it";
  EXPECT_NEAR(-place.x(), found.y(), 1.0);
  EXPECT_NEAR(4.0, track.velocity.x(), 0.8) << "map x is the camera's z";
  EXPECT_EQ(14u, perception.times().summary().at("detect").count);
}

TEST(DetectionStageTest, ImagesReplaceRecordedBoxesThatStopUntilTheyReturn) {
  const PaintedStreet street({kMoving, kParked});
  DetectionParams params = paramsFor("auto");
  params.recorded_timeout_s = 0.35;
  DetectionStage stage(street.camera(), params);
  const auto step = [&](int index, bool has_boxes) {
    RecordedFrame frame = frameOf(street, index);
    if (has_boxes) frame.detections = recorded(street, index, {});
    const auto boxes = stage.detectObjects(frame, contextOf(frame));
    (void)stage.detectMotion(frame, frame.T_map_robot, boxes, {}, {});
    return boxes;
  };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(step(i, true).detectors_run, false);
  for (int i = 3; i < 6; ++i) EXPECT_FALSE(step(i, false).recorded_missing) << i;
  for (int i = 6; i < 9; ++i) {
    const auto boxes = step(i, false);
    EXPECT_TRUE(boxes.recorded_missing && boxes.detectors_run) << i;
  }
  const auto returned = step(9, true);
  EXPECT_FALSE(returned.recorded_missing || returned.detectors_run);
  EXPECT_FALSE(step(10, false).detectors_run);
}

TEST(DetectionStageTest, ShapesAreLookedForOnRobotsAlsoWhenTheFloorShowsLaterThatItIsOne) {
  const PaintedStreet street({});
  DetectionStage stage(street.camera(), paramsFor("auto"));
  EXPECT_FALSE(stage.looksForShapes()) << "1.65 m high, as of a car";
  auto low = std::make_shared<StereoCamera>(*street.camera());
  low->T_robot_cam.translation().z() = 0.6;
  stage.remount(low);
  EXPECT_TRUE(stage.looksForShapes());
  stage.remount(street.camera());
  EXPECT_FALSE(stage.looksForShapes());
  EXPECT_TRUE(DetectionStage(street.camera(), paramsFor("shape")).looksForShapes()) << "asked for";
  EXPECT_FALSE(DetectionStage(low, paramsFor("stereo_motion")).looksForShapes());
}

TEST(DetectionStageTest, FramesWithoutImagesTakeNoTurnOfTheDetectors) {
  const PaintedStreet street({kMoving});
  DetectionParams params = paramsFor("hog");
  params.detect.period_s = 0.2;
  DetectionStage stage(street.camera(), params);
  int runs = 0;
  for (int i = 0; i < 9; ++i) {
    RecordedFrame poses;
    poses.time = 0.1 * i - 0.02;  // just before the images
    runs += stage.detectObjects(poses, std::nullopt).detectors_run ? 1 : 0;
    RecordedFrame frame = frameOf(street, i);
    runs += stage.detectObjects(frame, contextOf(frame)).detectors_run ? 1 : 0;
  }
  EXPECT_EQ(5, runs) << "frames 0, 2, 4, 6 and 8";
}

TEST(DetectionStageTest, AutoUsesANetworkIfThereIsAModel) {
  const PaintedStreet street({kMoving});
  DetectionParams params = paramsFor("auto");
  EXPECT_TRUE(wouldUseModel(params));
  EXPECT_EQ("", modelInUse(params)) << "HEADWAY_MODELS is not set for tests";
  params.detect.network.model = "/nowhere/yolox_nano.onnx";
  EXPECT_EQ("/nowhere/yolox_nano.onnx", modelInUse(params));
  EXPECT_THROW(DetectionStage(street.camera(), params), InputError);
  PerceptionParams all;
  all.detection = params;
  EXPECT_EQ(0.2, PerceptionParams::live(all).detection.detect.period_s);
  EXPECT_FALSE(PerceptionParams::live(all).detection.detect.network.tiles);
  EXPECT_EQ(0.0, PerceptionParams::live().detection.detect.period_s) << "without a model";
  params.detector = "stereo_motion";
  EXPECT_EQ("", modelInUse(params));
  EXPECT_NO_THROW(DetectionStage(street.camera(), params));
}

TEST(DetectionStageTest, ARecordingsBoxesReplaceTheNetworkToo) {
  HEADWAY_REQUIRE_DATA(data);
  const PaintedStreet street({kMoving, kParked});
  DetectionParams params = paramsFor("auto");
  params.detect.network.model = data / "models" / "yolox_nano.onnx";
  DetectionStage stage(street.camera(), params);
  auto frame = frameOf(street, 0);
  const auto alone = stage.detectObjects(frame, contextOf(frame));
  EXPECT_TRUE(alone.detectors_run && alone.classified);
  frame = frameOf(street, 1);
  frame.detections = recorded(street, 1, {seen(kParked, street, 1)});
  const auto with_boxes = stage.detectObjects(frame, contextOf(frame));
  EXPECT_FALSE(with_boxes.detectors_run || with_boxes.classified);
  EXPECT_EQ(1u, with_boxes.sources.size());
}

TEST(DetectionStageTest, OnlyAutoReplacesRecordedBoxes) {
  const PaintedStreet street({kMoving});
  DetectionParams params = paramsFor("recorded");
  params.recorded_timeout_s = 0.1;
  DetectionStage stage(street.camera(), params);
  RecordedFrame frame = frameOf(street, 0);
  frame.detections = recorded(street, 0, {});
  (void)stage.detectObjects(frame, contextOf(frame));
  frame = frameOf(street, 5);
  const auto boxes = stage.detectObjects(frame, contextOf(frame));
  EXPECT_TRUE(boxes.recorded_missing);
  EXPECT_FALSE(boxes.detectors_run);
}

}  // namespace
}  // namespace headway::pipeline
