// SPDX-License-Identifier: BSD-3-Clause
// The part of a live run that is connected to ROS 2.
#include "ros2_connection.h"

#include <headway/core/error.h>
#include <headway/program/files.h>

#include <mutex>
#include <utility>

#if HEADWAY_HAS_ROS2
#include <headway/ros2/topic_sink.h>
#include <headway/ros2/topic_source.h>
#endif

namespace headway::live {

bool Ros2Options::isUsed() const {
  return file || !left.empty() || !right.empty() || !color.empty() || !depth.empty();
}

#if HEADWAY_HAS_ROS2

namespace {

/// All that the .ini of `--ros2` sets.
struct Ros2Params {
  ros2::NodeOptions node;
  ros2::Ros2SourceParams source;
  ros2::Ros2SinkParams sink;

  void describe(Params& params) {
    auto section = params.section("ros2").user();
    section.add("name", node.name, "Name of the node");
    section.add("domain", node.domain, -1, 232, "", "DDS domain; -1: ROS_DOMAIN_ID, or 0");
    section.add("interface", node.interface, "Network interface; empty: as ROS 2");
    source.describe(params.section("ros2"));
    sink.describe(params.section("ros2_publish"));
  }
};

Ros2Params paramsOf(const Ros2Options& options) {
  Ros2Params result;
  Params params;
  result.describe(params);
  if (options.file && !options.file->empty()) params.loadFile(program::findDataFile(*options.file));
  const auto replace = [](const std::string& by, std::string& value) {
    if (!by.empty()) value = by;
  };
  replace(options.interface, result.node.interface);
  replace(options.left, result.source.left);
  replace(options.right, result.source.right);
  replace(options.color, result.source.color);
  replace(options.depth, result.source.depth);
  return result;
}

/// Topics that are not named are not used, because there are other sensors.
ros2::Ros2SourceParams namedOnly(ros2::Ros2SourceParams params) {
  for (std::string* topic : {&params.left, &params.right, &params.color, &params.depth, &params.imu,
                             &params.odometry, &params.scan, &params.gnss}) {
    if (topic->empty()) *topic = "none";
  }
  return params;
}

}  // namespace

class Ros2Connection::Implementation {
 public:
  Implementation(const Ros2Params& params, bool has_sensors, const std::string& calibration,
                 double pair_tolerance_s, Callbacks callbacks)
      : callbacks_(std::move(callbacks)),
        odom_frame_(params.sink.odom_frame),
        node_(params.node),
        source_(node_, has_sensors ? namedOnly(params.source) : params.source,
                {calibration, pair_tolerance_s, params.sink.odom_frame, params.sink.map_frame},
                {callbacks_.observation, callbacks_.message,
                 [this](const Pose& T_map_robot) { setInitialPose(T_map_robot); }}),
        sink_(node_, params.sink,
              {[this](Time time) { return othersOdometry(time); },
               [this] { return source_.robotFrame(); }, [this] { return diagnostics(); }}) {}

  ~Implementation() { stop(); }

  void start() {
    source_.start();
    const std::lock_guard lock(mutex_);
    is_running_ = true;
  }

  void stop() {
    source_.stop();
    const std::lock_guard lock(mutex_);
    is_running_ = false;
    perception_ = nullptr;
  }

  void setPerception(pipeline::Perception& perception) {
    const std::lock_guard lock(mutex_);
    perception_ = &perception;
    if (initial_pose_) perception.setInitialPose(*initial_pose_);
  }

  [[nodiscard]] std::vector<drivers::SensorStatus> sensors() const {
    const double silent_s = drivers::SensorGroupOptions().max_silence_s;
    std::vector<drivers::SensorStatus> result;
    for (const auto& topic : source_.status()) {
      const bool is_state = topic.use == "mounting" || topic.use == "calibration" ||
                            topic.use == "initial pose";  // which need not come at all, nor again
      const bool is_awaited = topic.messages == 0 && (is_state || topic.age_s < silent_s);
      if (topic.use.empty() || is_awaited) continue;
      drivers::SensorStatus status;
      status.name = topic.topic;
      status.is_running = is_state || topic.age_s < silent_s;
      status.observations = topic.messages;
      if (!status.is_running) status.error = "no message for 5 s";
      result.push_back(status);
    }
    return result;
  }

  [[nodiscard]] ros2::Node& node() { return node_; }
  [[nodiscard]] ros2::TopicSource& source() { return source_; }
  [[nodiscard]] ros2::TopicSink& sink() { return sink_; }

 private:
  void setInitialPose(const Pose& T_map_robot) {
    const std::lock_guard lock(mutex_);
    initial_pose_ = T_map_robot;
    if (perception_ != nullptr) perception_->setInitialPose(T_map_robot);
  }

  /// By the session's thread.
  [[nodiscard]] std::optional<Pose> othersOdometry(Time time) {
    const auto pose = source_.odometryAt(time);
    const double now_s = monotonicSeconds();
    if (!first_frame_s_) first_frame_s_ = now_s;
    if (pose) is_odometry_known_ = true;
    if (!is_odometry_known_ &&
        now_s - *first_frame_s_ > drivers::SensorGroupOptions().max_silence_s) {
      is_odometry_known_ = true;
      const std::string robot = source_.robotFrame();
      callbacks_.message("ROS 2: no other node publishes " + odom_frame_ + " -> " + robot + ": " +
                         robot +
                         " has no place in the map, unless odom_base = true in [ros2_publish]");
    }
    return pose;
  }

