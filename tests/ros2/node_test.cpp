// SPDX-License-Identifier: BSD-3-Clause
// Messages to and from another implementation of DDS: names, types, quality of service, fields.
#include <dds/ddsrt/log.h>
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/ros2/node.h>
#include <headway_test/waiting.h>
#include <headway_test/walking_track.h>
#include <ifaddrs.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <net/if.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <thread>

#include "bag_file.h"
#include "fast_dds_peer.h"
#include "messages.h"
#include "outgoing_messages.h"

namespace headway::ros2 {
namespace {

using test::FastDdsPeer;
using test::PeerQos;
using test::waitUntil;

constexpr Time kTime = 1'700'000'000.25;

class NodeTest : public ::testing::Test {
 protected:
  NodeTest() : domain_(test::domainOfThisTest()), peer_(domain_) {
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
    node_.emplace(NodeOptions{"headway", domain_, ""});
  }

  /// Sends a message until the peer has it.
  template <typename PubSubType>
  typename PubSubType::type received(const std::string& topic, const std::string& type,
                                     const std::string& message, const Qos& qos = {}) {
    std::mutex mutex;
    std::optional<typename PubSubType::type> result;
    const auto reader =
        peer_.reader<PubSubType>("rt" + topic, {qos.is_reliable, qos.is_transient_local, 10},
                                 [&](const typename PubSubType::type& sample) {
                                   const std::lock_guard lock(mutex);
                                   result = sample;
                                 });
    const Publication publication = node_->advertise(topic, type, qos);
    EXPECT_TRUE(waitUntil([&] { return publication.hasSubscribers() && reader->matched() > 0; }))
        << topic;
    EXPECT_TRUE(publication.publish(message)) << topic;
    EXPECT_TRUE(waitUntil([&] {
      const std::lock_guard lock(mutex);
      return result.has_value();
    })) << topic;
    const std::lock_guard lock(mutex);
    return result.value_or(typename PubSubType::type());
  }

