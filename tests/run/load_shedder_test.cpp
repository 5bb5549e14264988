// SPDX-License-Identifier: BSD-3-Clause
#include "load_shedder.h"

#include <gmock/gmock.h>
#include <headway/pipeline/perception.h>

namespace headway::run {
namespace {

using pipeline::Perception;
using pipeline::RuntimeParams;
using testing::HasSubstr;
using Level = LoadShedder::Level;

/// A robot at 10 Hz whose frames take a time that depends on what is left out, by a clock of its
/// own.
class LoadedRobot {
 public:
  /// Runs for some time while all work but that which can be left out takes `base_s` a frame.
  void run(double seconds, double base_s) {
    const int frames = static_cast<int>(seconds / kInterval);
    for (int i = 0; i < frames; ++i) {
      now_s_ += kInterval;
      if (const auto line = shedder_.add(now_s_, base_s + extra(), kInterval)) {
        lines.push_back(*line);
        levels.push_back(shedder_.level());
      }
    }
  }

  [[nodiscard]] const LoadShedder& shedder() const { return shedder_; }

  std::vector<std::string> lines;
  std::vector<Level> levels;

 private:
  static constexpr double kInterval = 0.1;

  /// Page, scans and far boxes take 10 ms each, most of the scans 8.
  [[nodiscard]] double extra() const {
    constexpr std::array<double, 5> kExtra = {0.030, 0.020, 0.012, 0.010, 0.0};
    return kExtra.at(static_cast<std::size_t>(shedder_.level()));
  }

  LoadShedder shedder_{RuntimeParams()};
  double now_s_ = 1000.0;
};

TEST(LoadShedderTest, NothingIsLeftOutWhileThereIsTime) {
  LoadedRobot robot;
  robot.run(60.0, 0.069);
  EXPECT_TRUE(robot.lines.empty());
  EXPECT_EQ("", robot.shedder().description());
}

TEST(LoadShedderTest, OneSlowFrameLeavesNothingOut) {
  LoadShedder shedder{RuntimeParams()};
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(shedder.add(0.1 * i, i == 50 ? 0.25 : 0.06, 0.1)) << i;
  }
}

TEST(LoadShedderTest, TheLeastUsefulWorkIsLeftOutFirstAndNoMoreThanNeeded) {
  LoadedRobot robot;
  robot.run(10.0, 0.085);  // 115 ms: without page 105, without most scans 97
  EXPECT_EQ((std::vector<Level>{Level::kPictures, Level::kMostScans}), robot.levels);
  EXPECT_THAT(robot.lines.front(), HasSubstr("without pictures"));
  EXPECT_EQ(1.2, robot.shedder().params().grid_period_s);
  robot.run(10.0, 0.200);
  EXPECT_EQ(Level::kFarBoxes, robot.shedder().level());
  EXPECT_EQ(0.0, robot.shedder().params().grid_period_s);
  EXPECT_EQ(30.0, robot.shedder().params().max_box_range_m);
  EXPECT_THAT(robot.shedder().description(), HasSubstr("boxes beyond 30 m"));
}

TEST(LoadShedderTest, EverythingIsDoneAgainAfterTheLoad) {
  LoadedRobot robot;
  robot.run(10.0, 0.200);
  robot.run(30.0, 0.040);
  EXPECT_EQ(Level::kNothing, robot.shedder().level());
  EXPECT_EQ(8u, robot.levels.size()) << "four steps, one after the other, each way";
  EXPECT_THAT(robot.lines.back(), HasSubstr("all work is done again"));
  EXPECT_EQ(RuntimeParams().grid_period_s, robot.shedder().params().grid_period_s);
}

/// What is left out is what makes the difference: without it there is room, with it overload.
TEST(LoadShedderTest, StepsThatDoNotLastAreTriedMoreAndMoreRarely) {
  LoadShedder shedder{RuntimeParams()};
  std::vector<double> times;
  for (int i = 0; i < 3000; ++i) {
    const double now = 0.1 * i;
    const double process = shedder.level() == Level::kNothing ? 0.12 : 0.05;
    if (shedder.add(now, process, 0.1)) times.push_back(now);
  }
  EXPECT_LT(times.size(), 24u) << "in 300 s";
  EXPECT_GT(times.back() - times[times.size() - 3], 20.0);
}

TEST(LoadShedderTest, MostScansAreLeftOutWhateverTheirPeriod) {
  RuntimeParams full;
  full.grid_period_s = 0.02;  // every frame
  LoadShedder shedder(full);
  for (int i = 0; i < 600 && shedder.level() != Level::kMostScans; ++i) {
    (void)shedder.add(0.1 * i, 0.15, 0.1);
  }
  ASSERT_EQ(Level::kMostScans, shedder.level());
  EXPECT_DOUBLE_EQ(0.4, shedder.params().grid_period_s) << "every fourth frame";
}

TEST(LoadShedderTest, FarBoxesAreCountedAsShed) {
  Perception perception(nullptr, {});
  RuntimeParams params;
  params.max_box_range_m = 30.0;
  perception.change(params);
  RecordedFrame frame;
  frame.T_map_robot = Pose::Identity();
  frame.detections.emplace();
  for (const double depth : {10.0, 50.0}) {
    Detection detection;
    detection.object_class = ObjectClass::kCar;
    detection.box3d.emplace();
    detection.box3d->centre = {0.0, 0.8, depth};
    detection.box3d->length = 4.0;
    detection.box3d->width = detection.box3d->height = 1.6;
    frame.detections->items.push_back(detection);
  }
  const auto update = perception.process(frame);
  EXPECT_EQ(1u, update.objects.detections_used);
  EXPECT_EQ(1u, update.objects.detections_dropped.at("load_shed"));
  EXPECT_EQ(2u, update.detections->items.size()) << "detections.csv has them";
}

}  // namespace
}  // namespace headway::run
