// SPDX-License-Identifier: BSD-3-Clause
// A stereo camera of another implementation of DDS.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>

#include "fast_dds_peer.h"

namespace headway::test {

/// A stereo camera whose calibration and mounting are sent when a test wants it.
class StereoWriters {
 public:
  explicit StereoWriters(FastDdsPeer& peer)
      : images_{peer.writer<sensor_msgs::msg::dds_::Image_PubSubType>("rt/left/image"),
                peer.writer<sensor_msgs::msg::dds_::Image_PubSubType>("rt/right/image")},
        infos_{peer.writer<sensor_msgs::msg::dds_::CameraInfo_PubSubType>("rt/left/camera_info"),
               peer.writer<sensor_msgs::msg::dds_::CameraInfo_PubSubType>("rt/right/camera_info")},
        tf_(peer.writer<tf2_msgs::msg::dds_::TFMessage_PubSubType>("rt/tf_static",
                                                                   {true, true, 1})) {
    info.width(64);
    info.height(48);
    info.distortion_model("plumb_bob");
    info.d().assign(5, 0.0);
    picture_.width(64);
    picture_.height(48);
    picture_.step(64);
    picture_.encoding("mono8");
    picture_.data().assign(64UL * 48UL, 100);
    picture_.header().stamp().sec(100);
  }

  void setFocal(double focal_px) {
    info.k({focal_px, 0.0, 31.5, 0.0, focal_px, 23.5, 0.0, 0.0, 1.0});
    info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
    info.p({focal_px, 0.0, 31.5, 0.0, 0.0, focal_px, 23.5, 0.0, 0.0, 0.0, 1.0, 0.0});
  }
  /// Sends calibration and images of the next time.
  void write(double baseline_m) {
    picture_.header().stamp().sec(picture_.header().stamp().sec() + 1);
    const std::array<const char*, 2> frames = {"left", "right"};
    for (const std::size_t side : {0, 1}) {
      info.header().frame_id(frames.at(side));
      info.p()[3] = side == 0 ? 0.0 : -baseline_m * info.p()[0];
      picture_.header().frame_id(frames.at(side));
      EXPECT_TRUE(infos_.at(side)->write(&info) && images_.at(side)->write(&picture_));
    }
  }
  /// Both cameras on a frame of the robot, and if it drives, where odometry has that.
  void mount(const std::string& base = "base_link", bool drives = false) {
    tf2_msgs::msg::dds_::TFMessage_ message;
    message.transforms().resize(drives ? 3 : 2);
    if (drives) {
      auto& odometry = message.transforms()[2];
      odometry.header().stamp().sec(100);
      odometry.header().frame_id("odom");
      odometry.child_frame_id(base);
      odometry.transform().translation().x(5.0);
      odometry.transform().rotation().w(1.0);
    }
    const std::array<const char*, 2> frames = {"left", "right"};
    for (const std::size_t side : {0, 1}) {
      auto& transform = message.transforms()[side];
      transform.header().frame_id(base);
      transform.child_frame_id(frames.at(side));
      transform.transform().translation().x(0.25);
      transform.transform().rotation().w(1.0);
    }
    EXPECT_TRUE(tf_->write(&message));
  }

  sensor_msgs::msg::dds_::CameraInfo_ info;

 private:
  using Writer = std::unique_ptr<FastDdsPeer::Writer>;
  std::array<Writer, 2> images_, infos_;
  Writer tf_;
  sensor_msgs::msg::dds_::Image_ picture_;
};

}  // namespace headway::test