  int domain_;
  FastDdsPeer peer_;
  std::optional<Node> node_;
};

const MessageHeader kHeader{1'700'000'000'250'000'000, "odom"};

template <typename Header>
void expectStamp(const Header& header, const std::string& frame) {
  EXPECT_EQ(header.stamp().sec(), 1'700'000'000);
  EXPECT_EQ(header.stamp().nanosec(), 250'000'000U);
  EXPECT_EQ(header.frame_id(), frame);
}

TEST_F(NodeTest, AnotherImplementationReadsPosesAndTransforms) {
  Pose pose = Pose::Identity();
  pose.translation() << 1.0, 2.0, 3.0;
  pose.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const auto tf = received<tf2_msgs::msg::dds_::TFMessage_PubSubType>(
      "/tf", "tf2_msgs/TFMessage", transformMessage({{kHeader, "base_link", pose}}),
      {true, false, 100});
  ASSERT_EQ(tf.transforms().size(), 1U);
  expectStamp(tf.transforms()[0].header(), "odom");
  EXPECT_EQ(tf.transforms()[0].child_frame_id(), "base_link");
  EXPECT_EQ(tf.transforms()[0].transform().translation().y(), 2.0);
  EXPECT_NEAR(tf.transforms()[0].transform().rotation().z(), std::sqrt(0.5), 1e-12);

  OdometrySample sample;
  sample.time = kTime;
  sample.frame = "odom";
  sample.child = "base_link";
  sample.T_odom_robot = pose;
  sample.velocity = {0.5, 0.0, 0.0};
  sample.covariance(0, 0) = 4.0;  // along the robot, which looks along y
  sample.covariance(5, 5) = 0.25;
  const auto odometry = received<nav_msgs::msg::dds_::Odometry_PubSubType>(
      "/odometry", "nav_msgs/Odometry", odometryMessage(sample));
  expectStamp(odometry.header(), "odom");
  EXPECT_EQ(odometry.child_frame_id(), "base_link");
  EXPECT_EQ(odometry.pose().pose().position().z(), 3.0);
  EXPECT_NEAR(odometry.pose().covariance()[7], 4.0, 1e-12);
  EXPECT_NEAR(odometry.pose().covariance()[35], 0.25, 1e-12);
  EXPECT_EQ(odometry.twist().twist().linear().x(), 0.5);

  const auto clock = received<rosgraph_msgs::msg::dds_::Clock_PubSubType>(
      "/clock", "rosgraph_msgs/Clock", clockMessage(kTime));
  EXPECT_EQ(clock.clock().nanosec(), 250'000'000U);
}

TEST_F(NodeTest, AnotherImplementationReadsGridsAndClouds) {
  mrpt::maps::COccupancyGridMap2D grid(0.0F, 0.3F, -0.2F, 0.0F, 0.1F);
  grid.setCell(0, 0, 0.9F);  // free
  grid.setCell(2, 1, 0.1F);  // occupied
  const auto map = received<nav_msgs::msg::dds_::OccupancyGrid_PubSubType>(
      "/map", "nav_msgs/OccupancyGrid", gridMessage(headerOf(kTime, "map"), grid), {true, true, 1});
  expectStamp(map.header(), "map");
  EXPECT_NEAR(map.info().resolution(), 0.1F, 1e-6F);
  ASSERT_EQ(map.data().size(), map.info().width() * map.info().height());
  EXPECT_NEAR(map.info().origin().position().y(), grid.getYMin(), 1e-6);
  EXPECT_EQ(map.data()[0], 0);
  EXPECT_EQ(map.data()[map.info().width() + 2], 100);
  EXPECT_EQ(map.data()[1], 255);  // -1: unknown

  const auto cloud = received<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(
      "/obstacles", "sensor_msgs/PointCloud2", cloudMessage(kHeader, {{1.0F, 2.0F, 3.0F}}));
  expectStamp(cloud.header(), "odom");
  EXPECT_EQ(cloud.width(), 1U);
  ASSERT_EQ(cloud.fields().size(), 3U);
  EXPECT_EQ(cloud.fields()[1].name(), "y");
  EXPECT_EQ(cloud.fields()[1].offset(), 4U);
  EXPECT_EQ(cloud.fields()[1].datatype(), 7);
  ASSERT_EQ(cloud.data().size(), 12U);
  float y = 0.0F;
  std::memcpy(&y, &cloud.data()[4], sizeof y);
  EXPECT_EQ(y, 2.0F);
  EXPECT_TRUE(cloud.is_dense());

  mrpt::maps::CColouredPointsMap points;
  points.insertPointRGB(1.0F, 2.0F, 3.0F, 1.0F, 0.0F, 0.2F);
  const auto dense = received<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(
      "/dense_map", "sensor_msgs/PointCloud2", cloudMessage(kHeader, points));
  ASSERT_EQ(dense.data().size(), 16U);
  EXPECT_EQ(dense.fields()[3].name(), "rgb");
  EXPECT_EQ(dense.data()[14], 255);
  EXPECT_EQ(dense.data()[12], 51);
}

TEST_F(NodeTest, AnotherImplementationReadsTracks) {
  auto track = test::walkingTrack(7, {1.0, 2.0}, {0.0, 1.5}, 0.1);
  track.score = 0.75;
  track.velocity_covariance << 0.5, 0.0, 0.0, 0.25;
  auto hidden = track;
  hidden.status = TrackStatus::kTentative;
  const auto detections = received<vision_msgs::msg::dds_::Detection3DArray_PubSubType>(
      "/detections", "vision_msgs/Detection3DArray", detectionMessage(kHeader, {track, hidden}));
  ASSERT_EQ(detections.detections().size(), 1U);
  const auto& detection = detections.detections()[0];
  expectStamp(detection.header(), "odom");
  EXPECT_EQ(detection.id(), "7");
  EXPECT_EQ(detection.results()[0].hypothesis().class_id(), "Pedestrian");
  EXPECT_EQ(detection.results()[0].hypothesis().score(), 0.75);
  EXPECT_EQ(detection.bbox().center().position().y(), 2.0);
  EXPECT_EQ(detection.bbox().size().z(), 1.7);
  EXPECT_NEAR(detection.results()[0].pose().covariance()[14], 0.01, 1e-12);

  const auto obstacles = received<nav2_dynamic_msgs::msg::dds_::ObstacleArray_PubSubType>(
      "/moving_obstacles", "nav2_dynamic_msgs/ObstacleArray", obstacleMessage(kHeader, {track}));
  ASSERT_EQ(obstacles.obstacles().size(), 1U);
  const auto& obstacle = obstacles.obstacles()[0];
  EXPECT_EQ(obstacle.uuid().uuid()[15], 7);
  EXPECT_EQ(obstacle.velocity().y(), 1.5);
  EXPECT_EQ(obstacle.velocity_covariance()[4], 0.25);
  EXPECT_NEAR(obstacle.position_covariance()[0], 0.01, 1e-12);
  EXPECT_EQ(obstacle.size().z(), 1.7);

  const auto markers = received<visualization_msgs::msg::dds_::MarkerArray_PubSubType>(
      "/markers", "visualization_msgs/MarkerArray", markerMessage(kHeader, {track}));
  ASSERT_EQ(markers.markers().size(), 3U);
  EXPECT_EQ(markers.markers()[0].type(), 1);
  EXPECT_EQ(markers.markers()[0].scale().z(), 1.7);
  EXPECT_EQ(markers.markers()[1].text(), "Pedestrian 7");
  EXPECT_EQ(markers.markers()[2].points().size(), 31U);
  EXPECT_NEAR(markers.markers()[2].points()[30].y(), 6.5, 1e-9);
  EXPECT_EQ(markers.markers()[0].lifetime().nanosec(), 500'000'000U);
}

TEST_F(NodeTest, AnotherImplementationReadsHealthAndSeesTheNode) {
  const auto health = received<diagnostic_msgs::msg::dds_::DiagnosticArray_PubSubType>(
      "/diagnostics", "diagnostic_msgs/DiagnosticArray",
      diagnosticMessage(kTime, {{DiagnosticLine::kWarn, "input", "dark", {{"frames", "3"}}}}));
  ASSERT_EQ(health.status().size(), 1U);
  EXPECT_EQ(health.status()[0].level(), 1);
  EXPECT_EQ(health.status()[0].name(), "input");
  EXPECT_EQ(health.status()[0].values()[0].value(), "3");

  std::mutex mutex;
  std::vector<std::string> nodes;
  std::size_t publications = 0;
  const auto reader = peer_.reader<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>(
      "ros_discovery_info", {true, true, 1}, [&](const auto& info) {
        const std::lock_guard lock(mutex);
        nodes.clear();
        for (const auto& node : info.node_entities_info_seq()) {
          nodes.push_back(node.node_namespace().to_string() + node.node_name().to_string());
          publications = node.writer_gid_seq().size();
        }
      });
  EXPECT_TRUE(waitUntil([&] {
    const std::lock_guard lock(mutex);
    return !nodes.empty();
  }));
  EXPECT_THAT(nodes, ::testing::ElementsAre("/headway"));
  EXPECT_EQ(publications, 1U);
}

TEST_F(NodeTest, GidsHaveTheSizeOfTheOtherNodes) {
  std::string announcement("\0\1\0\0", 4);  // of a participant of Humble without nodes
  announcement.append(24, '\x01').append(4, '\0');
  const auto writer = peer_.bytesWriter(
      "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_", {true, true, 1});
  std::mutex mutex;
  std::string last;
  FastDdsPeer other(domain_);
  const auto reader =
      other.bytesReader("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
                        {true, true, 1}, [&](const std::string& message) {
                          const std::lock_guard lock(mutex);
                          if (message.find("headway") != std::string::npos) last = message;
                        });
  ASSERT_TRUE(writer->write(&announcement));
  // 4 bytes before the message, its gid, the number of nodes, the name space "/" and its padding.
  const auto offsetOfName = [&] {
    node_->spin(0.01);
    const std::lock_guard lock(mutex);
    return last.find("headway");
  };
  EXPECT_TRUE(waitUntil([&] { return offsetOfName() == 4 + 24 + 4 + 8 + 4; }));
}

TEST_F(NodeTest, ReadsWhatAnotherImplementationSends) {
  const auto writer = peer_.writer<sensor_msgs::msg::dds_::Image_PubSubType>("rt/camera/image_raw");
  const auto loose = peer_.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/imu", {false});
  std::vector<PublishedTopic> topics;
  ASSERT_TRUE(waitUntil([&] {
    node_->spin(0.01);
    topics = node_->published();
    return topics.size() == 2;
  }));
  EXPECT_EQ(topics[0].name, "/camera/image_raw");
  EXPECT_EQ(topics[0].type, "sensor_msgs/Image");
  EXPECT_TRUE(topics[0].is_reliable);
  EXPECT_FALSE(topics[0].is_transient_local);
  EXPECT_FALSE(topics[1].is_reliable);

  std::vector<std::string> received;
  node_->subscribe("/camera/image_raw", "sensor_msgs/Image", {},
                   [&](std::string_view message) { received.emplace_back(message); });
  sensor_msgs::msg::dds_::Image_ image;
  image.header().stamp().sec(12);
  image.header().frame_id("camera");
  image.height(720);
  image.width(1280);
  image.encoding("mono8");
  image.step(1280);
  image.data().assign(1280UL * 720UL, 7);
  ASSERT_TRUE(waitUntil([&] { return writer->matched() > 0; }));
  ASSERT_TRUE(writer->write(&image));
  ASSERT_TRUE(waitUntil([&] {
    node_->spin(0.01);
    return !received.empty();
  }));
  const auto decoded = bags::decodeImageMessage(received[0], bags::Encoding::kCdr);
  EXPECT_EQ(decoded.header.frame, "camera");
  EXPECT_EQ(decoded.header.time_ns, 12'000'000'000);
  EXPECT_EQ(decoded.data.size(), 1280UL * 720UL);
  EXPECT_EQ(decoded.data.back(), 7);
}

/// The other topic and the caller have their turn.
TEST_F(NodeTest, APublisherThatIsFasterThanItsMessagesAreUsedKeepsNobodyWaiting) {
  using std::chrono::milliseconds;
  const auto fast = peer_.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/a_imu");
  const auto slow = peer_.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/imu");
  std::size_t of_fast = 0, of_slow = 0;
  node_->subscribe("/a_imu", "sensor_msgs/Imu", {true, false, 100}, [&](std::string_view) {
    ++of_fast;
    std::this_thread::sleep_for(milliseconds(3));
  });
  node_->subscribe("/imu", "sensor_msgs/Imu", {}, [&](std::string_view) { ++of_slow; });
  ASSERT_TRUE(waitUntil([&] { return fast->matched() > 0 && slow->matched() > 0; }));
  std::atomic<bool> stops{false};
  std::thread publisher([&] {
    sensor_msgs::msg::dds_::Imu_ message;
    for (int i = 0; i < 5000 && !stops; ++i) {  // some seconds
      fast->write(&message);
      if (i % 10 == 0) slow->write(&message);
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  EXPECT_TRUE(waitUntil([&] {
    const std::size_t before = of_fast;
    node_->spin(0.01);
    EXPECT_LE(of_fast - before, 100U);
    return of_fast > 150 && of_slow > 0;
  }));
  stops = true;
  publisher.join();
}

TEST_F(NodeTest, ACallbackMayUnsubscribeWhichIsAnnounced) {
  const auto writer = peer_.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/imu");
  std::mutex mutex;
  std::size_t subscriptions = 0;
  const auto reader = peer_.reader<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>(
      "ros_discovery_info", {true, true, 1}, [&](const auto& info) {
        const std::lock_guard lock(mutex);
        for (const auto& node : info.node_entities_info_seq()) {
          subscriptions = node.reader_gid_seq().size();
        }
      });
  const auto isAnnounced = [&](std::size_t number) {
    return waitUntil([&] {
      const std::lock_guard lock(mutex);
      return subscriptions == number;
    });
  };
  std::size_t received = 0;
  const auto receive = [&, own = std::string(100, 'x')](std::string_view) {
    node_->unsubscribe("/imu");
    node_->unsubscribe("/scan");
    received += own.size();  // which lives as long as the callback runs
  };
  node_->subscribe("/imu", "sensor_msgs/Imu", {}, receive);
  node_->subscribe("/scan", "sensor_msgs/LaserScan", {}, receive);
  EXPECT_TRUE(isAnnounced(2));
  sensor_msgs::msg::dds_::Imu_ message;
  ASSERT_TRUE(waitUntil([&] {
    writer->write(&message);
    writer->write(&message);
    node_->spin(0.01);
    return received > 0;
  }));
  node_->spin(0.1);
  EXPECT_EQ(received, 100U);
  EXPECT_TRUE(isAnnounced(0));
}

/// By a setting of the user, too; what follows it is read.
TEST_F(NodeTest, AMessageOfMoreThan128MBIsNotPutTogether) {
  node_.reset();
  unsetenv("ROS_LOCALHOST_ONLY");
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
         "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto"
         "</ParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery><Internal>"
         "<MaxSampleSize>1 GB</MaxSampleSize></Internal></Domain></CycloneDDS>",
         1);
  node_.emplace(NodeOptions{"headway", domain_, ""});
  unsetenv("CYCLONEDDS_URI");
  std::vector<std::size_t> sizes;
  node_->subscribe("/cloud", "sensor_msgs/PointCloud2", {},
                   [&](std::string_view message) { sizes.push_back(message.size()); });
  const auto writer = peer_.bytesWriter("rt/cloud", "sensor_msgs::msg::dds_::PointCloud2_");
  const auto write = [&](std::size_t size) {
    std::string message("\0\1\0\0", 4);
    message.resize(size);
    return writer->write(&message);
  };
  ASSERT_TRUE(waitUntil([&] {  // until both know each other
    node_->spin(0.01);
    return write(100) && !sizes.empty();
  }));
  testing::internal::CaptureStderr();
  EXPECT_TRUE(write(std::size_t{bags::kMaxRecordBytes} + 1));
  EXPECT_TRUE(write(200));
  EXPECT_TRUE(waitUntil([&] {
    node_->spin(0.01);
    return sizes.back() == 200;
  }));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), ::testing::HasSubstr("oversize"));
  EXPECT_THAT(sizes, ::testing::Each(::testing::Le(200U)));
}

/// A hundred of them are kept.
TEST_F(NodeTest, OnlyImagesAndCloudsMayBeLarge) {
  for (const std::string type : {"Imu", "Image"}) {
    std::vector<std::size_t> sizes;
    node_->subscribe("/" + type, "sensor_msgs/" + type, {},
                     [&](std::string_view message) { sizes.push_back(message.size()); });
    const auto writer = peer_.bytesWriter("rt/" + type, "sensor_msgs::msg::dds_::" + type + "_");
    const auto write = [&](std::size_t size) {
      std::string message("\0\1\0\0", 4);
      message.resize(size);
      return writer->write(&message);
    };
    ASSERT_TRUE(waitUntil([&] {
      node_->spin(0.01);
      return write(1'000'000) && !sizes.empty();
    }));
    testing::internal::CaptureStderr();
    EXPECT_TRUE(write(2'000'000) && write(200));
    EXPECT_TRUE(waitUntil([&] {
      node_->spin(0.01);
      return sizes.back() == 200;
    }));
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::count(sizes.begin(), sizes.end(), 2'000'000), type == "Imu" ? 0 : 1) << text;
    EXPECT_EQ(text.find("/Imu") != std::string::npos, type == "Imu") << text;
  }
}

TEST_F(NodeTest, EachKindOfWarningIsNamedOnceAndCounted) {
  const auto warn = [](const char* text, int number) {
    dds_log(DDS_LC_WARNING, __FILE__, __LINE__, "", text, number);
  };
  testing::internal::CaptureStderr();
  for (int i = 0; i < 150; ++i) warn("broken packet %d\n", i);
  warn("large sample of %d\n", 7);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "Cyclone DDS: broken packet 0\n"
            "Cyclone DDS: so far 10 times: broken packet \n"
            "Cyclone DDS: so far 100 times: broken packet \n"
            "Cyclone DDS: large sample of 7\n");
}

TEST_F(NodeTest, AReliableSubscriptionDoesNotMatchALooserPublication) {
  const auto loose = peer_.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/imu", {false});
  node_->subscribe("/imu", "sensor_msgs/Imu", {}, [](std::string_view) {});
  EXPECT_TRUE(waitUntil([&] { return node_->mismatches("/imu") > 0; }));
}

/// As many as Nav2 has on a robot, on the loopback, where each has a port by its number.
TEST_F(NodeTest, ItIsOneOfManyOnARobot) {
  node_.reset();
  std::vector<std::unique_ptr<FastDdsPeer>> others;  // beside peer_
  for (int i = 0; i < 11; ++i) others.push_back(std::make_unique<FastDdsPeer>(domain_));
  node_.emplace(NodeOptions{"headway", domain_, ""});
  const auto scan = others.back()->writer<sensor_msgs::msg::dds_::LaserScan_PubSubType>("rt/scan");
  const auto imu = peer_.writer<sensor_msgs::msg::dds_::Imu_PubSubType>("rt/imu");
  EXPECT_TRUE(waitUntil([&] {
    node_->spin(0.01);
    return node_->published().size() == 2;
  }));
  EXPECT_NO_THROW(Node(NodeOptions{"headway", 232, "lo"}));  // whose ports are fewer
}

TEST_F(NodeTest, TheNodesOfAProgramShareADomain) {
  std::optional<Node> second(std::in_place, NodeOptions{"second", domain_, "lo"});
  EXPECT_THROW(Node(NodeOptions{"third", domain_, "127.0.0.1"}), InputError);
  node_.reset();  // the other one goes on
  const auto scan = peer_.writer<sensor_msgs::msg::dds_::LaserScan_PubSubType>("rt/scan");
  EXPECT_TRUE(waitUntil([&] {
    second->spin(0.01);
    return second->published().size() == 1;
  }));
  second.reset();
  EXPECT_NO_THROW(Node(NodeOptions{"third", domain_, "127.0.0.1"}));  // which nobody else has now
}

TEST_F(NodeTest, ASubscriberThatDoesNotReadBlocksNobody) {
  const Publication publication = node_->advertise("/dense", "sensor_msgs/PointCloud2", {});
  EXPECT_FALSE(publication.hasSubscribers());
  std::atomic<bool> blocks{true};
  const auto reader = peer_.reader<sensor_msgs::msg::dds_::PointCloud2_PubSubType>(
      "rt/dense", {}, [&](const auto&) {
        while (blocks) std::this_thread::sleep_for(std::chrono::milliseconds(10));
      });
  ASSERT_TRUE(waitUntil([&] { return publication.hasSubscribers(); }));
  const std::string message = cloudMessage(kHeader, std::vector<Eigen::Vector3f>(100000));
  for (int i = 0; i < 30; ++i) {
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(publication.publish(message));
    const auto duration = std::chrono::steady_clock::now() - start;
    EXPECT_LT(duration, std::chrono::milliseconds(500));  // most of it is the loopback's
  }
  EXPECT_FALSE(publication.isTaken(0.1));
  EXPECT_EQ(publication.topic(), "/dense");
  blocks = false;
  EXPECT_TRUE(publication.isTaken(60.0));
}

TEST_F(NodeTest, ALateSubscriberGetsTheLastMap) {
  const Publication map = node_->advertise("/map", "nav_msgs/OccupancyGrid", {true, true, 1});
  for (const std::uint32_t width : {2, 3}) {
    GridMessage grid;
    grid.cell_m = 0.1;
    grid.width = width;
    grid.height = 1;
    grid.cells.assign(width, 100);
    ASSERT_TRUE(map.publish(gridMessage(grid)));
  }
  std::mutex mutex;
  std::vector<std::uint32_t> widths;
  const auto reader = peer_.reader<nav_msgs::msg::dds_::OccupancyGrid_PubSubType>(
      "rt/map", {true, true, 1}, [&](const auto& message) {
        const std::lock_guard lock(mutex);
        widths.push_back(message.info().width());
      });
  EXPECT_TRUE(waitUntil([&] {
    const std::lock_guard lock(mutex);
    return !widths.empty();
  }));
  const std::lock_guard lock(mutex);
  EXPECT_THAT(widths, ::testing::ElementsAre(3));
}

TEST_F(NodeTest, TheFirstLineNamesTheCommandThatRaisesALowLimitOfSockets) {
  const bool is_low = test::hasSmallReceiveBuffers();
  long limit = 1 << 24;  // in a container the file may be missing
  std::ifstream("/proc/sys/net/core/rmem_max") >> limit;
  EXPECT_TRUE(is_low || limit >= 1 << 24) << limit;
  const auto command = node_->network().find("sudo sysctl -w net.core.rmem_max=");
  EXPECT_EQ(command != std::string::npos, is_low) << limit << ": " << node_->network();
  EXPECT_EQ(!node_->bufferHint().empty(), is_low);
}

constexpr char kLoopback[] =
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
    "</General></Domain></CycloneDDS>";

/// Its interfaces would be added to the one of the option.
TEST(NodeOptionsTest, CycloneDdsUriDoesNotWidenARestriction) {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"no_such_interface\"/>"
         "</Interfaces></General></Domain></CycloneDDS>",
         1);
  const int domain = test::domainOfThisTest();
  unsetenv("ROS_LOCALHOST_ONLY");
  EXPECT_ANY_THROW(Node(NodeOptions{"headway", domain, ""}));  // it is read
  EXPECT_THAT(Node(NodeOptions{"headway", domain, "lo"}).network(),
              ::testing::HasSubstr(" on lo (CYCLONEDDS_URI is not used)"));
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_THAT(Node(NodeOptions{"headway", domain, ""}).network(), ::testing::HasSubstr(" on lo ("));
  setenv("CYCLONEDDS_URI", kLoopback, 1);
  unsetenv("ROS_LOCALHOST_ONLY");
  EXPECT_THAT(Node(NodeOptions{"headway", domain, ""}).network(),
              ::testing::HasSubstr(" on the interfaces of CYCLONEDDS_URI"));
  unsetenv("CYCLONEDDS_URI");
}

TEST(NodeOptionsTest, TheRangeOfDiscoveryIsRespected) {
  unsetenv("ROS_LOCALHOST_ONLY");
  const int domain = test::domainOfThisTest();
  for (const char* range : {"LOCALHOST", "OFF", "unknown"}) {
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", range, 1);
    EXPECT_THAT(Node(NodeOptions{"headway", domain, ""}).network(), ::testing::HasSubstr(" on lo"))
        << range;
  }
  // Others leave the choice to Cyclone DDS, here by its own settings.
  setenv("CYCLONEDDS_URI", kLoopback, 1);
  for (const char* range : {"SUBNET", "SYSTEM_DEFAULT", ""}) {
    setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", range, 1);
    EXPECT_THAT(Node(NodeOptions{"headway", domain, ""}).network(),
                ::testing::HasSubstr(" on the interfaces of CYCLONEDDS_URI"))
        << range;
    setenv("ROS_LOCALHOST_ONLY", "1", 1);  // still means what it says
    EXPECT_THAT(Node(NodeOptions{"headway", domain, ""}).network(),
                ::testing::HasSubstr(" on lo (CYCLONEDDS_URI"))
        << range;
    unsetenv("ROS_LOCALHOST_ONLY");
  }
  unsetenv("CYCLONEDDS_URI");
  unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
}

TEST(NodeOptionsTest, AnInterfaceDoesNotWidenARestrictionToThisComputer) {
  const int domain = test::domainOfThisTest();
  const auto refusal = [&]() -> std::string {
    EXPECT_NO_THROW(Node(NodeOptions{"headway", domain, "lo"}));
    EXPECT_NO_THROW(Node(NodeOptions{"headway", domain, "127.0.0.1"}));
    try {
      const Node node({"headway", domain, "eth0"});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_EQ(refusal(), "--ros2-interface eth0: ROS_LOCALHOST_ONLY=1 allows this computer alone");
  unsetenv("ROS_LOCALHOST_ONLY");
  setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", 1);
  EXPECT_THAT(refusal(), ::testing::HasSubstr("ROS_AUTOMATIC_DISCOVERY_RANGE=OFF allows"));
  unsetenv("ROS_AUTOMATIC_DISCOVERY_RANGE");
}

/// By the system's own list: one of them that is up. Nothing is sent there.
TEST(NodeOptionsTest, TheNetworkNamesTheInterfaceThatIsSelected) {
  unsetenv("ROS_LOCALHOST_ONLY");
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><AllowMulticast>false</AllowMulticast></General></Domain>"
         "</CycloneDDS>",
         1);
  const std::string network = Node(NodeOptions{"headway", test::domainOfThisTest(), ""}).network();
  unsetenv("CYCLONEDDS_URI");
  std::vector<std::string> names;
  ifaddrs* interfaces = nullptr;
  ASSERT_EQ(getifaddrs(&interfaces), 0);
  for (const auto* it = interfaces; it != nullptr; it = it->ifa_next) {
    if ((it->ifa_flags & IFF_UP) != 0) names.emplace_back(it->ifa_name);
  }
  freeifaddrs(interfaces);
  EXPECT_TRUE(std::any_of(names.begin(), names.end(), [&](const auto& name) {
    return network.find(" on " + name + ", which Cyclone DDS selects") != std::string::npos;
  })) << network;
}

TEST(NodeOptionsTest, WrongDomainsAndInterfacesAreInputErrors) {
  unsetenv("ROS_LOCALHOST_ONLY");
  setenv("ROS_DOMAIN_ID", "233", 1);
  EXPECT_ANY_THROW(Node(NodeOptions{}));
  setenv("ROS_DOMAIN_ID", "x", 1);
  EXPECT_ANY_THROW(Node(NodeOptions{}));
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_ANY_THROW(Node(NodeOptions{"headway", test::domainOfThisTest(), "no_such_interface"}));
  EXPECT_ANY_THROW(Node(NodeOptions{"headway", test::domainOfThisTest(), "x\"/><evil"}));
}

}  // namespace
}  // namespace headway::ros2
