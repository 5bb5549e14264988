// SPDX-License-Identifier: BSD-3-Clause
// Results of a session as topics of ROS 2.
#pragma once

#include <headway/ros2/node.h>
#include <headway/ros2/ros2_params.h>
#include <headway/run/session.h>
#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace headway::ros2 {

/// One line of /diagnostics.
struct DiagnosticLine {
  enum Level : std::uint8_t { kOk, kWarn, kError, kStale };
  Level level = kOk;
  std::string name;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

/// Publishes poses, maps, obstacles, tracks and health; doc/ros2.md lists the topics.
///
/// Transforms and odometry are sent by the session's thread at once, everything else by threads of
/// the sink: what is due while they are still at work is left out, so that the session never waits.
/// Poses, obstacles and the local costmap do not wait for the frame's objects. Nothing is made for
/// a topic without subscribers. /diagnostics names the topics of subscribers that have not taken a
/// message within a second, and goes on while there are no frames.
///
///     TopicSink sink(node, params);
///     session.add(sink);
class TopicSink : public run::Sink {
 public:
  /// What the sink asks for, by any thread, until it is destroyed; each may be empty.
  struct Hooks {
    /// T_odom_robot that others publish, see TopicSource::odometryAt().
    std::function<std::optional<Pose>(Time)> others_odometry;
    std::function<std::string()> robot_frame;  ///< TopicSource::robotFrame(); empty: base_link
    std::function<std::vector<DiagnosticLine>()> sensors;  ///< health of them
  };

  /// @param node  must outlive this
  TopicSink(Node& node, const Ros2SinkParams& params, Hooks hooks = {});
  ~TopicSink() override;

  void onLocal(Time time, const slam::SlamUpdate& camera, const map::PerceptionMap& map) override;
  void onFrame(const run::FrameResult& result, pipeline::Perception& perception) override;

  /// An observation that the session gets, too: wheels and gyroscopes move the odometry on between
  /// frames, and all move the clock. By any thread.
  void addObservation(const mrpt::obs::CObservation& observation);

  /// Messages that were made, by topic. By any thread.
  [[nodiscard]] std::map<std::string, std::size_t> messages() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::ros2
