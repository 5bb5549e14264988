// SPDX-License-Identifier: BSD-3-Clause
// A session over live sensors with a fake clock: observations arrive while frames are processed.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/live_source.h>
#include <headway/run/session.h>

#include <stdexcept>

#include "../io/foreign_recording.h"
#include "../io/synthetic_recording.h"

namespace headway::run {
namespace {

using pipeline::Perception;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A camera at 10 Hz and a pipeline of given duration, in one thread. The frames have recorded
/// poses instead of their images, so that processing takes no time but that of the fake clock.
class FakeRobot : public Source {
 public:
  explicit FakeRobot(std::vector<double> process_s) : process_s_(std::move(process_s)) {
    pipeline::PerceptionCallbacks callbacks;
    callbacks.on_pose = [this](Time, const slam::SlamUpdate&) {
      advanceTo(now_s_ + process_s_[processed_++ % process_s_.size()]);
    };
    perception_.setCallbacks(callbacks);
    advanceTo(0.1);  // two images show the camera
  }

  /// Advances the clock; the images of that time arrive.
  void advanceTo(double time_s) {
    for (; 0.1 * next_image_ <= time_s; ++next_image_) {
      now_s_ = 0.1 * next_image_;
      source_.push(io::test::wallObservation(next_image_, io::test::frameTime(next_image_)));
      longest_queue_ = std::max(longest_queue_, source_.queues().frames);
    }
    now_s_ = time_s;
  }

  [[nodiscard]] std::string name() const override { return "robot"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return nullptr; }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    if (!source_.hasFrame()) advanceTo(0.1 * next_image_);  // waits for the next image
    auto live = source_.next();
    if (live) live->frame.stereo.reset();
    if (live) live->frame.T_map_robot = Pose::Identity();
    return live;
  }
  [[nodiscard]] SourceReport report() const override {
    SourceReport report;
    report.dropped = dropped();
    return report;
  }
  [[nodiscard]] std::size_t dropped() const { return source_.dropped(); }

  SessionOptions options() {
    SessionOptions options;
    options.clock = [this] { return now_s_; };
    return options;
  }
  Perception& perception() { return perception_; }
  io::LiveSource& source() { return source_; }
  std::size_t longestQueue() const { return longest_queue_; }
  std::size_t arrived() const { return static_cast<std::size_t>(next_image_); }

 private:
  double now_s_ = 0.0;
  std::vector<double> process_s_;
  std::size_t processed_ = 0;
  int next_image_ = 0;
  std::size_t longest_queue_ = 0;
  io::LiveSource source_{{}, [this] { return now_s_; }};
  Perception perception_{nullptr, {}};
};

/// Frames with recorded poses and a box, 0.1 s apart.
class PoseSource : public Source {
 public:
  explicit PoseSource(std::size_t frames) : frames_(frames) {}
  [[nodiscard]] std::string name() const override { return "poses"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return nullptr; }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    if (next_ == frames_) return std::nullopt;
    LiveFrame live;
    live.frame.index = next_++;
    live.frame.time = 100.0 + 0.1 * static_cast<double>(live.frame.index);
    live.frame.T_map_robot = Pose::Identity();
    live.frame.detections.emplace().items.push_back(pedestrian());
    return live;
  }
  [[nodiscard]] SourceReport report() const override { return {}; }
  void close() override { ++closed; }

  int closed = 0;

 private:
  static Detection pedestrian() {
    Detection detection;
    detection.object_class = ObjectClass::kPedestrian;
    detection.score = 0.9;
    detection.box3d.emplace();
    detection.box3d->centre = {0.0, 0.0, 4.0};
    detection.box3d->length = 0.8;
    detection.box3d->width = 0.6;
    detection.box3d->height = 1.75;
    return detection;
  }

  std::size_t frames_;
  std::size_t next_ = 0;
};

/// Notes the calls.
class Log : public Sink {
 public:
  void onFrame(const FrameResult& result, Perception& /*perception*/) override {
    if (result.frame.index == throws_at) throw std::runtime_error("full disk");
    calls.push_back("frame " + std::to_string(result.update.frame));
  }
  void onEnd(const std::optional<std::string>& failure) override {
    calls.emplace_back(failure.value_or("end"));
  }
  void onComplete(Perception& /*perception*/) override {
    calls.emplace_back("complete");
    if (throws_at_completion) throw std::runtime_error("no file");
  }

