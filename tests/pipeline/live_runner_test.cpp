// SPDX-License-Identifier: BSD-3-Clause
// A runner over live sensors with a fake clock: observations arrive while a slow stage runs.
#include <gmock/gmock.h>
#include <headway/io/live_source.h>
#include <headway/pipeline/live_runner.h>

#include <stdexcept>

#include "../io/foreign_recording.h"
#include "../io/synthetic_recording.h"

namespace headway::pipeline {
namespace {

using ::testing::ElementsAre;

/// A camera at 10 Hz and a stage of given duration, in one thread.
class FakeRobot {
 public:
  explicit FakeRobot(std::vector<double> stage_s) : stage_s_(std::move(stage_s)) {}

  /// Advances the clock; the images of that time arrive.
  void advanceTo(double time_s) {
    for (; 0.1 * next_image_ <= time_s; ++next_image_) {
      now_s_ = 0.1 * next_image_;
      source_.push(io::test::wallObservation(next_image_, io::test::frameTime(next_image_)));
      longest_queue_ = std::max(longest_queue_, source_.queues().frames);
    }
    now_s_ = time_s;
  }

  LiveRunner runner() {
    return LiveRunner(
        [this] {
          if (!source_.hasFrame()) advanceTo(0.1 * next_image_);  // waits for the next image
          return source_.next();
        },
        [this](const RecordedFrame& frame) {
          advanceTo(now_s_ + stage_s_[stage_++ % stage_s_.size()]);
          PerceptionUpdate update;
          update.frame = frame.index;
          return update;
        },
        [this] { ++published_; }, [this] { ++retracted_; }, [this] { return now_s_; });
  }

  io::LiveSource& source() { return source_; }
  std::size_t longestQueue() const { return longest_queue_; }
  std::size_t arrived() const { return static_cast<std::size_t>(next_image_); }
  int published() const { return published_; }
  int retracted() const { return retracted_; }

 private:
  double now_s_ = 0.0;
  std::vector<double> stage_s_;
  std::size_t stage_ = 0;
  int next_image_ = 0;
  std::size_t longest_queue_ = 0;
  int published_ = 0;
  int retracted_ = 0;
  io::LiveSource source_{{}, [this] { return now_s_; }};
};

TEST(LiveRunnerTest, AFastStageGetsEveryFrameAtOnce) {
  FakeRobot robot({0.04});
  robot.advanceTo(0.1);  // two images show the camera
  auto runner = robot.runner();
  for (std::size_t i = 1; i < 20; ++i) {
    const auto update = runner.next();
    EXPECT_EQ(i, update->perception.frame);
    EXPECT_NEAR(0.04, update->latency_s(), 1e-9);
    EXPECT_NEAR(0.0, update->overhead_s(), 1e-9);
  }
  EXPECT_EQ(1u, robot.source().dropped());
  EXPECT_EQ(19, robot.published());
}

TEST(LiveRunnerTest, ASlowStageGetsTheNewestFrameAndTheOthersAreCounted) {
  FakeRobot robot({0.27});
  robot.advanceTo(0.1);
  auto runner = robot.runner();
  std::vector<std::size_t> served;
  for (int i = 0; i < 6; ++i) {
    const auto update = runner.next();
    served.push_back(update->perception.frame);
    EXPECT_LT(update->overhead_s(), 0.1) << "a newer frame was complete";
    EXPECT_EQ(robot.arrived(),
              served.size() + robot.source().dropped() + robot.source().queues().frames);
  }
  EXPECT_THAT(served, ElementsAre(1, 3, 6, 9, 11, 14));
  EXPECT_EQ(1u, robot.longestQueue());
}

TEST(LiveRunnerTest, LatencyDoesNotGrowAfterAStall) {
  FakeRobot robot({0.09, 0.09, 3.0, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09});
  robot.advanceTo(0.1);
  auto runner = robot.runner();
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) worst = std::max(worst, runner.next()->overhead_s());
  EXPECT_LT(worst, 0.1 + 1e-9);
  EXPECT_EQ(1u, robot.longestQueue());
}

TEST(LiveRunnerTest, AnExceptionRetractsTheMapAndIsPassedOn) {
  map::SharedMap shared;
  int calls = 0;
  LiveRunner runner([] { return std::optional<LiveFrame>(LiveFrame()); },
                    [&](const RecordedFrame&) -> PerceptionUpdate {
                      if (++calls > 1) throw std::runtime_error("broken");
                      return {};
                    },
                    [&] {
                      map::PerceptionMap map;
                      map.update(1.0, {Track()});
                      shared.publish(map);
                    },
                    [&] { shared.reset(); }, monotonicSeconds);
  EXPECT_TRUE(runner.next());
  EXPECT_EQ(1u, shared.snapshot()->movingObjects().tracks().size());
  EXPECT_THROW((void)runner.next(), std::runtime_error);
  EXPECT_TRUE(shared.snapshot()->movingObjects().tracks().empty());
}

}  // namespace
}  // namespace headway::pipeline
