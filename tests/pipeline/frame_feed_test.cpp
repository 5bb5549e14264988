// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/stop_request.h>
#include <headway/pipeline/frame_feed.h>

#include <future>
#include <stdexcept>
#include <thread>
#include <vector>

namespace headway::pipeline {
namespace {

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

std::vector<std::size_t> drain(FrameFeed& feed, double busy_s) {
  std::vector<std::size_t> indices;
  while (auto frame = feed.next()) {
    indices.push_back(frame->index);
    std::this_thread::sleep_for(std::chrono::duration<double>(busy_s));
  }
  return indices;
}

TEST(FrameFeedTest, OfflineReturnsEveryFrame) {
  const auto feed = makeOfflineFeed(readerOf(5, 0.1));
  EXPECT_EQ((std::vector<std::size_t>{0, 1, 2, 3, 4}), drain(*feed, 0.0));
  EXPECT_EQ(0u, feed->dropped());
}

TEST(FrameFeedTest, RealtimeKeepsTheOrderAndAccountsForEveryFrame) {
  const auto feed = makeRealtimeFeed(readerOf(40, 0.1), 100.0);
  const auto indices = drain(*feed, 0.005);
  EXPECT_GT(feed->dropped(), 0u);
  EXPECT_EQ(40u, indices.size() + feed->dropped());
  EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
  EXPECT_EQ(39u, indices.back()) << "the newest frame is never the one that goes";
}

TEST(FrameFeedTest, RealtimeDoesNotRunAheadOfTheRecording) {
  const auto start = std::chrono::steady_clock::now();
  const auto feed = makeRealtimeFeed(readerOf(5, 0.1), 10.0, 5);
  EXPECT_EQ(5u, drain(*feed, 0.0).size());
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(40));
}

TEST(FrameFeedTest, AStopRequestEndsTheWaitForTheNextFrame) {
  const auto feed = makeRealtimeFeed(readerOf(2, 3600.0), 0.001);
  EXPECT_TRUE(feed->next());
  auto stop = std::async(std::launch::async, [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    requestStop(1);
  });
  EXPECT_FALSE(feed->next()) << "instead of in a thousand hours";
  stop.get();
  requestStop(0);
}

TEST(FrameFeedTest, MotionOfDroppedFramesIsPartOfThatOfTheNextOne) {
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
  const auto feed = makeRealtimeFeed(frames, 1.0);
  std::optional<std::size_t> previous;
  double path_m = 0.0;
  while (auto frame = feed->next()) {
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
  EXPECT_GT(feed->dropped(), 0U);
}

TEST(FrameFeedTest, AnHoursPauseOfTheRecordingIsNotWaitedFor) {
  const auto start = std::chrono::steady_clock::now();
  const auto feed = makeRealtimeFeed(readerOf(3, 3600.0), 100.0, 3);
  EXPECT_EQ(3u, drain(*feed, 0.0).size());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(36)) << "of one pause";
}

TEST(FrameFeedTest, AClockThatIsSetBackDoesNotChangeThePace) {
  auto inner = readerOf(10, 0.1);
  const auto start = std::chrono::steady_clock::now();
  const auto feed = makeRealtimeFeed(
      [inner]() mutable {
        auto frame = inner();
        if (frame && frame->index >= 5) frame->time -= 3600.0;
        return frame;
      },
      2.0, 10);
  EXPECT_EQ(10u, drain(*feed, 0.0).size());
  const auto elapsed = std::chrono::steady_clock::now() - start;
  EXPECT_GE(elapsed, std::chrono::milliseconds(450)) << "nine intervals";
  EXPECT_LT(elapsed, std::chrono::seconds(36)) << "an hour is not waited for";
}

TEST(FrameFeedTest, ExceptionsOfTheReaderFollowItsLastFrame) {
  auto inner = readerOf(3, 0.0);
  const auto feed = makeRealtimeFeed(
      [inner]() mutable {
        auto frame = inner();
        if (!frame) throw std::runtime_error("broken");
        return frame;
      },
      1.0, 8);
  EXPECT_TRUE(feed->next());
  EXPECT_TRUE(feed->next());
  EXPECT_TRUE(feed->next());
  EXPECT_THROW((void)feed->next(), std::runtime_error);
}

TEST(FrameFeedTest, ClosesBeforeTheEndOfTheInput) {
  const auto feed = makeRealtimeFeed(readerOf(1000, 10.0), 1.0);
  EXPECT_TRUE(feed->next());
}

}  // namespace
}  // namespace headway::pipeline