  [[nodiscard]] std::vector<ros2::DiagnosticLine> diagnostics() {
    std::vector<ros2::DiagnosticLine> lines;
    const std::lock_guard lock(mutex_);
    if (!is_running_) return lines;
    for (const auto& sensor : callbacks_.sensors()) {
      using Line = ros2::DiagnosticLine;
      lines.push_back({sensor.is_running ? Line::kOk : Line::kError,
                       "headway: sensor " + sensor.name,
                       sensor.is_running ? "running" : sensor.error,
                       {{"observations", std::to_string(sensor.observations)},
                        {"restarts", std::to_string(sensor.restarts)}}});
    }
    return lines;
  }

  const Callbacks callbacks_;
  const std::string odom_frame_;
  std::optional<double> first_frame_s_;
  bool is_odometry_known_ = false;  ///< it is published, or that it is not was said
  std::mutex mutex_;
  bool is_running_ = false;                     // guarded by mutex_; may the callbacks be used?
  std::optional<Pose> initial_pose_;            // guarded by mutex_
  pipeline::Perception* perception_ = nullptr;  // guarded by mutex_
  ros2::Node node_;
  ros2::TopicSource source_;
  ros2::TopicSink sink_;
};

void describe(Ros2Options& options, program::CommandLine& line) {
  line.option(options.file, 0, "ros2", "[FILE.ini]",
              "Subscribe to sensors of ROS 2 and publish the results; topics are guessed, unless "
              "the file names them");
  line.option(options.left, 0, "left", "TOPIC", "ROS 2 topic of the left camera's images");
  line.option(options.right, 0, "right", "TOPIC", "ROS 2 topic of the right camera's images");
  line.option(options.color, 0, "color", "TOPIC", "ROS 2 topic of a depth camera's colour images");
  line.option(options.depth, 0, "depth", "TOPIC", "ROS 2 topic of its depth images");
  line.option(options.interface, 0, "ros2-interface", "NAME",
              "Only network interface to use for ROS 2, by name or address");
  line.flag(options.list, 0, "ros2-list", "Print the topics of ROS 2 and their use, and end");
}

std::string listOfTopics(const Ros2Options& options) {
  const Ros2Params params = paramsOf(options);
  ros2::Node node(params.node);
  return ros2::listOfTopics(node, params.source);
}

Ros2Connection::Ros2Connection(const Ros2Options& options, bool has_sensors,
                               const std::string& calibration, double pair_tolerance_s,
                               Callbacks callbacks)
    : implementation_(std::make_unique<Implementation>(paramsOf(options), has_sensors, calibration,
                                                       pair_tolerance_s, std::move(callbacks))) {}

std::string Ros2Connection::network() const { return implementation_->node().network(); }
std::string Ros2Connection::bufferHint() const { return implementation_->node().bufferHint(); }
void Ros2Connection::start() { implementation_->start(); }
void Ros2Connection::stop() { implementation_->stop(); }
run::Sink& Ros2Connection::sink() { return implementation_->sink(); }
void Ros2Connection::setPerception(pipeline::Perception& perception) {
  implementation_->setPerception(perception);
}
void Ros2Connection::addObservation(const mrpt::obs::CObservation& observation) {
  implementation_->sink().addObservation(observation);
}
std::vector<drivers::SensorStatus> Ros2Connection::sensors() const {
  return implementation_->sensors();
}
std::map<std::string, std::size_t> Ros2Connection::skipped() const {
  return implementation_->source().skipped();
}
std::string Ros2Connection::missing() const { return implementation_->source().missing(); }

#else  // There are no options, so that nothing of the following is called.

class Ros2Connection::Implementation {};

void describe(Ros2Options& /*options*/, program::CommandLine& /*line*/) {}
std::string listOfTopics(const Ros2Options& /*options*/) { return ""; }
Ros2Connection::Ros2Connection(const Ros2Options& /*options*/, bool /*has_sensors*/,
                               const std::string& /*calibration*/, double /*pair_tolerance_s*/,
                               Callbacks /*callbacks*/) {
  throw InputError("this build has no ROS 2: build it with Cyclone DDS (cyclonedds-dev)");
}
std::string Ros2Connection::network() const { return ""; }
std::string Ros2Connection::bufferHint() const { return ""; }
void Ros2Connection::start() {}
void Ros2Connection::stop() {}
run::Sink& Ros2Connection::sink() { throw std::logic_error("no ROS 2"); }
void Ros2Connection::setPerception(pipeline::Perception& /*perception*/) {}
void Ros2Connection::addObservation(const mrpt::obs::CObservation& /*observation*/) {}
std::vector<drivers::SensorStatus> Ros2Connection::sensors() const { return {}; }
std::map<std::string, std::size_t> Ros2Connection::skipped() const { return {}; }
std::string Ros2Connection::missing() const { return ""; }

#endif

Ros2Connection::~Ros2Connection() = default;

}  // namespace headway::live
