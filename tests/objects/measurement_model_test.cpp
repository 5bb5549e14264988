// SPDX-License-Identifier: BSD-3-Clause
#include "measurement_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "scene.h"

namespace headway::objects {
namespace {

using test::seenCar;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Outcome {
  std::vector<MeasuredBox> boxes;
  DropCounts dropped;
};

Outcome measure(const std::vector<Detection>& items, const ConsistencyParams& selection = {},
                const Pose& T_map_robot = Pose::Identity()) {
  Detections detections;
  detections.items = items;
  Outcome outcome;
  outcome.boxes =
      MeasurementModel(selection, FilterParams()).toMap(T_map_robot, detections, outcome.dropped);
  return outcome;
}

TEST(MeasurementModelTest, BringsABoxToTheMap) {
  Pose T_map_robot = Pose::Identity();
  T_map_robot.translation() << 5.0, -2.0, 1.0;
  T_map_robot.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto outcome = measure({seenCar(10.0, 3.0, 0.4)}, {}, T_map_robot);
  ASSERT_EQ(outcome.boxes.size(), 1u);
  EXPECT_LT((outcome.boxes[0].position - Eigen::Vector3d(2.0, 8.0, 1.0)).norm(), 1e-9);
  EXPECT_NEAR(outcome.boxes[0].yaw, 0.4 + M_PI / 2, 1e-9);
  EXPECT_THAT(outcome.dropped, IsEmpty());
}

TEST(MeasurementModelTest, NoiseGrowsWithDepthAndMostAlongTheRay) {
  const auto near = measure({seenCar(5.0, 0.0)}).boxes.at(0);
  const auto far = measure({seenCar(60.0, 0.0)}).boxes.at(0);
  EXPECT_GT(far.covariance(0, 0), 4.0 * near.covariance(0, 0)) << "x runs along the ray";
  EXPECT_GT(far.covariance(0, 0), 2.0 * far.covariance(1, 1));
  EXPECT_NEAR(far.covariance(0, 1), 0.0, 1e-12);
  const auto lateral = measure({seenCar(20.0, 20.0)}).boxes.at(0);
  EXPECT_GT(lateral.covariance(0, 1), 0.0) << "the ellipse points along the ray";
}

TEST(MeasurementModelTest, UsesTheCovarianceOfTheDetector) {
  Detection car = seenCar(10.0, 0.0);
  car.centre_covariance = Eigen::Vector3d(0.01, 0.02, 4.0).asDiagonal();  // optical axes
  const auto box = measure({car}).boxes.at(0);
  EXPECT_NEAR(box.covariance(0, 0), 4.0, 0.01);
  EXPECT_NEAR(box.covariance(1, 1), 0.01, 0.01);
  EXPECT_NEAR(box.vertical_variance, 0.02, 0.01);
  EXPECT_EQ(box.shared_covariance, box.covariance);
  EXPECT_TRUE(measure({seenCar(10.0, 0.0)}).boxes.at(0).shared_covariance.isZero())
      << "a configured noise states nothing";
}

TEST(MeasurementModelTest, TurnsAVelocityIntoTheMap) {
  Pose T_map_robot = Pose::Identity();
  T_map_robot.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Detection car = seenCar(10.0, 0.0);
  car.velocity = MeasuredVelocity{{0.0, 0.0, 8.0}, Eigen::Vector3d(0.1, 0.2, 0.9).asDiagonal()};
  const auto velocity = measure({car}, {}, T_map_robot).boxes.at(0).velocity;
  ASSERT_TRUE(velocity) << "away from the camera, which faces along the map's y";
  EXPECT_LT((velocity->value - Eigen::Vector2d(0.0, 8.0)).norm(), 1e-9);
  EXPECT_NEAR(velocity->covariance(1, 1), 0.9, 1e-9);
  EXPECT_NEAR(velocity->covariance(0, 0), 0.1, 1e-9);
}

TEST(MeasurementModelTest, DoesNotDependOnTheOrderOfDetections) {
  std::vector<Detection> items;
  for (int i = 0; i < 20; ++i) items.push_back(seenCar(5.0 + (i * 7) % 20, (i * 3) % 11));
  const auto one = measure(items);
  std::reverse(items.begin(), items.end());
  const auto other = measure(items);
  ASSERT_EQ(one.boxes.size(), other.boxes.size());
  for (std::size_t i = 0; i < one.boxes.size(); ++i) {
    EXPECT_EQ(one.boxes[i].position, other.boxes[i].position);
  }
}

TEST(MeasurementModelTest, CountsNotANumberAndInfinity) {
  const auto with = [](auto change) {
    Detection car = seenCar(10.0, 0.0);
    change(car);
    return car;
  };
  const std::vector<Detection> items = {
      with([](Detection& d) { d.box3d->centre.x() = kNan; }),
      with([](Detection& d) { d.box3d->centre.z() = kInfinity; }),
      with([](Detection& d) { d.box3d->length = kNan; }),
      with([](Detection& d) { d.box3d->yaw = kInfinity; }),
      with([](Detection& d) { d.score = kNan; }),
      with([](Detection& d) {
        d.box2d = Box2d{kNan, 0, 10, 10};
      }),
      with([](Detection& d) {
        d.velocity = MeasuredVelocity{{kNan, 0.0, 0.0}, Eigen::Matrix3d::Identity()};
      }),
  };
  const auto outcome = measure(items);
  EXPECT_THAT(outcome.boxes, IsEmpty());
  EXPECT_THAT(outcome.dropped, ElementsAre(Pair("nan_box", items.size())));
}

TEST(MeasurementModelTest, ABoxIsUsedWithoutACovarianceThatIsNone) {
  Eigen::Matrix3d indefinite = Eigen::Matrix3d::Identity();
  indefinite(0, 2) = indefinite(2, 0) = 9.0;
  std::vector<Detection> items;
  for (const Eigen::Matrix3d& covariance :
       {Eigen::Matrix3d(-Eigen::Matrix3d::Identity()), indefinite,
        Eigen::Matrix3d(1e154 * Eigen::Matrix3d::Identity()),
        Eigen::Matrix3d(1e300 * Eigen::Matrix3d::Identity()),
        Eigen::Matrix3d(Eigen::Matrix3d::Constant(kNan))}) {
    items.push_back(seenCar(10.0, 0.0));
    items.back().centre_covariance = covariance;
  }
  const auto outcome = measure(items);
  const auto without = measure({seenCar(10.0, 0.0)}).boxes.at(0);
  ASSERT_EQ(items.size(), outcome.boxes.size());
  for (const auto& box : outcome.boxes) EXPECT_EQ(without.covariance, box.covariance);
  EXPECT_THAT(outcome.dropped, ElementsAre(Pair("bad_covariance", items.size())));
}

TEST(MeasurementModelTest, AcceptsTheCovarianceOfAnExactPlace) {
  Detection car = seenCar(10.0, 0.0);
  car.centre_covariance = Eigen::Matrix3d::Zero();
  EXPECT_EQ(1u, measure({car}).boxes.size());
  const Eigen::Vector3d ray(1.0, 0.2, 3.0);  // singular, as rounded
  car.centre_covariance = 0.01 * ray * ray.transpose();
  EXPECT_EQ(1u, measure({car}).boxes.size());
}

TEST(MeasurementModelTest, CountsBoxesFromABrokenPose) {
  Pose broken = Pose::Identity();
  broken.translation().x() = kNan;
  EXPECT_THAT(measure({seenCar(10.0, 0.0)}, {}, broken).dropped, ElementsAre(Pair("nan_box", 1u)));
}

TEST(MeasurementModelTest, CountsBoxesWithoutSize) {
  Detection flat = seenCar(10.0, 0.0);
  flat.box3d->height = 0.0;
  Detection inside_out = seenCar(10.0, 0.0);
  inside_out.box3d->width = -1.0;
  EXPECT_THAT(measure({flat, inside_out}).dropped, ElementsAre(Pair("zero_size", 2u)));
}

TEST(MeasurementModelTest, CountsBoxesLargerThanAnythingOfTheirClass) {
  Detection lorry = seenCar(40.0, 0.0);
  lorry.box3d->length = 16.0;
  Detection tower = seenCar(40.0, 0.0);
  tower.box3d->height = 1e6;
  EXPECT_THAT(measure({lorry, tower}).dropped, ElementsAre(Pair("too_large", 2u)));
  lorry.mask = std::make_shared<const ObjectMask>();
  EXPECT_TRUE(measure({lorry}).dropped.empty()) << "a group that was segmented in images";
  lorry.box3d->length = 60.1;
  EXPECT_THAT(measure({lorry}).dropped, ElementsAre(Pair("too_large", 1u))) << "no group";
}

TEST(MeasurementModelTest, AnObjectIsAsLongAsTheLongestOfItsClass) {
  for (const auto& [object_class, longest_m] :
       {std::pair(ObjectClass::kPedestrian, 3.0), std::pair(ObjectClass::kPersonSitting, 3.0),
        std::pair(ObjectClass::kCyclist, 3.0), std::pair(ObjectClass::kCar, 8.0),
        std::pair(ObjectClass::kVan, 10.0), std::pair(ObjectClass::kTruck, 30.0),
        std::pair(ObjectClass::kTram, 60.0)}) {
    Detection object = seenCar(40.0, 0.0);
    object.object_class = object_class;
    object.box3d->length = longest_m;
    EXPECT_TRUE(measure({object}).dropped.empty()) << longest_m;
    object.box3d->length += 0.1;
    EXPECT_THAT(measure({object}).dropped, ElementsAre(Pair("too_large", 1u))) << longest_m;
  }
}

TEST(MeasurementModelTest, CountsBoxesBehindTheCamera) {
  EXPECT_THAT(measure({seenCar(-3.0, 1.0), seenCar(0.0, 1.0)}).dropped,
              ElementsAre(Pair("behind_camera", 2u)));
}

TEST(MeasurementModelTest, CountsBoxesTooFarAway) {
  ConsistencyParams selection;
  selection.max_range_m = 50.0;
  EXPECT_THAT(measure({seenCar(51.0, 0.0)}, selection).dropped, ElementsAre(Pair("too_far", 1u)));
}

TEST(MeasurementModelTest, CountsBoxesBeyondWhatIsMeasured) {
  ConsistencyParams selection;
  selection.max_depth_m = 8.0;
  const auto measured = measure({seenCar(7.9, 5.0), seenCar(8.1, 0.0)}, selection);
  EXPECT_EQ(measured.boxes.size(), 1u) << "a depth is along the optical axis";
  EXPECT_THAT(measured.dropped, ElementsAre(Pair("too_far", 1u)));
}

TEST(MeasurementModelTest, CountsLowScores) {
  ConsistencyParams selection;
  selection.min_score = 0.5;
  Detection unsure = seenCar(10.0, 0.0);
  unsure.score = 0.4;
  EXPECT_THAT(measure({unsure}, selection).dropped, ElementsAre(Pair("low_score", 1u)));
}

TEST(MeasurementModelTest, CountsUnknownClassesIfDisabled) {
  Detection thing = seenCar(10.0, 0.0);
  thing.object_class = ObjectClass::kUnknown;
  EXPECT_EQ(measure({thing}).boxes.size(), 1u);
  ConsistencyParams selection;
  selection.track_unknown = false;
  EXPECT_THAT(measure({thing}, selection).dropped, ElementsAre(Pair("unknown_class", 1u)));
}

TEST(MeasurementModelTest, CountsImageBoxesThatWereNotLifted) {
  Detection flat;
  flat.object_class = ObjectClass::kCar;
  flat.box2d = Box2d{600, 100, 700, 200};
  EXPECT_THAT(measure({flat}).dropped, ElementsAre(Pair("no_3d_box", 1u)));
}

}  // namespace
}  // namespace headway::objects
