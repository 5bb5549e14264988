// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/run/session.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

namespace headway::run {
namespace {

using FrameReader = std::function<std::optional<RecordedFrame>()>;

/// Frames 0 .. count-1, `interval_s` apart.
FrameReader readerOf(std::size_t count, double interval_s) {
  return [count, interval_s, next = std::size_t{0}]() mutable -> std::optional<RecordedFrame> {
    if (next == count) return std::nullopt;
    RecordedFrame frame;
    frame.index = next;
    frame.time = 100.0 + interval_s * static_cast<double>(next++);
    return frame;
  };
}

/// A source of what a function returns.
class ReaderSource : public Source {
 public:
  explicit ReaderSource(FrameReader reader) : reader_(std::move(reader)) {}
  [[nodiscard]] std::string name() const override { return "reader"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return nullptr; }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    auto frame = reader_();
    if (!frame) return std::nullopt;
    ++read_;
    return LiveFrame{std::move(*frame), 0.0};
  }
  [[nodiscard]] SourceReport report() const override {
    SourceReport report;
    report.skipped.emplace().emplace("read", read_);
    return report;
  }

 private:
  FrameReader reader_;
  std::size_t read_ = 0;
};

std::unique_ptr<Source> realtime(FrameReader reader, double factor, std::size_t capacity = 1) {
  return inRealtime(std::make_unique<ReaderSource>(std::move(reader)), factor, capacity);
}

std::vector<std::size_t> drain(Source& source, double busy_s) {
  std::vector<std::size_t> indices;
  while (auto live = source.next(neverStop)) {
    indices.push_back(live->frame.index);
    std::this_thread::sleep_for(std::chrono::duration<double>(busy_s));
  }
  return indices;
}

TEST(RealtimeFramesTest, KeepsTheOrderAndAccountsForEveryFrame) {
  const auto source = realtime(readerOf(40, 0.1), 100.0);
  const auto indices = drain(*source, 0.005);
  EXPECT_GT(source->report().dropped, 0u);
  EXPECT_EQ(40u, indices.size() + source->report().dropped);
  EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
  EXPECT_EQ(39u, indices.back()) << "the newest frame is never the one that goes";
}

TEST(RealtimeFramesTest, DoesNotRunAheadOfTheRecording) {
  const auto start = std::chrono::steady_clock::now();
  const auto source = realtime(readerOf(5, 0.1), 10.0, 5);
  EXPECT_EQ(5u, drain(*source, 0.0).size());
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(40));
}

TEST(RealtimeFramesTest, AStopRequestEndsTheWaitForTheNextFrame) {
  const auto source = realtime(readerOf(2, 3600.0), 0.001);
  EXPECT_TRUE(source->next(neverStop));
  std::atomic<bool> stop{false};
  auto stopping = std::async(std::launch::async, [&stop] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    stop = true;
  });
  EXPECT_FALSE(source->next([&stop] { return stop.load(); })) << "instead of in a thousand hours";
}

TEST(RealtimeFramesTest, MotionOfDroppedFramesIsPartOfThatOfTheNextOne) {
  const auto frames = [inner = readerOf(12, 0.01)]() mutable {
    auto frame = inner();
    if (!frame) return frame;
    frame->stereo.emplace();
    frame->stereo->index = frame->index;
    Pose step = Pose::Identity();
    step.translation().x() = 0.1;
    if (frame->index > 0) frame->stereo->motion_prior.T_previous_current = step;
    return frame;
  };
  const auto source = realtime(frames, 1.0);
  std::optional<std::size_t> previous;
  double path_m = 0.0;
  while (auto live = source->next(neverStop)) {
    const RecordedFrame* frame = &live->frame;
    const MotionPrior& prior = frame->stereo->motion_prior;
    if (previous) {
      ASSERT_TRUE(prior.T_previous_current) << frame->index;
      EXPECT_EQ(*previous, prior.previous_frame.value_or(frame->index - 1));
      path_m += prior.T_previous_current->translation().x();
      EXPECT_NEAR(0.1 * static_cast<double>(frame->index), path_m, 1e-9);
    }
    previous = frame->index;
    std::this_thread::sleep_for(std::chrono::milliseconds(35));
  }
  EXPECT_GT(source->report().dropped, 0U);
}

TEST(RealtimeFramesTest, AnHoursPauseOfTheRecordingIsNotWaitedFor) {
  const auto start = std::chrono::steady_clock::now();
  const auto source = realtime(readerOf(3, 3600.0), 100.0, 3);
  EXPECT_EQ(3u, drain(*source, 0.0).size());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(36)) << "of one pause";
}

TEST(RealtimeFramesTest, AClockThatIsSetBackDoesNotChangeThePace) {
  auto inner = readerOf(10, 0.1);
  const auto start = std::chrono::steady_clock::now();
  const auto source = realtime(
      [inner]() mutable {
        auto frame = inner();
        if (frame && frame->index >= 5) frame->time -= 3600.0;
        return frame;
      },
      2.0, 10);
  EXPECT_EQ(10u, drain(*source, 0.0).size());
  const auto elapsed = std::chrono::steady_clock::now() - start;
  EXPECT_GE(elapsed, std::chrono::milliseconds(450)) << "nine intervals";
  EXPECT_LT(elapsed, std::chrono::seconds(36)) << "an hour is not waited for";
}

TEST(RealtimeFramesTest, ExceptionsOfTheReaderFollowItsLastFrame) {
  auto inner = readerOf(3, 0.0);
  const auto source = realtime(
      [inner]() mutable {
        auto frame = inner();
        if (!frame) throw std::runtime_error("broken");
        return frame;
      },
      1.0, 8);
  EXPECT_TRUE(source->next(neverStop));
  EXPECT_TRUE(source->next(neverStop));
  EXPECT_TRUE(source->next(neverStop));
  EXPECT_THROW((void)source->next(neverStop), std::runtime_error);
}

TEST(RealtimeFramesTest, SkippedObservationsAreKnownAgainOnceItIsClosed) {
  const auto source = realtime(readerOf(1000, 10.0), 1.0);
  EXPECT_TRUE(source->report().skipped);
  EXPECT_TRUE(source->next(neverStop));
  EXPECT_FALSE(source->report().skipped) << "its thread counts them";
  source->close();
  EXPECT_GE(source->report().skipped.value().at("read"), 1u);
}

TEST(RealtimeFramesTest, ClosesBeforeTheEndOfTheInput) {
  const auto source = realtime(readerOf(1000, 10.0), 1.0);
  EXPECT_TRUE(source->next(neverStop));
}

}  // namespace
}  // namespace headway::run
