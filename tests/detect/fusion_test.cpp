// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/appearance.h>
#include <headway/core/error.h>
#include <headway/detect/detector_factory.h>
#include <headway/detect/fusion.h>

namespace headway::detect {
namespace {

Detection seenAt(double left, std::optional<double> depth, ObjectClass object_class) {
  Detection detection;
  detection.object_class = object_class;
  detection.box2d = Box2d{left, 100, left + 60, 160};
  if (depth) {
    detection.box3d = Box3d{{0, 0, *depth}, 4, 1.7, 1.5, 0};
    detection.centre_covariance = Eigen::Matrix3d::Identity();
  }
  return detection;
}

Detections listOf(std::vector<Detection> items) {
  Detections detections;
  detections.time = 7.0;
  detections.items = std::move(items);
  return detections;
}

TEST(FuseTest, OneSourceComesOutAsItWentIn) {
  const auto only =
      listOf({seenAt(10, 5.0, ObjectClass::kCar), seenAt(12, 5.1, ObjectClass::kCar)});
  const auto fused = fuse({only}).detections;
  EXPECT_EQ(fused.items.size(), 2u);
  EXPECT_EQ(fused.time, 7.0);
  EXPECT_TRUE(fuse({}).detections.items.empty());
}

TEST(FuseTest, AnObjectSeenTwiceIsReportedOnceWithAllThatIsKnown) {
  auto moving = seenAt(14, 20.0, ObjectClass::kUnknown);
  moving.detector_id = 3;
  moving.velocity = MeasuredVelocity{{0, 0, 9}, Eigen::Matrix3d::Identity()};
  const auto fused =
      fuse({listOf({seenAt(10, std::nullopt, ObjectClass::kCar)}), listOf({moving})}).detections;
  ASSERT_EQ(fused.items.size(), 1u);
  EXPECT_EQ(fused.items[0].object_class, ObjectClass::kCar);
  EXPECT_EQ(fused.items[0].box2d->left, 10);
  ASSERT_TRUE(fused.items[0].box3d);
  EXPECT_EQ(fused.items[0].box3d->centre.z(), 20.0);
  EXPECT_TRUE(fused.items[0].centre_covariance);
  EXPECT_EQ(fused.items[0].detector_id, 3);
  ASSERT_TRUE(fused.items[0].velocity);
  EXPECT_EQ(fused.items[0].velocity->value.z(), 9.0);
}

TEST(FuseTest, APersonWhoMovesLikeACyclistIsOneIfAskedFor) {
  auto person = seenAt(10, 20.0, ObjectClass::kPedestrian);
  person.evidence.classifier = true;
  auto moving = seenAt(14, 20.0, ObjectClass::kCyclist);
  moving.evidence.motion = true;
  EXPECT_EQ(fuse({listOf({person}), listOf({moving})}).detections.items.at(0).object_class,
            ObjectClass::kPedestrian);
  FusionParams params;
  params.rider_by_motion = true;
  EXPECT_EQ(fuse({listOf({person}), listOf({moving})}, params).detections.items.at(0).object_class,
            ObjectClass::kCyclist);
}

TEST(FuseTest, EvidenceOfAllSourcesIsKept) {
  auto classified = seenAt(10, std::nullopt, ObjectClass::kCar);
  classified.evidence.classifier = classified.evidence.periodic = true;
  auto moving = seenAt(14, 20.0, ObjectClass::kPedestrian);
  moving.evidence.motion = true;
  moving.searched_track = TrackId{4};
  moving.mask = std::make_shared<const ObjectMask>();
  moving.appearance = std::make_shared<const AppearanceTemplate>();
  const auto fused = fuse({listOf({classified}), listOf({moving})}).detections;
  ASSERT_EQ(fused.items.size(), 1u);
  const Detection& item = fused.items[0];
  EXPECT_TRUE(item.evidence.classifier && item.evidence.motion);
  EXPECT_FALSE(item.evidence.periodic) << "motion is looked for in each frame";
  EXPECT_FALSE(item.evidence.appearance);
  EXPECT_EQ(item.object_class, ObjectClass::kCar);
  EXPECT_EQ(item.searched_track, TrackId{4});
  EXPECT_EQ(item.mask, moving.mask);
  EXPECT_EQ(item.appearance, moving.appearance);
}

TEST(FuseTest, OverlappingBoxesFarApartInSpaceAreTwoObjects) {
  const auto fused = fuse({listOf({seenAt(10, 10.0, ObjectClass::kCar)}),
                           listOf({seenAt(12, 30.0, ObjectClass::kCar)})})
                         .detections;
  EXPECT_EQ(fused.items.size(), 2u);
}

TEST(FuseTest, PlacesDecideWhereThereAreNoImageBoxes) {
  auto a = seenAt(10, 10.0, ObjectClass::kCar);
  auto b = seenAt(300, 10.5, ObjectClass::kUnknown);
  a.box2d.reset();
  EXPECT_EQ(fuse({listOf({a}), listOf({b})}).detections.items.size(), 1u);
  b.box3d->centre.x() += 6.0;
  EXPECT_EQ(fuse({listOf({a}), listOf({b})}).detections.items.size(), 2u);
}

TEST(FuseTest, TwoHalvesOfOneObjectDoNotBecomeASecondOne) {
  auto whole = seenAt(10, 10.0, ObjectClass::kTruck);
  auto half = whole, other_half = whole;
  half.box2d->right = 40;
  other_half.box2d->left = 40;
  const auto fused = fuse({listOf({whole}), listOf({half, other_half})});
  EXPECT_EQ(fused.detections.items.size(), 1u);
  EXPECT_EQ(fused.dropped, (DropCounts{{"part_of_other", 1}}));
  EXPECT_TRUE(fuse({listOf({whole}), listOf({half})}).dropped.empty()) << "joined";
}

TEST(FuseTest, AClassifierThatMotionContradictsLeavesTheClassOpen) {
  auto shape = seenAt(10, 5.0, ObjectClass::kPedestrian);
  shape.evidence.classifier = true;
  for (const auto by_motion :
       {ObjectClass::kCyclist, ObjectClass::kPedestrian, ObjectClass::kUnknown}) {
    auto moving = seenAt(14, 5.0, by_motion);
    moving.evidence.motion = true;
    const auto fused = fuse({listOf({moving}), listOf({shape})}).detections;
    ASSERT_EQ(fused.items.size(), 1u);
    const bool is_cyclist = by_motion == ObjectClass::kCyclist;
    EXPECT_EQ(fused.items[0].object_class, is_cyclist ? by_motion : ObjectClass::kPedestrian);
    EXPECT_EQ(fused.items[0].evidence.classifier, !is_cyclist);
    EXPECT_TRUE(fused.items[0].evidence.motion);
  }
}

TEST(MakeDetectorTest, NamesWhatThereIs) {
  try {
    (void)makeDetector("radar", DetectParams{});
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("stereo_motion, dnn, hog"), std::string::npos);
  }
  EXPECT_NE(makeDetector("hog", DetectParams{}), nullptr);
}

}  // namespace
}  // namespace headway::detect
