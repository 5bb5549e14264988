// SPDX-License-Identifier: BSD-3-Clause
// A robot that plays a rawlog as its sensors, by another implementation of DDS.
#include "robot.h"

#include <headway/core/mrpt_pose.h>
#include <headway/core/recorded_frame.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway_test/waiting.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <thread>

namespace headway::test {
namespace {

using namespace mrpt::obs;
using CameraInfo = sensor_msgs::msg::dds_::CameraInfo_;
using Transform = geometry_msgs::msg::dds_::TransformStamped_;

template <typename Header>
void setHeader(Time time, const std::string& frame, Header& header) {
  const auto ns = static_cast<std::int64_t>(std::llround(time * 1e9));
  header.stamp().sec(static_cast<std::int32_t>(ns / 1'000'000'000));
  header.stamp().nanosec(static_cast<std::uint32_t>(ns % 1'000'000'000));
  header.frame_id(frame);
}

CameraInfo infoOf(const mrpt::img::TCamera& camera, double baseline_m) {
  CameraInfo info;
  info.width(camera.ncols);
  info.height(camera.nrows);
  info.distortion_model("plumb_bob");
  for (const std::size_t i : {0, 1, 2, 3, 4}) info.d().push_back(camera.dist[i]);
  info.k({camera.fx(), 0.0, camera.cx(), 0.0, camera.fy(), camera.cy(), 0.0, 0.0, 1.0});
  info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p({camera.fx(), 0.0, camera.cx(), -baseline_m * camera.fx(), 0.0, camera.fy(), camera.cy(),
          0.0, 0.0, 0.0, 1.0, 0.0});
  return info;
}

Transform transformOf(Time time, const std::string& parent, const std::string& child,
                      const Pose& pose) {
  Transform transform;
  setHeader(time, parent, transform.header());
  transform.child_frame_id(child);
  auto& place = transform.transform().translation();
  place.x(pose.translation().x());
  place.y(pose.translation().y());
  place.z(pose.translation().z());
  const Eigen::Quaterniond q = quaternionOf(pose);
  auto& rotation = transform.transform().rotation();
  rotation.x(q.x());
  rotation.y(q.y());
  rotation.z(q.z());
  rotation.w(q.w());
  return transform;
}

}  // namespace

class Robot::Implementation {
 public:
  Implementation(Robot& robot, FastDdsPeer& peer, std::string rawlog, bool is_compressed,
                 double shift_s, bool is_reliable)
      : robot_(robot),
        peer_(peer),
        rawlog_(std::move(rawlog)),
        is_compressed_(is_compressed),
        shift_s_(shift_s) {
    io::registerClasses();
    mrpt::img::CImage::setImagesPathBase(rawlog_.substr(0, rawlog_.rfind('.')) + "_Images");
    using namespace sensor_msgs::msg::dds_;
    using tf2_msgs::msg::dds_::TFMessage_PubSubType;
    writers_["/tf"] = peer_.writer<TFMessage_PubSubType>("rt/tf", {true, false, 100});
    writers_["/tf_static"] = peer_.writer<TFMessage_PubSubType>("rt/tf_static", {true, true, 1});
    const auto open = [&](auto type, const std::string& topic, int depth = 10) {
      writers_[topic] = peer_.writer<decltype(type)>("rt" + topic, {is_reliable, false, depth});
    };
    std::size_t count = 0;
    forEach([&](const CObservation& observation) {
      if (dynamic_cast<const CObservationStereoImages*>(&observation) &&
          !has("/left/camera_info")) {
        open(CameraInfo_PubSubType(), "/left/camera_info");
        open(CameraInfo_PubSubType(), "/right/camera_info");
        if (is_compressed_) {
          open(CompressedImage_PubSubType(), "/left/image/compressed");
          open(CompressedImage_PubSubType(), "/right/image/compressed");
        } else {
          open(Image_PubSubType(), "/left/image");
          open(Image_PubSubType(), "/right/image");
        }
      } else if (dynamic_cast<const CObservation3DRangeScan*>(&observation) &&
                 !has("/color/camera_info")) {
        open(CameraInfo_PubSubType(), "/color/camera_info");
        open(CameraInfo_PubSubType(), "/depth/camera_info");
        if (is_compressed_) {
          open(CompressedImage_PubSubType(), "/color/image/compressed");
          open(CompressedImage_PubSubType(), "/depth/image/compressedDepth");
        } else {
          open(Image_PubSubType(), "/color/image");
          open(Image_PubSubType(), "/depth/image");
        }
      } else if (dynamic_cast<const CObservationIMU*>(&observation) && !has("/imu")) {
        open(Imu_PubSubType(), "/imu", 100);
      } else if (dynamic_cast<const CObservationOdometry*>(&observation) && !has("/odom")) {
        open(nav_msgs::msg::dds_::Odometry_PubSubType(), "/odom", 100);
      } else if (dynamic_cast<const CObservation2DRangeScan*>(&observation) && !has("/scan")) {
        open(LaserScan_PubSubType(), "/scan");
      } else if (dynamic_cast<const CObservationGPS*>(&observation) && !has("/fix")) {
        open(NavSatFix_PubSubType(), "/fix");
      }
      return ++count < 200;  // each sensor occurs in the beginning
    });
  }

  [[nodiscard]] bool isWatched() const {
    std::size_t watched = 0;
    for (const auto& [topic, writer] : writers_) {
      if (topic.find("image") != std::string::npos && writer->matched() > 0) ++watched;
    }
    return watched >= 2;
  }

  std::size_t play(double factor, const std::atomic<bool>& stop, const Part& part) {
    std::optional<Time> first;
    double start_s = 0.0;
    std::size_t frame = 0, sent = 0;
    forEach([&](const CObservation& observation) {
      const bool is_frame = isFrame(observation);
      if (is_frame && frame == part.end) return false;
      if (is_frame) ++frame;
      if (part.first > 0 && frame <= part.first) return !stop;
      const Time recorded = io::timeFrom(observation.timestamp);
      if (!first) start_s = monotonicSeconds();
      if (!first) first = recorded;
      while (!stop && monotonicSeconds() - start_s < (recorded - *first) / factor) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      send(observation, recorded + shift_s_ + part.shift_s);
      if (is_frame) ++sent;
      return !stop;
    });
    return sent;
  }

  std::map<std::string, std::size_t> sent;

 private:
  [[nodiscard]] bool has(const std::string& topic) const { return writers_.count(topic) > 0; }

  template <typename Use>
  void forEach(const Use& use) {
    mrpt::io::CFileGZInputStream file(rawlog_);
    auto archive = mrpt::serialization::archiveFrom(file);
    try {
      while (true) {
        const auto observation = std::dynamic_pointer_cast<CObservation>(archive.ReadObject());
        if (observation != nullptr && !use(*observation)) return;
      }
    } catch (const std::exception&) {  // the end of the file
    }
  }

  template <typename Sample>
  void write(const std::string& topic, Sample& sample) {
    if (has(topic) && writers_[topic]->write(&sample)) ++sent[topic];
  }

  /// Mounts a frame once.
  void mount(Time time, const std::string& frame, const Pose& T_robot_sensor) {
    if (!mounted_.insert(frame).second) return;
    transforms_.transforms().push_back(transformOf(time, "base_link", frame, T_robot_sensor));
    write("/tf_static", transforms_);
  }

  static bool isFrame(const CObservation& observation) {
    return dynamic_cast<const CObservationStereoImages*>(&observation) != nullptr ||
           dynamic_cast<const CObservation3DRangeScan*>(&observation) != nullptr;
  }

  void send(const CObservation& observation, Time time) {
    if (const auto* stereo = dynamic_cast<const CObservationStereoImages*>(&observation)) {
      sendStereo(*stereo, time);
    }
    if (const auto* depth = dynamic_cast<const CObservation3DRangeScan*>(&observation)) {
      sendDepth(*depth, time);
    }
    if (const auto* imu = dynamic_cast<const CObservationIMU*>(&observation)) sendImu(*imu, time);
    if (const auto* wheels = dynamic_cast<const CObservationOdometry*>(&observation)) {
      sendOdometry(*wheels, time);
    }
    if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation)) {
      sendScan(*scan, time);
    }
    if (const auto* fix = dynamic_cast<const CObservationGPS*>(&observation)) sendFix(*fix, time);
  }

  void sendImage(const std::string& camera, const cv::Mat& image, Time time) {
    const std::string topic = camera + "/image";
    if (is_compressed_ && has(topic + "/compressed")) {
      sensor_msgs::msg::dds_::CompressedImage_ message;
      setHeader(time, camera.substr(1), message.header());
      message.format("jpeg");
      cv::imencode(".jpg", image, message.data());
      return write(topic + "/compressed", message);
    }
    if (is_compressed_) {
      sensor_msgs::msg::dds_::CompressedImage_ message;
      setHeader(time, camera.substr(1), message.header());
      message.format("16UC1; compressedDepth png");
      std::vector<std::uint8_t> png;
      cv::imencode(".png", image, png);
      message.data().assign(12, 0);  // which inverse depth needs
      message.data().insert(message.data().end(), png.begin(), png.end());
      return write(topic + "/compressedDepth", message);
    }
    sensor_msgs::msg::dds_::Image_ message;
    setHeader(time, camera.substr(1), message.header());
    message.height(static_cast<std::uint32_t>(image.rows));
    message.width(static_cast<std::uint32_t>(image.cols));
    message.encoding(image.type() == CV_16UC1 ? "16UC1" : image.channels() == 1 ? "mono8" : "bgr8");
    message.step(static_cast<std::uint32_t>(image.cols * image.elemSize()));
    for (int row = 0; row < image.rows; ++row) {
      const auto* bytes = image.ptr(row);
      message.data().insert(message.data().end(), bytes, bytes + message.step());
    }
    write(topic, message);
  }

  void sendInfo(const std::string& camera, CameraInfo info, Time time) {
    setHeader(time, camera.substr(1), info.header());
    write(camera + "/camera_info", info);
  }

  void sendStereo(const CObservationStereoImages& pair, Time time) {
    mount(time, "left", fromMrpt(mrpt::poses::CPose3D(pair.cameraPose)));
    mount(time, "right",
          fromMrpt(mrpt::poses::CPose3D(pair.cameraPose)) *
              fromMrpt(mrpt::poses::CPose3D(pair.rightCameraPose)));
    sendInfo("/left", infoOf(pair.leftCamera, 0.0), time);
    sendInfo("/right", infoOf(pair.rightCamera, pair.rightCameraPose.x()), time);
    if (robot_.before_frame) robot_.before_frame(time);
    sendImage("/left", pair.imageLeft.asCvMatRef(), time);
    sendImage("/right", pair.imageRight.asCvMatRef(), time);
    if (robot_.on_frame) robot_.on_frame(time);
  }

  void sendDepth(const CObservation3DRangeScan& scan, Time time) {
    const Pose T_robot_depth =
        fromMrpt(scan.sensorPose) * robotFromOptical();  // the observation's is x forward
    const Pose T_depth_color =
        robotFromOptical().inverse() * fromMrpt(scan.relativePoseIntensityWRTDepth);
    mount(time, "depth", T_robot_depth);
    mount(time, "color", T_robot_depth * T_depth_color);
    sendInfo("/color", infoOf(scan.cameraParamsIntensity, 0.0), time);
    sendInfo("/depth", infoOf(scan.cameraParams, 0.0), time);
    cv::Mat depth;
    cv::Mat(static_cast<int>(scan.rangeImage.rows()), static_cast<int>(scan.rangeImage.cols()),
            CV_16UC1, const_cast<std::uint16_t*>(scan.rangeImage.data()))
        .convertTo(depth, CV_16U, 1e3 * scan.rangeUnits);
    if (robot_.before_frame) robot_.before_frame(time);
    sendImage("/color", scan.intensityImage.asCvMatRef(), time);
    sendImage("/depth", depth, time);
    if (robot_.on_frame) robot_.on_frame(time);
  }

  void sendImu(const CObservationIMU& imu, Time time) {
    mount(time, "imu", fromMrpt(imu.sensorPose));
    sensor_msgs::msg::dds_::Imu_ message;
    setHeader(time, "imu", message.header());
    message.orientation().w(1.0);
    auto& rate = message.angular_velocity();
    auto& force = message.linear_acceleration();
    if (imu.has(IMU_WX)) {
      rate.x(imu.get(IMU_WX));
      rate.y(imu.get(IMU_WY));
      rate.z(imu.get(IMU_WZ));
    }
    if (imu.has(IMU_X_ACC)) {
      force.x(imu.get(IMU_X_ACC));
      force.y(imu.get(IMU_Y_ACC));
      force.z(imu.get(IMU_Z_ACC));
    }
    write("/imu", message);
  }

  void sendOdometry(const CObservationOdometry& wheels, Time time) {
    const Pose pose = fromMrpt(mrpt::poses::CPose3D(wheels.odometry));
    tf2_msgs::msg::dds_::TFMessage_ transforms;
    transforms.transforms().push_back(transformOf(time, "odom", "base_link", pose));
    write("/tf", transforms);
    nav_msgs::msg::dds_::Odometry_ message;
    setHeader(time, "odom", message.header());
    message.child_frame_id("base_link");
    auto& place = message.pose().pose();
    place.position().x(pose.translation().x());
    place.position().y(pose.translation().y());
    const Eigen::Quaterniond q = quaternionOf(pose);
    place.orientation().z(q.z());
    place.orientation().w(q.w());
    write("/odom", message);
  }

  void sendScan(const CObservation2DRangeScan& scan, Time time) {
    mount(time, "laser", fromMrpt(scan.sensorPose));
    sensor_msgs::msg::dds_::LaserScan_ message;
    setHeader(time, "laser", message.header());
    const auto beams = scan.getScanSize();
    const float step = scan.aperture / static_cast<float>(beams - 1);
    message.angle_min(-0.5F * scan.aperture);
    message.angle_max(0.5F * scan.aperture);
    message.angle_increment(step);
    message.range_min(0.05F);
    message.range_max(scan.maxRange);
    for (std::size_t i = 0; i < beams; ++i) {
      message.ranges().push_back(scan.getScanRangeValidity(i) ? scan.getScanRange(i) : 0.0F);
    }
    write("/scan", message);
  }

  void sendFix(const CObservationGPS& observation, Time time) {
    mount(time, "gnss", fromMrpt(observation.sensorPose));
    const auto& position = observation.getMsgByClass<gnss::Message_NMEA_GGA>().fields;
    sensor_msgs::msg::dds_::NavSatFix_ message;
    setHeader(time, "gnss", message.header());
    message.status().status(0);
    message.latitude(position.latitude_degrees);
    message.longitude(position.longitude_degrees);
    message.altitude(position.altitude_meters);
    write("/fix", message);
  }

  Robot& robot_;
  FastDdsPeer& peer_;
  std::string rawlog_;
  bool is_compressed_;
  double shift_s_;
  std::map<std::string, std::unique_ptr<FastDdsPeer::Writer>> writers_;
  std::set<std::string> mounted_;
  tf2_msgs::msg::dds_::TFMessage_ transforms_;  ///< static ones
};

Robot::Robot(FastDdsPeer& peer, std::string rawlog, bool is_compressed, double shift_s,
             bool is_reliable)
    : implementation_(std::make_unique<Implementation>(*this, peer, std::move(rawlog),
                                                       is_compressed, shift_s, is_reliable)) {}

Robot::~Robot() = default;

bool Robot::isWatched() const { return implementation_->isWatched(); }

std::size_t Robot::play(double factor, const std::atomic<bool>& stop, const Part& part) {
  return implementation_->play(factor, stop, part);
}

const std::map<std::string, std::size_t>& Robot::sent() const { return implementation_->sent; }

Results::Results(FastDdsPeer& peer)
    : odometry_(peer.reader<nav_msgs::msg::dds_::Odometry_PubSubType>(
          "rt/headway/odometry", {true, false, 1000}, [this](const auto& message) {
            const auto& stamp = message.header().stamp();
            const std::lock_guard lock(mutex_);
            stamps_.insert(keyOf(stamp.sec() + 1e-9 * stamp.nanosec()));
          })) {}

std::set<long> Results::stamps() const {
  const std::lock_guard lock(mutex_);
  return stamps_;
}

void Results::await(Time time) const {
  for (int poll = 0; stamps().empty(); ++poll) {
    if (poll == 50) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  (void)waitUntil([&] { return stamps().count(keyOf(time)) > 0; });
}

}  // namespace headway::test
