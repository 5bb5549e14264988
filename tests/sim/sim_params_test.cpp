// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/sim/rigs.h>
#include <headway/sim/sim_params.h>
#include <headway_test/input_error.h>
#include <headway_test/paths.h>

#include <algorithm>

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

/// A key, a value that is out of its range, and what the error says of the range.
struct OutOfRange {
  std::string assignment;
  std::string range;
};

class KeyRangeTest : public ::testing::TestWithParam<OutOfRange> {};

TEST_P(KeyRangeTest, AValueBeyondItIsRefusedWithSectionKeyValueAndRange) {
  SimParams settings;
  Params params;
  settings.describe(params);
  const auto& [assignment, range] = GetParam();
  const std::string section = assignment.substr(0, assignment.find('.'));
  const std::string key =
      assignment.substr(section.size() + 1, assignment.find('=') - section.size() - 1);
  const std::string value = assignment.substr(assignment.find('=') + 1);
  const std::string error = test::inputErrorOf([&, &set = assignment] { params.set(set); });
  EXPECT_THAT(error, HasSubstr("[" + section + "]"));
  EXPECT_THAT(error, HasSubstr(key));
  EXPECT_THAT(error, HasSubstr("'" + value + "'"));
  EXPECT_THAT(error, HasSubstr(range));
}

INSTANTIATE_TEST_SUITE_P(All, KeyRangeTest,
                         ::testing::Values(OutOfRange{"route.speed_mps=0.1", "0.2 .. 40"},
                                           OutOfRange{"route.laps=0", "1 .. 100"},
                                           OutOfRange{"route.corner_radius_m=5", "8 .. 500"},
                                           OutOfRange{"world.view_distance_m=500", "30 .. 280"},
                                           OutOfRange{"world.house_ratio=1.1", "0 .. 1"},
                                           OutOfRange{"world.hill_height_m=-1", "0 .. 20"},
                                           OutOfRange{"traffic.pedestrians=-1", "0 .. 400"},
                                           OutOfRange{"traffic.image_share=0.7", "0 .. 0.6"},
                                           OutOfRange{"traffic.encounter_ratio=2", "0 .. 1"},
                                           OutOfRange{"robot.turn_rate_dps=200", "10 .. 180"},
                                           OutOfRange{"robot.brake_mps2=0.1", "0.3 .. 8"},
                                           OutOfRange{"camera.width=32", "64 .. 4096"},
                                           OutOfRange{"camera.focal_px=10", "50 .. 10000"},
                                           OutOfRange{"camera.pitch_down_deg=70", "-45 .. 60"},
                                           OutOfRange{"camera.drop_ratio=0.95", "0 .. 0.9"},
                                           OutOfRange{"camera.k1=0.6", "-0.5 .. 0.5"},
                                           OutOfRange{"laser.rays=5", "10 .. 5000"},
                                           OutOfRange{"laser.aperture_deg=400", "10 .. 360"},
                                           OutOfRange{"laser.height_m=0", "0.03 .. 3"},
                                           OutOfRange{"calibration_error.focal_ratio=0.1",
                                                      "-0.05 .. 0.05"},
                                           OutOfRange{"calibration_error.flex_deg=1", "0 .. 0.5"},
                                           OutOfRange{"detector.miss_far=1.5", "0 .. 1"},
                                           OutOfRange{"detector.max_range_m=0", "1 .. 300"},
                                           OutOfRange{"recording.frames=0", "1 .. 1000000"},
                                           OutOfRange{"recording.jpeg_quality=5", "10 .. 100"}),
                         [](const auto& param) {
                           std::string name =
                               param.param.assignment.substr(0, param.param.assignment.find('='));
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST(SimParamsTest, NamedValuesAreThoseOfTheEnumerations) {
  SimParams settings;
  Params params;
  settings.describe(params);
  params.set("world.kind=warehouse");
  params.set("route.kind=loop");
  params.set("recording.storage=external_jpeg");
  EXPECT_EQ(settings.world.kind, WorldParams::Kind::kWarehouse);
  EXPECT_EQ(settings.route.kind, RouteParams::Kind::kLoop);
  EXPECT_EQ(settings.recording.storage, RecordingParams::Storage::kExternalJpeg);
  EXPECT_EQ(params.get("world", "kind"), "warehouse");
  EXPECT_THAT(test::inputErrorOf([&] { params.set("world.kind=attic"); }),
              ::testing::AllOf(HasSubstr("kind"), HasSubstr("attic"), HasSubstr("campus")));
}

TEST(SimParamsTest, WorldsForRobotsHaveThreeHundredFramesAndTheRobotsRig) {
  for (const char* name : {"hall", "campus", "warehouse"}) {
    SimParams settings;
    Params params;
    settings.describe(params);
    params.loadFile(std::string(HEADWAY_SOURCE_DIR) + "/config/worlds/" + name + ".ini");
    EXPECT_EQ(settings.recording.frames, 300) << "rows of the suite";
    CameraParams robot = settings.camera;
    applyRig("robot", robot);
    EXPECT_EQ(robot.baseline_m, settings.camera.baseline_m);
    EXPECT_EQ(robot.focal_px, settings.camera.focal_px);
    EXPECT_EQ(robot.width, settings.camera.width);
    EXPECT_EQ(robot.mount_height_m, settings.camera.mount_height_m);
    EXPECT_EQ(robot.pitch_down_deg, settings.camera.pitch_down_deg);
    EXPECT_NE(settings.world.kind, WorldParams::Kind::kStreet);
  }
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
