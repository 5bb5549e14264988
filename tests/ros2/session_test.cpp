// SPDX-License-Identifier: BSD-3-Clause
// A robot program: topics of another implementation through a session to topics.
#include <gmock/gmock.h>
#include <headway/ros2/topic_sink.h>
#include <headway/ros2/topic_source.h>
#include <headway_test/paths.h>
#include <headway_test/waiting.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <set>
#include <thread>
#include <vector>

#include "robot.h"

namespace headway::ros2 {
namespace {

using test::FastDdsPeer;
using test::waitUntil;

TEST(Ros2SessionTest, TopicsOfARobotBecomeTopicsOfItsSurroundings) {
  using namespace sensor_msgs::msg::dds_;
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  const int domain = test::domainOfThisTest();
  FastDdsPeer peer(domain);
  test::Robot robot(peer, std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog");
  const test::Results results(peer);
  std::atomic<std::size_t> clouds{0}, points{0}, costmaps{0}, boxes{0}, maps{0};
  const auto obstacles = peer.reader<PointCloud2_PubSubType>(
      "rt/headway/obstacles", {true, false, 100}, [&](const auto& message) {
        ++clouds;
        points += message.width();
      });
  using Grid = nav_msgs::msg::dds_::OccupancyGrid_PubSubType;
  const auto costmap =
      peer.reader<Grid>("rt/headway/local_costmap", {}, [&](const auto&) { ++costmaps; });
  const auto map = peer.reader<Grid>("rt/map", {true, true, 1}, [&](const auto&) { ++maps; });
  const auto tracks = peer.reader<vision_msgs::msg::dds_::Detection3DArray_PubSubType>(
      "rt/headway/detections", {},
      [&](const auto& message) { boxes += message.detections().size(); });

  // Takes one costmap and no more.
  FastDdsPeer sleeper(domain);
  std::atomic<bool> sleeps{true};
  const auto stalled = sleeper.reader<Grid>("rt/headway/local_costmap", {}, [&](const auto&) {
    while (sleeps) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  });
  std::atomic<std::size_t> warnings{0}, others{0};
  const auto health = peer.reader<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
      "rt/diagnostics", {}, [&](const auto& message) {
        for (const auto& line : message.status()) {
          for (const auto& value : line.values()) {
            if (line.name() != "headway: output" || line.level() != 1) continue;
            ++(value.key() == "/headway/local_costmap" ? warnings : others);
          }
        }
      });

  Node node({"headway", domain, ""});
  io::LiveSource live;
  Ros2SinkParams params;
  params.odom_base = true;
  params.local_costmap_hz = 30.0;
  params.diagnostics_hz = 10.0;
  TopicSink sink(node, params);
  TopicSource topics(node, {}, {},
                     {[&](const auto& observation) {
                        live.push(observation);
                        sink.addObservation(*observation);
                      },
                      {},
                      {}});
  topics.start();
  ASSERT_TRUE(waitUntil([&] { return robot.isWatched(); })) << topics.missing();
  const std::atomic<bool> stop{false};
  std::set<long> sent;
  robot.on_frame = [&](Time time) {
    EXPECT_TRUE(!sent.empty() || waitUntil([&] { return topics.missing().empty(); }));
    sent.insert(test::Results::keyOf(time));
    results.await(time);
  };
  std::thread player([&] {
    (void)robot.play(0.5, stop, {0, 40});
    std::this_thread::sleep_for(std::chrono::seconds(1));
    live.close();
  });
  run::SensorFrames source(live);
  std::size_t tracked = 0;
  std::vector<double> delivery_s;  // by the sink, beside perception
  {
    pipeline::Perception perception(source.camera(), pipeline::PerceptionParams::live());
    run::Session session(source, perception, {&sink});
    while (const auto result = session.next()) {
      if (slam::isTracked(result->update.camera.status)) ++tracked;
      delivery_s.push_back(result->delivered_s - result->end_s);
    }
    session.complete();
  }
  player.join();
  EXPECT_GT(tracked, sent.size() / 2) << topics.missing();  // others came before both had met
  EXPECT_TRUE(waitUntil([&] { return results.stamps().size() >= tracked; }));
  for (const long stamp : results.stamps()) EXPECT_EQ(sent.count(stamp), 1U) << stamp;
  EXPECT_GT(clouds, 0U);
  EXPECT_GT(points, 0U);
  ASSERT_FALSE(delivery_s.empty());
  std::sort(delivery_s.begin(), delivery_s.end());
  EXPECT_LT(delivery_s[delivery_s.size() / 2], 0.02);  // perception never waits
  EXPECT_GT(costmaps, tracked / 2);                    // in spite of another who takes none
  EXPECT_GT(maps, 0U);
  EXPECT_GT(boxes, 0U);
  EXPECT_GT(warnings, 0U);
  EXPECT_EQ(others, 0U);
  sleeps = false;
  std::printf("%zu of %zu frames, %zu clouds of %zu points, %zu boxes\n", tracked, sent.size(),
              clouds.load(), points.load(), boxes.load());
}

}  // namespace
}  // namespace headway::ros2
