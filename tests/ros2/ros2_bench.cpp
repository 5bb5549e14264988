// SPDX-License-Identifier: BSD-3-Clause
// Plays a rawlog as a robot's topics and measures how late the results come:
//   bench_ros2 RAWLOG DOMAIN FACTOR LOOPS [compressed]
// Without headway-live beside it (DOMAIN negative: of its number, a node of this process alone) it
// measures how long an image takes to the node.
#include <headway/core/recorded_frame.h>
#include <headway/core/statistics.h>
#include <headway/ros2/node.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>

#include "messages.h"
#include "robot.h"

namespace {

using namespace headway;

/// Times from an image to something with its stamp.
class Delays {
 public:
  void sent(Time stamp, double now_s) {
    const std::lock_guard lock(mutex_);
    sent_[std::lround(1e4 * stamp)] = now_s;
  }
  void received(Time stamp) {
    const double now_s = monotonicSeconds();
    const std::lock_guard lock(mutex_);
    const auto found = sent_.find(std::lround(1e4 * stamp));
    if (found != sent_.end()) delays_ms_.push_back(1e3 * (now_s - found->second));
  }
  void print(const char* what) {
    const std::lock_guard lock(mutex_);
    std::sort(delays_ms_.begin(), delays_ms_.end());
    const auto at = [&](double ratio) {
      if (delays_ms_.empty()) return std::nan("");
      return delays_ms_[static_cast<std::size_t>(ratio *
                                                 static_cast<double>(delays_ms_.size() - 1))];
    };
    std::printf("%-28s %6zu of %6zu images, p50 %7.2f ms, p95 %7.2f ms, p99 %7.2f ms\n", what,
                delays_ms_.size(), sent_.size(), at(0.5), at(0.95), at(0.99));
    std::fflush(stdout);
  }

 private:
  std::mutex mutex_;
  std::map<long, double> sent_;
  std::vector<double> delays_ms_;
};

template <typename Header>
Time timeOf(const Header& header) {
  return header.stamp().sec() + 1e-9 * header.stamp().nanosec();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const int domain = std::abs(std::atoi(argv[2]));
  const bool is_alone = argv[2][0] == '-';
  const double factor = std::atof(argv[3]);
  const int loops = std::atoi(argv[4]);
  const bool is_compressed = argc > 5 && std::strcmp(argv[5], "compressed") == 0;
  test::FastDdsPeer peer(domain);
  Delays transport, obstacles, odometry;
  std::atomic<bool> stop{false};
  std::optional<ros2::Node> node;
  std::thread listener;
  if (is_alone) {
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
    node.emplace(ros2::NodeOptions{"bench", domain, ""});
    std::printf("%s\n", node->network().c_str());
    const std::string suffix = is_compressed ? "/compressed" : "";
    const std::string type = is_compressed ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image";
    const auto time = [&](std::string_view message) {
      const auto header = bags::decodeHeader(message, bags::Encoding::kCdr);
      transport.received(1e-9 * static_cast<double>(header.time_ns));
    };
    const auto leave = [](std::string_view) {};
    node->subscribe("/left/image" + suffix, type, {}, leave);
    node->subscribe("/right/image" + suffix, type, {}, time);
    node->subscribe("/color/image", type, {}, leave);
    node->subscribe("/depth/image", type, {}, time);
    listener = std::thread([&] {
      while (!stop) node->spin(0.05);
    });
  }
  const auto clouds = peer.reader<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(
      "rt/headway/obstacles", {true, false, 100},
      [&](const auto& message) { obstacles.received(timeOf(message.header())); });
  const auto poses = peer.reader<nav_msgs::msg::dds_::Odometry_PubSubType>(
      "rt/headway/odometry", {true, false, 1000},
      [&](const auto& message) { odometry.received(timeOf(message.header())); });
  for (int loop = 0; loop < loops; ++loop) {
    test::Robot robot(peer, argv[1], is_compressed, 1000.0 * loop);
    robot.on_frame = [&](Time stamp, double now_s) {
      for (Delays* delays : {&transport, &obstacles, &odometry}) delays->sent(stamp, now_s);
    };
    while (!robot.isWatched()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::size_t frames = robot.play(factor, stop);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    std::printf("loop %d: %zu frames", loop, frames);
    for (const auto& [topic, count] : robot.sent()) std::printf(", %s %zu", topic.c_str(), count);
    std::printf("\n");
    (is_alone ? transport : obstacles).print(is_alone ? "image to node" : "image to obstacles");
    if (!is_alone) odometry.print("image to odometry");
  }
  stop = true;
  if (listener.joinable()) listener.join();
  return 0;
}
