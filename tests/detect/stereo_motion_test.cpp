#include <gtest/gtest.h>
#include <headway/detect/detector_factory.h>
#include <headway/detect/stereo_motion.h>
#include <headway_test/folders.h>
#include <headway_test/input_error.h>
#include <headway_test/limits.h>
#include <headway_test/painted_street.h>
#include <headway_test/spoilt_images.h>
#include <headway_test/stereo_sequence.h>
#include <headway_test/textured_world.h>

#include <fstream>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <set>

namespace headway::detect {
namespace {

using test::PaintedBox;
using test::PaintedStreet;

constexpr int kFrames = 12;

const PaintedBox kMover{{-3.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11};
const PaintedBox kParked{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12};
const PaintedBox kPost{{-4.5, 1.6, 22.0}, 0.5, 1.7, {0.0, 0.0, 0.0}, 13};

struct Outcome {
  int frames_with_mover = 0;
  int elsewhere = 0;  ///< objects that are not the mover
  int refused = 0;    ///< frames of which nothing was said
};

StereoMotion detectorFor(std::shared_ptr<const StereoCamera> camera) {
  return {
      std::move(camera), {}, std::make_shared<stereo::DisparityMatcher>(stereo::DisparityParams())};
}

/// What is done to a frame before the detector sees it.
using Spoil = std::function<void(int, StereoFrame&)>;

Outcome run(const PaintedStreet& street, const PaintedBox* mover, const Spoil& spoil,
            double right_late_s = 0.0) {
  StereoMotion detector = detectorFor(street.camera());
  Outcome outcome;
  for (int i = 0; i < kFrames; ++i) {
    StereoFrame frame = street.frame(i, right_late_s);
    if (spoil) spoil(i, frame);
    const auto found = detector.detect(frame, street.T_map_robot(i));
    if (!found) {
      ++outcome.refused;
      continue;
    }
    bool seen = false;
    for (const auto& item : found->items) {
      const Eigen::Vector3d place =
          mover != nullptr ? street.placeInCamera(*mover, i) : Eigen::Vector3d(1e6, 0, 0);
      const bool is_mover = std::abs(item.box3d->centre.x() - place.x()) < 1.5 &&
                            std::abs(item.box3d->centre.z() - place.z()) < 3.5;
      seen = seen || is_mover;
      if (!is_mover) ++outcome.elsewhere;
    }
    if (seen) ++outcome.frames_with_mover;
  }
  return outcome;
}

TEST(StereoMotionTest, FindsTheMoverAndNothingElse) {
  const PaintedStreet street({kMover, kParked, kPost});
  const auto outcome = run(street, &kMover, {});
  EXPECT_GE(outcome.frames_with_mover, 6);
  EXPECT_EQ(outcome.elsewhere, 0);
  EXPECT_EQ(outcome.refused, 0);
}

TEST(StereoMotionTest, MeasuresVelocityAndPlaceOfTheMover) {
  const PaintedStreet street({kMover, kParked});
  StereoMotion detector = detectorFor(street.camera());
  for (int i = 0; i < kFrames; ++i) (void)detector.detect(street.frame(i), street.T_map_robot(i));
  ASSERT_EQ(detector.objects().size(), 1u);
  const MovingObject& object = detector.objects()[0];
  EXPECT_NEAR(object.velocity.x(), 4.0, 0.6) << "map x is the camera's z";
  EXPECT_NEAR(object.velocity.y(), -2.5, 0.4) << "map y is the camera's -x";
  ASSERT_TRUE(object.detection.velocity);
  const Eigen::Vector3d turned = street.T_map_robot(kFrames - 1).linear() *
                                 robotFromOptical().linear() * object.detection.velocity->value;
  EXPECT_LT((turned - object.velocity).norm(), 1e-6) << "the same, along the camera's axes";
  const Eigen::Vector3d front = street.placeInCamera(kMover, kFrames - 1);
  const Box2d& box = *object.detection.box2d;
  EXPECT_NEAR(0.5 * (box.left + box.right), (*project(front, *street.camera())).x(), 12.0);
  EXPECT_TRUE(detector.ground());
  EXPECT_NEAR(detector.ground()->camera_height, 1.6, 0.1);
  const auto regions = detector.movingRegions(street.timeOf(kFrames - 1));
  ASSERT_EQ(regions.boxes.size(), 1u);
  EXPECT_EQ(regions.boxes[0].left, box.left);
  EXPECT_GT(cv::countNonZero(regions.mask), 200);
}

TEST(StereoMotionTest, ForeseesWhereItsRegionsWillBe) {
  const PaintedStreet street({kMover, kParked});
  StereoMotion detector = detectorFor(street.camera());
  for (int i = 0; i < kFrames; ++i) (void)detector.detect(street.frame(i), street.T_map_robot(i));
  const auto here = detector.movingRegions(street.timeOf(kFrames - 1));
  const auto there = detector.movingRegions(street.timeOf(kFrames));
  ASSERT_EQ(there.boxes.size(), 1u);
  const auto columnAt = [&](int frame) {
    return (*project(street.placeInCamera(kMover, frame), *street.camera())).x();
  };
  const double way = columnAt(kFrames) - columnAt(kFrames - 1);
  ASSERT_GT(std::abs(way), 3.0);
  EXPECT_NEAR(there.boxes[0].left - here.boxes[0].left, way, 1.5);
  EXPECT_GT(cv::countNonZero(there.mask), 200);
  EXPECT_TRUE(detector.movingRegions(street.timeOf(kFrames) + 2.0).boxes.empty());
}

TEST(StereoMotionTest, KeepsTheIdOfAnObject) {
  const PaintedStreet street({kMover, kParked});
  StereoMotion detector = detectorFor(street.camera());
  std::set<std::int64_t> ids;
  for (int i = 0; i < kFrames; ++i) {
    (void)detector.detect(street.frame(i), street.T_map_robot(i));
    for (const auto& object : detector.objects()) ids.insert(object.id);
  }
  EXPECT_EQ(ids.size(), 1u);
}

TEST(StereoMotionTest, AStillSceneHasNoMovers) {
  const PaintedStreet street({kParked, kPost});
  const auto outcome = run(street, nullptr, {});
  EXPECT_EQ(outcome.elsewhere, 0);
  EXPECT_EQ(outcome.refused, 0);
}

TEST(StereoMotionTest, WithoutAPoseItSaysNothingAndCountsThat) {
  const PaintedStreet street({kMover});
  StereoMotion detector = detectorFor(street.camera());
  EXPECT_TRUE(detector.needsPose());
  EXPECT_FALSE(detector.detect(street.frame(0), std::nullopt));
  EXPECT_EQ(detector.dropped().at("no_pose"), 1u);
  EXPECT_TRUE(detector.movingRegions(street.timeOf(0)).boxes.empty());
}

TEST(StereoMotionTest, AWrongPoseIsNotAFloodOfMovers) {
  std::vector<PaintedBox> parked;
  for (int i = 0; i < 7; ++i) {
    parked.push_back({{-9.0 + 3.0 * i, 1.6, 13.0 + i}, 2.2, 1.8, {0, 0, 0}, 20u + i});
  }
  const PaintedStreet street(parked);
  StereoMotion detector = detectorFor(street.camera());
  std::size_t found = 0;
  for (int i = 0; i < kFrames; ++i) {
    Pose pose = street.T_map_robot(i);
    pose.translation().y() += 0.4 * i;  // the robot is said to slide sideways at 4 m/s
    const auto detections = detector.detect(street.frame(i), pose);
    if (detections) found += detections->items.size();
  }
  EXPECT_LE(found, parked.size());
  EXPECT_GE(detector.dropped().count("camera_motion_unsure"), 1u);
}

TEST(StereoMotionTest, AJumpOfTheMapMovesNothing) {
  const PaintedStreet street({kMover, kParked, kPost});
  Pose jump = Pose::Identity();
  jump.linear() = expSo3({0.0, 0.0, 0.03});
  jump.translation() = Eigen::Vector3d(1.2, 0.6, 0.0);
  StereoMotion detector = detectorFor(street.camera());
  bool seen_after = false;
  for (int i = 0; i < kFrames; ++i) {
    const Pose pose = street.T_map_robot(i);
    const auto found = detector.detect(street.frame(i), i < 6 ? pose : Pose(jump * pose));
    if (!found) continue;
    for (const auto& item : found->items) {
      const Eigen::Vector3d off = item.box3d->centre - street.placeInCamera(kMover, i);
      EXPECT_TRUE(std::abs(off.x()) < 1.5 && std::abs(off.z()) < 3.5) << "frame " << i;
      seen_after = seen_after || i > 6;
    }
  }
  EXPECT_TRUE(seen_after);
}

TEST(StereoMotionTest, TheNumberOfThreadsDoesNotMatter) {
  const PaintedStreet street({kMover, kParked, kPost});
  const int threads = cv::getNumThreads();
  std::vector<std::vector<Eigen::Vector3d>> places(2);
  for (int pass = 0; pass < 2; ++pass) {
    cv::setNumThreads(pass == 0 ? 1 : 4);
    StereoMotion detector = detectorFor(street.camera());
    for (int i = 0; i < 8; ++i) {
      const auto found = detector.detect(street.frame(i), street.T_map_robot(i));
      for (const auto& item : found->items) places[pass].push_back(item.box3d->centre);
    }
  }
  cv::setNumThreads(threads);
  ASSERT_FALSE(places[0].empty());
  EXPECT_EQ(places[0], places[1]);
}

// --- Trouble: found less, perhaps; never a flood of what is not there. ---

constexpr int kBlackFrame = 6;
constexpr int kLeastWithMover[] = {0, 3, 3, 4, 4};  // frames in which it is found, by trouble

class InTroubleTest : public testing::TestWithParam<int> {};

TEST_P(InTroubleTest, AStillSceneStaysStill) {
  const auto trouble = test::troubles(kBlackFrame)[GetParam()];
  const PaintedStreet street({kParked, kPost});
  EXPECT_LE(run(street, nullptr, trouble.spoil, trouble.right_late_s).elsewhere, 1);
}

TEST_P(InTroubleTest, TheMoverIsTheOnlyThingFound) {
  const auto trouble = test::troubles(kBlackFrame)[GetParam()];
  const PaintedStreet street({kMover, kParked, kPost});
  const auto outcome = run(street, &kMover, trouble.spoil, trouble.right_late_s);
  EXPECT_LE(outcome.elsewhere, 1);
  EXPECT_GE(outcome.frames_with_mover, kLeastWithMover[GetParam()]);
}

INSTANTIATE_TEST_SUITE_P(Troubles, InTroubleTest, testing::Range(0, 5), [](const auto& index) {
  return std::string(test::troubles(kBlackFrame)[index.param].name);
});

TEST(StereoMotionTest, ABlackImageIsReportedAndPassedOver) {
  const PaintedStreet street({kMover});
  StereoMotion detector = detectorFor(street.camera());
  StereoFrame frame = street.frame(0);
  frame.left.setTo(0);
  EXPECT_FALSE(detector.detect(frame, street.T_map_robot(0)));
  EXPECT_EQ(detector.dropped().at("unusable_image"), 1u);
}

// --- Real streets, the camera's motion from the recording's own truth. ---

std::vector<MovingObject> objectsOf(const std::filesystem::path& data, const std::string& name) {
  const auto sequence = test::kittiSequence(data / "kitti_odometry", name);
  std::ifstream poses(data / "kitti_odometry" / "poses" / (name + ".txt"));
  StereoMotion detector = detectorFor(sequence.camera);
  std::vector<MovingObject> all;
  for (std::size_t i = 0; i < sequence.times.size(); ++i) {
    Pose T_map_cam = Pose::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) poses >> T_map_cam(row, column);
    }
    const Pose T_robot_cam = robotFromOptical();
    (void)detector.detect(sequence.frame(i), T_robot_cam * T_map_cam * T_robot_cam.inverse());
    all.insert(all.end(), detector.objects().begin(), detector.objects().end());
  }
  return all;
}

TEST(StereoMotionTest, OnAStreetOfParkedCarsOnlyTheOncomingOnesMove) {
  HEADWAY_REQUIRE_DATA(data);
  // Beyond the green in the street's middle, cars come towards the camera near the clip's end. All
  // else stands: it may be mistaken in a frame, but not in so many as confirm a track.
  std::map<std::int64_t, int> frames;
  int mistaken = 0;
  for (const auto& object : objectsOf(data, "06")) {
    const bool comes = object.detection.box3d->centre.x() < -10.0 && object.velocity.x() < -5.0;
    if (comes) continue;
    ++mistaken;
    EXPECT_LE(++frames[object.id], 2);
  }
  test::expectWithin("false_objects", mistaken, test::kKitti06FalseObjects);
}

TEST(StereoMotionTest, FindsTheCarsOnAMotorway) {
  HEADWAY_REQUIRE_DATA(data);
  const auto objects = objectsOf(data, "01");
  int fast = 0;
  for (const auto& object : objects) fast += object.velocity.norm() > 10.0 ? 1 : 0;
  EXPECT_GE(fast, test::kKitti01Cars);
  RecordProperty("cars", fast);
  // Nothing but cars moves there.
  test::expectWithin("false_objects", static_cast<int>(objects.size()) - fast,
                     test::kKitti01FalseObjects);
}

TEST(StereoMotionTest, RefusesParametersOutOfRange) {
  const auto camera = std::make_shared<StereoCamera>(test::smallCamera());
  DetectParams params;
  params.stereo_motion.min_speed_mps = -0.5;
  EXPECT_EQ("[stereo_motion] min_speed_mps: '-0.5' is out of range [m/s, 0.05 .. 20]",
            test::inputErrorOf([&] { (void)makeDetector("stereo_motion", camera, params); }));
  params = {};
  params.disparity.reduce = 5;
  EXPECT_EQ("[disparity] reduce: '5' is out of range [1 .. 4]",
            test::inputErrorOf([&] { (void)makeDetector("stereo_motion", camera, params); }));
  params = {};
  params.person.scale_step = 1.0;
  EXPECT_EQ("[hog] scale_step: '1' is out of range [1.02 .. 2]",
            test::inputErrorOf([&] { (void)makeDetector("hog", camera, params); }));
  params = {};
  params.network.min_score = 2.0;
  EXPECT_EQ("[dnn] min_score: '2' is out of range [0 .. 1]",
            test::inputErrorOf([&] { (void)makeDetector("dnn", camera, params); }));
}

}  // namespace
}  // namespace headway::detect