  std::vector<std::string> calls;
  std::size_t throws_at = 1000;
  bool throws_at_completion = false;
};

std::string failureOf(Session& session) {
  try {
    session.run();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(SessionTest, SinksGetEveryFrameTheEndAndTheirCompletion) {
  PoseSource source(2);
  Perception perception(nullptr, {});
  Log first, second;
  Session session(source, perception, {&first});
  session.add(second);
  session.run();
  EXPECT_THAT(first.calls, ElementsAre("frame 0", "frame 1", "end", "complete"));
  EXPECT_EQ(first.calls, second.calls);
  EXPECT_EQ(1, source.closed);
  EXPECT_FALSE(session.next());
}

TEST(SessionTest, AStopEndsItBeforeTheNextFrameAndSinksAreCompleted) {
  PoseSource source(100);
  Perception perception(nullptr, {});
  Log log;
  SessionOptions options;
  options.stop = [&log] { return log.calls.size() == 2; };
  Session(source, perception, {&log}, options).run();
  EXPECT_THAT(log.calls, ElementsAre("frame 0", "frame 1", "end", "complete"));
}

TEST(SessionTest, AnExceptionOfASinkEndsItAndAllSinksAreCompleted) {
  PoseSource source(100);
  Perception perception(nullptr, {});
  Log broken, other;
  broken.throws_at = 1;
  broken.throws_at_completion = true;
  Session session(source, perception, {&broken, &other});
  EXPECT_EQ("full disk", failureOf(session)) << "the first one";
  EXPECT_THAT(broken.calls, ElementsAre("frame 0", "full disk", "complete"));
  EXPECT_THAT(other.calls, ElementsAre("frame 0", "full disk", "complete"));
}

TEST(SessionTest, AFailedCompletionIsPassedOnAfterTheOthers) {
  PoseSource source(1);
  Perception perception(nullptr, {});
  Log broken, other;
  broken.throws_at_completion = true;
  Session session(source, perception, {&broken, &other});
  EXPECT_EQ("no file", failureOf(session));
  EXPECT_THAT(other.calls, ElementsAre("frame 0", "end", "complete"));
}

TEST(SessionTest, MisuseOfPerceptionNamesSourceAndFrame) {
  PoseSource source(5);
  Perception perception(nullptr, {});
  pipeline::PerceptionCallbacks callbacks;
  callbacks.on_pose = [](Time time, const slam::SlamUpdate&) {
    if (time > 100.15) throw InputError("images of another size");
  };
  perception.setCallbacks(callbacks);
  Session session(source, perception);
  EXPECT_EQ("poses, frame 2: images of another size", failureOf(session));
}

TEST(SessionTest, SinksKnowThePoseBeforeObjectsAreDetected) {
  class Early : public Sink {
   public:
    void onLocal(Time time, const slam::SlamUpdate& camera,
                 const map::PerceptionMap& map) override {
      EXPECT_TRUE(slam::isTracked(camera.status));
      calls.push_back("local " + std::to_string(std::lround(10.0 * (time - 100.0))) + ", " +
                      std::to_string(map.movingObjects().tracks().size()) + " tracks");
    }
    void onFrame(const FrameResult& result, Perception& perception) override {
      calls.push_back("frame " + std::to_string(result.update.frame) + ", " +
                      std::to_string(perception.map().movingObjects().tracks().size()) + " tracks");
    }
    std::vector<std::string> calls;
  } early;
  PoseSource source(2);
  Perception perception(nullptr, {});
  Session(source, perception, {&early}).run();
  EXPECT_THAT(early.calls, ElementsAre("local 0, 0 tracks", "frame 0, 1 tracks",
                                       "local 1, 1 tracks", "frame 1, 1 tracks"));
}

TEST(SessionTest, FramesArePreparedBeforeTheyAreProcessed) {
  PoseSource source(1);
  Perception perception(nullptr, {});
  SessionOptions options;
  options.prepare = [](RecordedFrame& frame) { frame.T_map_robot->translation().x() = 3.0; };
  Session session(source, perception, {}, options);
  const auto result = session.next();
  ASSERT_TRUE(result);
  EXPECT_EQ(3.0, result->update.camera.T_map_robot.translation().x());
}

TEST(SessionTest, AFastPipelineGetsEveryFrameAtOnce) {
  FakeRobot robot({0.04});
  Log log;
  Session session(robot, robot.perception(), {&log}, robot.options());
  for (std::size_t i = 1; i < 20; ++i) {
    const auto result = session.next();
    EXPECT_EQ(i, result->update.frame);
    EXPECT_NEAR(0.04, result->latency_s(), 1e-9);
    EXPECT_NEAR(0.0, result->overhead_s(), 1e-9);
  }
  EXPECT_EQ(1u, robot.dropped());
  EXPECT_EQ(19u, log.calls.size());
}

TEST(SessionTest, ASlowPipelineGetsTheNewestFrameAndTheOthersAreCounted) {
  FakeRobot robot({0.27});
  Session session(robot, robot.perception(), {}, robot.options());
  std::vector<std::size_t> served;
  for (int i = 0; i < 6; ++i) {
    const auto result = session.next();
    served.push_back(result->update.frame);
    EXPECT_LT(result->overhead_s(), 0.1) << "a newer frame was complete";
    EXPECT_EQ(robot.arrived(), served.size() + robot.dropped() + robot.source().queues().frames);
  }
  EXPECT_THAT(served, ElementsAre(1, 3, 6, 9, 11, 14));
  EXPECT_EQ(1u, robot.longestQueue());
}

TEST(SessionTest, LatencyDoesNotGrowAfterAStall) {
  FakeRobot robot({0.09, 0.09, 3.0, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09, 0.09});
  Session session(robot, robot.perception(), {}, robot.options());
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) worst = std::max(worst, session.next()->overhead_s());
  EXPECT_LT(worst, 0.1 + 1e-9);
  EXPECT_EQ(1u, robot.longestQueue());
}

/// A page whose drawing takes time.
class SlowPage : public Sink {
 public:
  SlowPage(FakeRobot& robot, double seconds) : robot_(robot), seconds_(seconds) {}
  void onFrame(const FrameResult& result, Perception& /*perception*/) override {
    frames.push_back(result.update.frame);
    robot_.advanceTo(robot_.options().clock() + seconds_);
  }
  [[nodiscard]] bool isExpendable() const override { return true; }

  std::vector<std::size_t> frames;

 private:
  FakeRobot& robot_;
  double seconds_;
};

TEST(SessionTest, ExpendableSinksAreLeftOutUnderLoadTheOthersAreNot) {
  FakeRobot robot({0.06});
  SlowPage page(robot, 0.07);
  Log log;
  auto options = robot.options();
  options.shed_load.emplace();
  Session session(robot, robot.perception(), {&log, &page}, options);
  std::vector<std::string> changes;
  std::size_t left_out = 0;
  for (int i = 0; i < 30; ++i) {
    const auto result = session.next();
    if (!result->load_change.empty()) changes.push_back(result->load_change);
    if (!result->left_out.empty()) ++left_out;
  }
  ASSERT_EQ(1u, changes.size()) << "without the page 60 % of the interval remain";
  EXPECT_THAT(changes.front(), HasSubstr("without pictures"));
  EXPECT_GT(left_out, 10u);
  EXPECT_EQ(30u, page.frames.size() + left_out);
  EXPECT_EQ(30u, log.calls.size());
}

TEST(SessionTest, AnExceptionRetractsTheMapAndIsPassedOn) {
  PoseSource source(5);
  Perception perception(nullptr, {});
  pipeline::PerceptionCallbacks callbacks;
  callbacks.on_pose = [](Time time, const slam::SlamUpdate&) {
    if (time > 100.05) throw std::runtime_error("broken");
  };
  perception.setCallbacks(callbacks);
  map::SharedMap shared;
  MapPublisher publisher(shared);
  Session session(source, perception, {&publisher});
  EXPECT_TRUE(session.next());
  EXPECT_EQ(1u, shared.snapshot()->movingObjects().tracks().size());
  EXPECT_THROW((void)session.next(), std::runtime_error);
  EXPECT_TRUE(shared.snapshot()->movingObjects().tracks().empty());
  EXPECT_FALSE(session.next()) << "it has ended";
}

}  // namespace
}  // namespace headway::run
