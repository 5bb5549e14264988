#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/sim/sim_params.h>

#include "actor.h"

namespace headway::sim {
namespace {

using ::testing::HasSubstr;

template <typename Change>
std::string errorAfter(const Change& change) {
  SimParams params;
  change(params);
  try {
    params.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SimParamsTest, DefaultsAreValid) {
  EXPECT_EQ(errorAfter([](SimParams&) {}), "");
}

TEST(SimParamsTest, ValuesThatContradictEachOtherNameTheirKeys) {
  EXPECT_THAT(errorAfter([](SimParams& p) { p.world.house_height_max_m = 3.0; }),
              HasSubstr("house_height_max_m"));
  EXPECT_THAT(errorAfter([](SimParams& p) { p.traffic.van_ratio = p.traffic.truck_ratio = 0.6; }),
              HasSubstr("van_ratio"));
  EXPECT_THAT(errorAfter([](SimParams& p) { p.route.kind = RouteParams::Kind::kKittiPoses; }),
              HasSubstr("[route] file"));
  EXPECT_THAT(errorAfter([](SimParams& p) {
                p.route.kind = RouteParams::Kind::kLoop;
                p.route.corner_radius_m = 60.0;
              }),
              HasSubstr("corner_radius_m"));
  EXPECT_THAT(errorAfter([](SimParams& p) { p.traffic.vehicles = 40; }), HasSubstr("vehicles"));
  EXPECT_THAT(errorAfter([](SimParams& p) { p.traffic.cyclists = 40; }), HasSubstr("cyclists"));
  EXPECT_THAT(errorAfter([](SimParams& p) { p.camera.jitter_s = 0.05; }), HasSubstr("jitter_s"));
}

TEST(SimParamsTest, MoreVehiclesFitIntoALongerRange) {
  EXPECT_EQ(errorAfter([](SimParams& p) {
              p.traffic.vehicles = 40;
              p.traffic.range_ahead_m = 240.0;
            }),
            "");
}

TEST(ActorTest, SizesAreThoseOfItsKind) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const auto car = drawSize(ActorKind::kCar, random);
    const auto bus = drawSize(ActorKind::kBus, random);
    const auto person = drawSize(ActorKind::kPedestrian, random);
    EXPECT_GT(bus.x(), car.x());
    EXPECT_GT(car.x(), car.y());
    EXPECT_GT(person.z(), 1.5);
    EXPECT_LT(person.z(), 2.0);
  }
}

TEST(ActorTest, ClassesAreKittis) {
  EXPECT_EQ(classOf(ActorKind::kBus), ObjectClass::kTruck);
  EXPECT_EQ(classOf(ActorKind::kVan), ObjectClass::kVan);
  EXPECT_EQ(classOf(ActorKind::kCyclist), ObjectClass::kCyclist);
}

TEST(ActorTest, ItsCentreIsHalfItsHeightAboveTheGround) {
  Actor actor;
  actor.position << 1.0, 2.0, 3.0;
  actor.size << 4.0, 2.0, 1.6;
  EXPECT_EQ(actor.centre(), Eigen::Vector3d(1.0, 2.0, 3.8));
}

}  // namespace
}  // namespace headway::sim
