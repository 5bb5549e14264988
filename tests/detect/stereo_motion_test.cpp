// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/appearance.h>
#include <headway/detect/detector_factory.h>
#include <headway/detect/stereo_motion.h>
#include <headway/stereo/rectification.h>
#include <headway_test/degraded_images.h>
#include <headway_test/input_error.h>
#include <headway_test/painted_street.h>
#include <headway_test/textured_world.h>

#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

using test::PaintedBox;
using test::PaintedStreet;
using test::Surface;

constexpr int kFrames = 12;

const PaintedBox kMoving{{-3.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11};
const PaintedBox kParked{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12};
const PaintedBox kPost{{-4.5, 1.6, 22.0}, 0.5, 1.7, {0.0, 0.0, 0.0}, 13};

struct Outcome {
  int frames_with_mover = 0;
  int elsewhere = 0;  ///< objects that are not the object
  int refused = 0;    ///< frames of which nothing was said
};

StereoMotion detectorFor(std::shared_ptr<const StereoCamera> camera) {
  return {std::move(camera), {}};
}

/// What is done to a frame before the detector sees it.
using Spoil = std::function<void(int, StereoFrame&)>;

Outcome run(const PaintedStreet& street, const PaintedBox* object, const Spoil& spoil,
            double right_late_s = 0.0) {
  StereoMotion detector = detectorFor(street.camera());
  stereo::DisparityOffset offset;
  Outcome outcome;
  for (int i = 0; i < kFrames; ++i) {
    StereoFrame frame = street.frame(i, right_late_s);
    if (spoil) spoil(i, frame);
    const auto detected = detector.detect({frame, {}, offset.value(), {}}, street.T_map_robot(i));
    offset.update(detected.static_points);
    const auto& found = detected.detections;
    if (!found) {
      ++outcome.refused;
      continue;
    }
    bool seen = false;
    for (const auto& item : found->items) {
      const Eigen::Vector3d place =
          object != nullptr ? street.placeInCamera(*object, i) : Eigen::Vector3d(1e6, 0, 0);
      const bool is_mover = std::abs(item.box3d->centre.x() - place.x()) < 1.5 &&
                            std::abs(item.box3d->centre.z() - place.z()) < 3.5;
      seen = seen || is_mover;
      if (!is_mover) ++outcome.elsewhere;
    }
    if (seen) ++outcome.frames_with_mover;
  }
  return outcome;
}

TEST(StereoMotionTest, FindsTheMovingObjectAndNothingElse) {
  const PaintedStreet street({kMoving, kParked, kPost});
  const auto outcome = run(street, &kMoving, {});
  EXPECT_GE(outcome.frames_with_mover, 6);
  EXPECT_EQ(outcome.elsewhere, 0);
  EXPECT_EQ(outcome.refused, 0);
}

TEST(StereoMotionTest, NothingBeyondTheRangeThatIsAllowedIsFound) {
  const PaintedStreet street({kMoving, kParked, kPost});
  for (const double range : {0.0, 14.0, 60.0}) {
    StereoMotionParams params;
    params.max_range_m = range;
    StereoMotion detector(street.camera(), params);
    std::size_t found = 0, too_far = 0;
    for (int i = 0; i < kFrames; ++i) {
      const StereoFrame frame = street.frame(i);
      auto detected = detector.detect({frame, {}, 0.0, {}}, street.T_map_robot(i));
      too_far += detected.dropped["too_far"];
      if (!detected.detections) continue;
      for (const auto& item : detected.detections->items) {
        ++found;
        EXPECT_TRUE(range == 0.0 || item.box3d->centre.z() <= range) << item.box3d->centre.z();
      }
    }
    EXPECT_EQ(found == 0, range == 14.0) << range << ": it is 15 to 17 m away";
    EXPECT_EQ(too_far > 0, range == 14.0) << range;
  }
}

TEST(StereoMotionTest, NothingMovesWhenTheRightCamerasTurnIsFirstUndone) {
  const PaintedStreet street({kParked, kPost});
  const Eigen::Vector3d turn = Eigen::Vector3d(0.0, 0.2, 0.4) * M_PI / 180.0;
  const stereo::RightTurn known(turn, *street.camera()), opposite(-turn, *street.camera());
  StereoMotion detector = detectorFor(street.camera());
  stereo::FrontEnd front_end((stereo::DisparityParams()));
  std::size_t found = 0;
  for (int i = 0; i < kFrames; ++i) {
    StereoFrame frame = street.frame(i);
    frame.right = opposite.undone(frame.right);  // as the turned camera sees it
    if (i == kFrames / 2) front_end.setRightTurn(known);
    const auto detected = detector.detect(front_end.next(frame, 0.0), street.T_map_robot(i));
    ASSERT_TRUE(detected.detections) << i;
    if (i >= kFrames / 2) found += detected.detections->items.size();
  }
  EXPECT_EQ(found, 0u);
}

/// What the detector says of the last of the frames.
MotionDetections lastOf(const PaintedStreet& street) {
  StereoMotion detector = detectorFor(street.camera());
  MotionDetections last;
  for (int i = 0; i < kFrames; ++i) last = detector.detect(street.frame(i), street.T_map_robot(i));
  return last;
}

TEST(StereoMotionTest, MeasuresVelocityAndPlaceOfTheMovingObject) {
  const PaintedStreet street({kMoving, kParked});
  const auto found = lastOf(street).detections;
  ASSERT_TRUE(found && found->items.size() == 1u);
  const Detection& object = found->items[0];
  EXPECT_TRUE(object.evidence.motion);
  ASSERT_TRUE(object.velocity);
  const Eigen::Vector3d velocity = street.T_map_robot(kFrames - 1).linear() *
                                   robotFromOptical().linear() * object.velocity->value;
  EXPECT_NEAR(velocity.x(), 4.0, 0.6) << "map x is the camera's z";
  EXPECT_NEAR(velocity.y(), -2.5, 0.4) << "map y is the camera's -x";
  const Eigen::Vector3d front = street.placeInCamera(kMoving, kFrames - 1);
  const Box2d& box = *object.box2d;
  EXPECT_NEAR(0.5 * (box.left + box.right), (*project(front, *street.camera())).x(), 12.0);
  ASSERT_NE(object.mask, nullptr);
  EXPECT_GT(cv::countNonZero(object.mask->cells), 50);
}

TEST(StereoMotionTest, PredictsItsRegions) {
  const PaintedStreet street({kMoving, kParked});
  const auto motion = lastOf(street);
  const auto here = motion.regionsAt(street.timeOf(kFrames - 1), *street.camera());
  ASSERT_EQ(here.boxes.size(), 1u);
  EXPECT_EQ(here.boxes[0].left, motion.detections->items[0].box2d->left);
  EXPECT_GT(cv::countNonZero(here.mask), 200);
  const auto there = motion.regionsAt(street.timeOf(kFrames), *street.camera());
  ASSERT_EQ(there.boxes.size(), 1u);
  const auto columnAt = [&](int frame) {
    return (*project(street.placeInCamera(kMoving, frame), *street.camera())).x();
  };
  const double way = columnAt(kFrames) - columnAt(kFrames - 1);
  ASSERT_GT(std::abs(way), 3.0);
  EXPECT_NEAR(there.boxes[0].left - here.boxes[0].left, way, 1.5);
  EXPECT_GT(cv::countNonZero(there.mask), 200);
  const auto late = motion.regionsAt(street.timeOf(kFrames) + 2.0, *street.camera());
  EXPECT_TRUE(late.boxes.empty());
}

TEST(StereoMotionTest, AStaticSceneHasNoMovingObjects) {
  const PaintedStreet street({kParked, kPost});
  const auto outcome = run(street, nullptr, {});
  EXPECT_EQ(outcome.elsewhere, 0);
  EXPECT_EQ(outcome.refused, 0);
}

/// As of a slow computer or a camera that stops: points of before the pause have no pose any more.
TEST(StereoMotionTest, NothingMovesAfterAPause) {
  const PaintedStreet street({kParked, kPost});
  for (const double pause_s : {0.5, 0.9, 1.1, 1.5, 3.0}) {
    const auto outcome = run(street, nullptr, [&](int index, StereoFrame& frame) {
      if (index >= kFrames / 2) frame.time += pause_s;
    });
    EXPECT_EQ(outcome.elsewhere, 0) << pause_s;
    EXPECT_EQ(outcome.refused, 0) << pause_s;
  }
}

TEST(StereoMotionTest, WithoutAPoseTheFrameIsDropped) {
  const PaintedStreet street({kMoving});
  const auto found = detectorFor(street.camera()).detect(street.frame(0), std::nullopt);
  EXPECT_FALSE(found.detections);
  EXPECT_EQ(found.dropped, (DropCounts{{"no_pose", 1}}));
  EXPECT_TRUE(found.regionsAt(street.timeOf(0), *street.camera()).boxes.empty());
}

TEST(StereoMotionTest, AWrongPoseGivesFewDetections) {
  std::vector<PaintedBox> parked;
  for (int i = 0; i < 7; ++i) {
    parked.push_back({{-9.0 + 3.0 * i, 1.6, 13.0 + i}, 2.2, 1.8, {0, 0, 0}, 20u + i});
  }
  const PaintedStreet street(parked);
  StereoMotion detector = detectorFor(street.camera());
  stereo::FrontEnd front_end{stereo::DisparityParams()};
  stereo::DisparityOffset offset;
  std::size_t found = 0;
  std::size_t unsure = 0;
  for (int i = 0; i < kFrames; ++i) {
    Pose pose = street.T_map_robot(i);
    pose.translation().y() += 0.4 * i;  // the robot is said to slide sideways at 4 m/s
    const auto detected = detector.detect(front_end.next(street.frame(i), offset.value()), pose);
    offset.update(detected.static_points);
    if (detected.detections) found += detected.detections->items.size();
    unsure += detected.dropped.count("camera_motion_unsure");
  }
  EXPECT_LE(found, parked.size());
  EXPECT_GE(unsure, 1u);
}

TEST(StereoMotionTest, TheNumberOfThreadsDoesNotMatter) {
  const PaintedStreet street({kMoving, kParked, kPost});
  const int threads = cv::getNumThreads();
  std::vector<std::vector<Eigen::Vector3d>> places(2);
  for (int pass = 0; pass < 2; ++pass) {
    cv::setNumThreads(pass == 0 ? 1 : 4);
    StereoMotion detector = detectorFor(street.camera());
    for (int i = 0; i < 8; ++i) {
      const auto found = detector.detect(street.frame(i), street.T_map_robot(i)).detections;
      for (const auto& item : found->items) places[pass].push_back(item.box3d->centre);
    }
  }
  cv::setNumThreads(threads);
  ASSERT_FALSE(places[0].empty());
  EXPECT_EQ(places[0], places[1]);
}

// --- Degraded input: fewer detections, few false ones. ---

constexpr int kBlackFrame = 6;
constexpr int kMinWithMover[] = {0, 3, 3, 4, 4};  // frames in which it is found, by trouble

class InTroubleTest : public testing::TestWithParam<int> {};

TEST_P(InTroubleTest, AStillSceneStaysStill) {
  const auto trouble = test::troubles(kBlackFrame)[GetParam()];
  const PaintedStreet street({kParked, kPost});
  EXPECT_LE(run(street, nullptr, trouble.spoil, trouble.right_late_s).elsewhere, 1);
}

TEST_P(InTroubleTest, OnlyTheMovingObjectIsFound) {
  const auto trouble = test::troubles(kBlackFrame)[GetParam()];
  const PaintedStreet street({kMoving, kParked, kPost});
  const auto outcome = run(street, &kMoving, trouble.spoil, trouble.right_late_s);
  EXPECT_LE(outcome.elsewhere, 1);
  EXPECT_GE(outcome.frames_with_mover, kMinWithMover[GetParam()]);
}

INSTANTIATE_TEST_SUITE_P(Troubles, InTroubleTest, testing::Range(0, 5), [](const auto& index) {
  return std::string(test::troubles(kBlackFrame)[index.param].name);
});

// --- Things that stand, seen by a camera that turns. ---

constexpr double kTurnRate = 0.35;  // of the camera, to the left [rad/s]

struct StandingScene {
  const char* name;
  std::vector<PaintedBox> boxes;
  std::vector<test::PaintedShadow> shadows;
};

std::vector<StandingScene> standingScenes() {
  const auto front = [](double x, double z, double width, double height, Surface surface) {
    return PaintedBox{{x, 1.6, z}, width, height, {0.0, 0.0, 0.0}, 41, surface};
  };
  return {
      {"fence", {front(-3.0, 12.0, 7.0, 1.2, Surface::kPickets), kParked}, {}},
      {"railing", {front(-3.0, 11.0, 7.0, 1.0, Surface::kRails), kParked}, {}},
      {"hedge",
       {front(-3.0, 12.0, 7.0, 1.5, Surface::kLeaves),
        front(-3.0, 12.5, 7.0, 1.5, Surface::kLeaves)},
       {}},
      {"shadow", {kParked, kPost}, {{{-2.5, 11.0}, 0.8, {1.2, 0.0}}}},
      {"reflection", {front(-3.0, 13.0, 3.0, 2.2, Surface::kGlass), kParked}, {}},
      {"windows", {front(-4.0, 18.0, 14.0, 7.0, Surface::kWindows)}, {}},
  };
}

/// Images that were rectified: turned and turned back, so that they are resampled twice, and
/// blurred.
void resample(int, StereoFrame& frame) {
  for (cv::Mat* image : {&frame.left, &frame.right}) {
    const cv::Point2f centre(0.5F * static_cast<float>(image->cols),
                             0.5F * static_cast<float>(image->rows));
    for (const double degrees : {1.3, -1.3}) {
      cv::warpAffine(*image, *image, cv::getRotationMatrix2D(centre, degrees, 1.0), image->size(),
                     cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    }
    cv::GaussianBlur(*image, *image, {5, 5}, 0.8);
  }
}

class StandingSceneTest : public testing::TestWithParam<int> {
 protected:
  StandingScene scene_ = standingScenes()[GetParam()];
};

TEST_P(StandingSceneTest, NothingMoves) {
  const PaintedStreet street(scene_.boxes, kTurnRate, scene_.shadows);
  EXPECT_EQ(run(street, nullptr, {}).elsewhere, 0);
}

TEST_P(StandingSceneTest, OfResampledImagesAtMostOneFindIsFalse) {
  const PaintedStreet street(scene_.boxes, kTurnRate, scene_.shadows);
  EXPECT_LE(run(street, nullptr, resample).elsewhere, 1);
}

TEST_P(StandingSceneTest, WhatMovesThereIsFound) {
  scene_.boxes.push_back({{1.0, 1.6, 9.0}, 0.7, 1.7, {-1.5, 0.0, 4.0}, 14});
  const PaintedStreet street(scene_.boxes, kTurnRate, scene_.shadows);
  EXPECT_GE(run(street, &scene_.boxes.back(), resample).frames_with_mover, 4);
}

INSTANTIATE_TEST_SUITE_P(Scenes, StandingSceneTest, testing::Range(0, 6), [](const auto& scene) {
  return std::string(standingScenes()[scene.param].name);
});

TEST(StereoMotionTest, ABlackImageIsReportedAndPassedOver) {
  const PaintedStreet street({kMoving});
  StereoFrame frame = street.frame(0);
  frame.left.setTo(0);
  const auto found = detectorFor(street.camera()).detect(frame, street.T_map_robot(0));
  EXPECT_FALSE(found.detections);
  EXPECT_EQ(found.dropped, (DropCounts{{"unusable_image", 1}}));
}

TEST(StereoMotionTest, RefusesParametersOutOfRange) {
  const auto camera = std::make_shared<StereoCamera>(test::smallCamera());
  DetectParams params;
  const auto makeStereoMotion = [&] { StereoMotion(camera, params.stereo_motion); };
  params.stereo_motion.min_speed_mps = -0.5;
  EXPECT_EQ("[stereo_motion] min_speed_mps: '-0.5' is out of range [m/s, 0.05 .. 20]",
            test::inputErrorOf([&] { makeStereoMotion(); }));
  params = {};
  params.disparity.reduce = 5;
  EXPECT_EQ("[disparity] reduce: '5' is out of range [1 .. 4]",
            test::inputErrorOf([&] { stereo::FrontEnd{params.disparity}; }));
  params = {};
  params.person.scale_step = 1.0;
  EXPECT_EQ("[hog] scale_step: '1' is out of range [1.02 .. 2]",
            test::inputErrorOf([&] { (void)makeDetector("hog", params); }));
  params = {};
  params.network.min_score = 2.0;
  EXPECT_EQ("[dnn] min_score: '2' is out of range [0 .. 1]",
            test::inputErrorOf([&] { (void)makeDetector("dnn", params); }));
}

}  // namespace
}  // namespace headway::detect
