// SPDX-License-Identifier: BSD-3-Clause
// Results of a session as topics of ROS 2.
#include <headway/core/mrpt_pose.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/text.h>
#include <headway/core/worker_thread.h>
#include <headway/io/mrpt_time.h>
#include <headway/map/map_query.h>
#include <headway/ros2/topic_sink.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <future>
#include <map>
#include <mutex>
#include <thread>

#include "outgoing_messages.h"
#include "predicted_grid.h"

namespace headway::ros2 {
namespace {

constexpr char kLocalisation[] = "headway: localisation";
constexpr char kOwnOdometry[] = "headway_odom";  // frame, where the robot has its own odometry

/// The newest frame's odometry, moved on by wheels, and beyond them by the gyroscope at constant
/// speed.
class MotionBridge {
 public:
  static constexpr double kMaxBridge_s = 1.0;  // without images: then the odometry stands still

  void setFrame(const OdometrySample& frame) {
    if (frame_ && frame.time > frame_->time) {
      const double dt = frame.time - frame_->time;
      const Pose step = frame_->T_odom_robot.inverse(Eigen::Isometry) * frame.T_odom_robot;
      velocity_ = step.translation() / dt;
      angular_velocity_ = logSo3(step.linear()) / dt;
    }
    frame_ = frame;
  }

  /// Whether the sample moves the odometry on.
  bool add(const mrpt::obs::CObservation& observation) {
    const Time time = io::timeFrom(observation.timestamp);
    if (const auto* wheels = dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation)) {
      Pose pose = Pose::Identity();
      pose.translation().head<2>() << wheels->odometry.x(), wheels->odometry.y();
      pose.linear() =
          Eigen::AngleAxisd(wheels->odometry.phi(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      keep(wheels_, {time, pose});
      return true;
    }
    const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation);
    if (imu == nullptr || !imu->has(mrpt::obs::IMU_WX)) return false;
    const Eigen::Vector3d rate(imu->get(mrpt::obs::IMU_WX), imu->get(mrpt::obs::IMU_WY),
                               imu->get(mrpt::obs::IMU_WZ));
    keep(rates_, {time, fromMrpt(imu->sensorPose).linear() * rate});
    return true;
  }

  /// At the newest sample, or the frame if that is newer; nullopt before the first frame.
  [[nodiscard]] std::optional<OdometrySample> newest() const {
    if (!frame_) return std::nullopt;
    OdometrySample sample = *frame_;
    sample.velocity = velocity_;
    sample.angular_velocity = angular_velocity_;
    const Time start = frame_->time;
    const auto isNear = [&](Time time) { return time > start && time - start < kMaxBridge_s; };
    Eigen::Vector3d velocity = velocity_;
    const auto at_frame = wheelsAt(start);
    if (at_frame && isNear(wheels_.back().time)) {
      const auto& before = *(wheels_.end() - 2);
      const auto& last = wheels_.back();
      sample.time = last.time;
      sample.T_odom_robot = frame_->T_odom_robot * at_frame->inverse(Eigen::Isometry) * last.value;
      velocity = (before.value.inverse(Eigen::Isometry) * last.value).translation() /
                 (last.time - before.time);
    }
    if (!rates_.empty() && isNear(rates_.back().time)) turn(velocity, sample);
    return sample;
  }

 private:
  template <typename Samples>
  static void keep(Samples& samples, const typename Samples::value_type& sample) {
    if (!samples.empty() && sample.time <= samples.back().time) samples.clear();  // set back
    samples.push_back(sample);
    while (sample.time - samples.front().time > 2.0 * kMaxBridge_s) samples.pop_front();
  }

  /// Moves a sample on by the rates that are newer, at constant speed.
  void turn(const Eigen::Vector3d& velocity, OdometrySample& sample) const {
    auto rate = rates_.end();
    while (rate != rates_.begin() && (rate - 1)->time > sample.time) --rate;
    auto axes = sample.T_odom_robot.linear();
    if (rate != rates_.end()) {
      sample.T_odom_robot.translation() += axes * velocity * (rates_.back().time - sample.time);
    }
    for (; rate != rates_.end(); ++rate) {
      axes = axes * expSo3(rate->value * (rate->time - sample.time));
      sample.time = rate->time;
    }
  }

  [[nodiscard]] std::optional<Pose> wheelsAt(Time time) const {
    const auto after = std::find_if(wheels_.begin(), wheels_.end(),
                                    [&](const auto& sample) { return sample.time >= time; });
    if (after == wheels_.end() || after == wheels_.begin()) return std::nullopt;
    const auto& a = *(after - 1);
    const double ratio = (time - a.time) / (after->time - a.time);
    const Pose step = a.value.inverse(Eigen::Isometry) * after->value;
    Pose part = Pose::Identity();
    part.translation() = ratio * step.translation();
    part.linear() = expSo3(ratio * logSo3(step.linear()));
    return a.value * part;
  }

  std::optional<OdometrySample> frame_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();          ///< between frames, robot axes
  Eigen::Vector3d angular_velocity_ = Eigen::Vector3d::Zero();  ///< the same
  std::deque<Stamped<Pose>> wheels_;
  std::deque<Stamped<Eigen::Vector3d>> rates_;
};

/// A square around the robot, in the odometry frame, of cells that are free at first.
GridMessage windowAround(const Pose& T_odom_robot, double reach_m, double cell_m,
                         const MessageHeader& header) {
  GridMessage grid;
  grid.header = header;
  grid.cell_m = cell_m;
  grid.width = grid.height = 2 * static_cast<std::uint32_t>(std::ceil(reach_m / cell_m));
  const Eigen::Vector2d corner =
      T_odom_robot.translation().head<2>().array() - 0.5 * cell_m * grid.width;
  grid.corner = cell_m * (corner / cell_m).array().round();  // on the grid of the frame
  grid.cells.assign(static_cast<std::size_t>(grid.width) * grid.height, 0);
  return grid;
}

Eigen::Vector2d centreOf(const GridMessage& grid, std::size_t cell) {
  return grid.corner + grid.cell_m * Eigen::Vector2d(0.5 + static_cast<double>(cell % grid.width),
                                                     0.5 + static_cast<double>(cell / grid.width));
}

void setLocalState(const map::LocalLayer& local, Time now, GridMessage& grid) {
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    const auto state = local.at(centreOf(grid, i), now, map::kCaution);
    if (state == map::LocalState::kFree) continue;
    grid.cells[i] = state == map::LocalState::kBlocked ? 100 : -1;
  }
}

/// Centres of blocked cells in the robot's frame, one cell above its origin.
std::vector<Eigen::Vector3f> blockedAround(const map::LocalLayer& local, Time now,
                                           const Pose& T_odom_robot) {
  std::vector<Eigen::Vector3f> points;
  const double z = T_odom_robot.translation().z() + local.cell_m();
  const Pose T_robot_odom = T_odom_robot.inverse(Eigen::Isometry);
  for (const auto& place : local.blocked(now, map::kCaution)) {
    points.push_back((T_robot_odom * Eigen::Vector3d(place.x(), place.y(), z)).cast<float>());
  }
  return points;
}

DiagnosticLine localisationLine(const run::FrameResult& result) {
  const auto& camera = result.update.camera;
  DiagnosticLine line;
  line.name = kLocalisation;
  line.message = slam::toString(camera.status);
  line.level = camera.status == slam::TrackingStatus::kTracked ? DiagnosticLine::kOk
               : slam::isTracked(camera.status)                ? DiagnosticLine::kWarn
                                                               : DiagnosticLine::kError;
  const auto ms = [](double s) { return std::to_string(std::lround(1e3 * s)); };
  line.values = {{"submap", std::to_string(camera.submap)},
                 {"landmarks", std::to_string(camera.inliers)},
                 {"frames", std::to_string(result.frames)},
                 {"frames dropped", std::to_string(result.source.dropped)},
                 {"processing [ms]", ms(result.process_s())},
                 {"image to results [ms]", ms(result.end_s - result.arrival_s)},
                 {"left out", result.left_out}};
  return line;
}

DiagnosticLine silenceLine(bool had_frames, double age_s) {
  DiagnosticLine line;
  line.name = kLocalisation;
  line.level = had_frames ? DiagnosticLine::kError : DiagnosticLine::kStale;
  const std::string age = formatted("%.1f", age_s);
  line.message = had_frames ? "no frame for " + age + " s" : "no frame yet";
  line.values = {{"without frames [s]", age}};
  return line;
}

DiagnosticLine inputLine(const Warnings& warnings) {
  DiagnosticLine line;
  line.name = "headway: input";
  line.message = warnings.empty() ? "no warnings" : warnings.begin()->second.text;
  line.level = warnings.empty() ? DiagnosticLine::kOk : DiagnosticLine::kWarn;
  for (const auto& [name, warning] : warnings) {
    line.values.emplace_back(name, std::to_string(warning.count) + ": " + warning.text);
  }
  return line;
}

}  // namespace

class TopicSink::Implementation {
 public:
  Implementation(Node& node, const Ros2SinkParams& params, Hooks hooks)
      : params_(params),
        hooks_(std::move(hooks)),
        odometry_frame_(params.odom_base ? params.odom_frame : kOwnOdometry) {
    const auto own = [&](const char* name, const char* type, double hz) {
      return Topic{node.advertise(params.prefix + name, type, {}), hz};
    };
    if (params.map_odom || params.odom_base) {
      transforms_ = node.advertise("/tf", "tf2_msgs/TFMessage", {true, false, 100});
    }
    odometry_ = own("/odometry", "nav_msgs/Odometry", params.odometry_hz);
    if (params.clock) clock_ = node.advertise("/clock", "rosgraph_msgs/Clock", {});
    map_ = {node.advertise("/map", "nav_msgs/OccupancyGrid", {true, true, 1}), params.map_hz};
    local_ = own("/local_costmap", "nav_msgs/OccupancyGrid", params.local_costmap_hz);
    obstacles_ = own("/obstacles", "sensor_msgs/PointCloud2", params.obstacles_hz);
    dense_ = own("/dense_map", "sensor_msgs/PointCloud2", params.dense_map_hz);
    detections_ = own("/detections", "vision_msgs/Detection3DArray", params.tracks_hz);
    moving_ = own("/moving_obstacles", "nav2_dynamic_msgs/ObstacleArray", params.tracks_hz);
    markers_ = own("/markers", "visualization_msgs/MarkerArray", params.markers_hz);
    for (int ms = 500; ms <= 3000; ms += 500) {
      const std::string name = "/predicted_" + std::to_string(ms) + "ms";
      predicted_.push_back(own(name.c_str(), "nav_msgs/OccupancyGrid", params.predicted_hz));
    }
    diagnostics_ = {node.advertise("/diagnostics", "diagnostic_msgs/DiagnosticArray", {}),
                    params.diagnostics_hz};
    for (const Topic* topic : {&odometry_, &map_, &local_, &obstacles_, &dense_, &detections_,
                               &moving_, &markers_, &diagnostics_}) {
      publications_.push_back(topic->publication);
    }
    for (const Topic& topic : predicted_) publications_.push_back(topic.publication);
    for (const Publication& other : {transforms_, clock_}) {
      if (!other.topic().empty()) publications_.push_back(other);
    }
    if (params.diagnostics_hz > 0.0) watch_ = std::thread([this] { watchFrames(); });
  }
  ~Implementation() {
    {
      const std::lock_guard lock(health_mutex_);
      is_ending_ = true;
    }
    ends_.notify_all();
    if (watch_.joinable()) watch_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void onLocal(Time time, const slam::SlamUpdate& camera, const map::PerceptionMap& map) {
    publishPose(time, camera);
    if (map.local() != nullptr) publishLocal(time, camera.T_odom_robot, map.local());
  }

  void onFrame(const run::FrameResult& result, const pipeline::Perception& perception) {
    noteFrame(result.update.time);
    publishObjects(result, perception);
    publishPredictions(result.update.time, perception.map(), result.update.camera.T_odom_robot);
    publishMaps(result, perception.map());
  }

  void addObservation(const mrpt::obs::CObservation& observation) {
    const Time time = io::timeFrom(observation.timestamp);
    const std::lock_guard lock(mutex_);
    const bool is_ahead = time > clock_time_ || isSetBack(time, clock_time_);
    if (params_.clock && is_ahead && clock_.hasSubscribers()) {
      clock_time_ = time;
      publish(clock_, clockMessage(time));
    }
    if (!bridge_.add(observation) || params_.odometry_hz <= 0.0) return;
    const auto sample = bridge_.newest();
    const bool is_new = sample && sample->time > odometry_.last;
    if (is_new && !odometry_.isEarly(sample->time)) send(*sample);
  }

  [[nodiscard]] std::map<std::string, std::size_t> messages() const {
    const std::lock_guard lock(sent_mutex_);
    std::map<std::string, std::size_t> result;
    for (const auto& [topic, sent] : sent_) {
      if (sent.messages > 0) result[topic] = sent.messages;
    }
    return result;
  }

 private:
  struct Topic {
    Publication publication;
    double hz = 0.0;
    Time last = 0.0;  ///< of the newest message

    /// Whether the newest message is too new for another; samples that are due come early by some
    /// jitter.
    [[nodiscard]] bool isEarly(Time time) const {
      return time >= last && time - last < 0.9 / std::max(hz, 1e-3);
    }
    /// Whether a message is to be made now.
    bool isDue(Time time) {
      if (hz <= 0.0 || isEarly(time) || !publication.hasSubscribers()) return false;
      last = time;
      return true;
    }
  };

  [[nodiscard]] std::string robotFrame() const {
    return hooks_.robot_frame ? hooks_.robot_frame() : "base_link";
  }

  /// Whether a clock was set back, or a recording begins again; not only out of order.
  static bool isSetBack(Time time, Time last) { return time < last - MotionBridge::kMaxBridge_s; }

  // Subscribers that stop reading --------------------------------------------------------------

  /// By any thread.
  void publish(const Publication& publication, std::string message) {
    (void)publication.publish(std::move(message));
    const std::lock_guard lock(sent_mutex_);
    ++sent_[publication.topic()].messages;
  }

  /// By a thread of its own, because it waits for them.
  void checkSubscribers() {
    const std::lock_guard checked_lock(checked_mutex_);
    if (checked_.valid() && !isReady(checked_)) return;
    checked_ = checks_.run([this] {
      for (const Publication& publication : publications_) {
        std::unique_lock lock(sent_mutex_);
        const Sent before = sent_[publication.topic()];
        lock.unlock();
        if (is_ending_) return;
        const bool is_taken = !publication.hasSubscribers() || publication.isTaken(1.0);
        lock.lock();
        Sent& sent = sent_[publication.topic()];
        if (is_taken) sent.taken = before.messages;
        sent.is_behind = !is_taken;
      }
    });
  }

  [[nodiscard]] DiagnosticLine outputLine() const {
    DiagnosticLine line;
    line.name = "headway: output";
    line.message = "all messages are taken";
    const std::lock_guard lock(sent_mutex_);
    for (const auto& [topic, sent] : sent_) {
      if (!sent.is_behind) continue;
      line.level = DiagnosticLine::kWarn;
      line.message = "a subscriber does not take its messages";
      line.values.emplace_back(topic, std::to_string(sent.messages - sent.taken) + " not taken");
    }
    return line;
  }

  // Poses, by the threads that bring them ------------------------------------------------------

  void publishPose(Time time, const slam::SlamUpdate& camera) {
    OdometrySample frame;
    frame.time = time;
    frame.frame = odometry_frame_;
    frame.child = robotFrame();
    frame.T_odom_robot = camera.T_odom_robot;
    frame.covariance = camera.covariance;
    std::optional<Pose> others;
    if (!params_.odom_base && hooks_.others_odometry) {
      others = hooks_.others_odometry(time);
    }
    const std::lock_guard lock(mutex_);
    // A pose that is doubtful or in another submap says nothing about the map.
    const bool is_in_map = camera.submap == 0 && (camera.status == slam::TrackingStatus::kTracked ||
                                                  camera.status == slam::TrackingStatus::kLost);
    T_map_odom_.reset();
    if (is_in_map) T_map_odom_ = camera.T_map_odom;
    if (!is_in_map) T_map_others_.reset();  // else it stays while others pause
    has_others_ = has_others_ || others.has_value();
    if (is_in_map && others) {
      T_map_others_ = normalized(camera.T_map_robot * others->inverse(Eigen::Isometry));
    }
    bridge_.setFrame(frame);
    if (isSetBack(time, odometry_.last)) odometry_.last = 0.0;
    const auto sample = bridge_.newest();
    if (sample && sample->time > odometry_.last) send(*sample);
  }

  /// Odometry and transforms. mutex_ is locked.
  void send(const OdometrySample& sample) {
    odometry_.last = sample.time;
    if (odometry_.hz > 0.0 && odometry_.publication.hasSubscribers()) {
      publish(odometry_.publication, odometryMessage(sample));
    }
    std::vector<bags::TransformMessage> transforms;
    const MessageHeader in_map = headerOf(sample.time, params_.map_frame);
    if (params_.map_odom && T_map_odom_) {
      const auto& T_map_frame = has_others_ ? T_map_others_ : T_map_odom_;
      if (T_map_frame) transforms.push_back({in_map, params_.odom_frame, *T_map_frame});
      if (!params_.odom_base) transforms.push_back({in_map, kOwnOdometry, *T_map_odom_});
    }
    if (params_.odom_base) {
      transforms.push_back(
          {headerOf(sample.time, sample.frame), sample.child, sample.T_odom_robot});
    }
    if (!transforms.empty() && transforms_.hasSubscribers()) {
      publish(transforms_, transformMessage(transforms));
    }
  }

  // Everything else, by the sink's threads -----------------------------------------------------

  void publishLocal(Time time, const Pose& T_odom_robot,
                    std::shared_ptr<const map::LocalLayer> local) {
    if (local_done_.valid() && !isReady(local_done_)) return;
    const bool has_obstacles = obstacles_.isDue(time), has_costmap = local_.isDue(time);
    if (!has_obstacles && !has_costmap) return;
    local_done_ = local_work_.run([=, local = std::move(local)] {
      if (has_obstacles) {
        publish(obstacles_.publication, cloudMessage(headerOf(time, robotFrame()),
                                                     blockedAround(*local, time, T_odom_robot)));
      }
      if (!has_costmap) return;
      auto grid = windowAround(T_odom_robot, local->reach_m(), local->cell_m(),
                               headerOf(time, odometry_frame_));
      setLocalState(*local, time, grid);
      publish(local_.publication, gridMessage(grid));
    });
  }

  void publishObjects(const run::FrameResult& result, const pipeline::Perception& perception) {
    if (objects_done_.valid() && !isReady(objects_done_)) return;
    const Time time = result.update.time;
    std::vector<Topic*> due;
    for (Topic* topic : {&detections_, &moving_, &markers_}) {
      if (topic->isDue(time)) due.push_back(topic);
    }
    std::vector<DiagnosticLine> health;
    if (diagnostics_.isDue(time)) {
      Warnings warnings = perception.warnings();
      warnings.insert(result.source.warnings.begin(), result.source.warnings.end());
      health = {localisationLine(result), inputLine(warnings)};
      checkSubscribers();
      const std::lock_guard lock(health_mutex_);
      input_ = health.back();
    }
    if (due.empty() && health.empty()) return;
    objects_done_ =
        objects_work_.run([this, due, health, time, tracks = result.update.tracks_odom]() mutable {
          for (Topic* topic : due) publish(topic->publication, messageOf(topic, time, tracks));
          if (!health.empty()) publishHealth(time, std::move(health));
        });
  }

  // Health -------------------------------------------------------------------------------------

  /// Of localisation and input, to which that of the sensors and of the output is added.
  void publishHealth(Time time, std::vector<DiagnosticLine> health) {
    if (hooks_.sensors) {
      for (auto& line : hooks_.sensors()) health.push_back(std::move(line));
    }
    health.push_back(outputLine());
    publish(diagnostics_.publication, diagnosticMessage(time, health));
  }

  void noteFrame(Time time) {
    const std::lock_guard lock(health_mutex_);
    last_frame_ = {monotonicSeconds(), time};
  }

  /// By a thread of its own, while there are no frames, which bring the health otherwise: a camera
  /// that fell silent must not leave "tracked" as the last word.
  void watchFrames() {
    const double period_s = 1.0 / params_.diagnostics_hz;
    const double silence_s = std::max(period_s, 1.0);  // slower cameras than 1 Hz are none
    const double start_s = monotonicSeconds();
    std::unique_lock lock(health_mutex_);
    while (!ends_.wait_for(lock, std::chrono::duration<double>(period_s),
                           [this] { return is_ending_.load(); })) {
      const double age_s = monotonicSeconds() - (last_frame_ ? last_frame_->first : start_s);
      if (age_s < silence_s || !diagnostics_.publication.hasSubscribers()) continue;
      const Time time =
          last_frame_ ? last_frame_->second + age_s : io::timeFrom(mrpt::Clock::now());
      std::vector<DiagnosticLine> health = {silenceLine(last_frame_.has_value(), age_s)};
      if (input_) health.push_back(*input_);
      lock.unlock();
      checkSubscribers();
      publishHealth(time, std::move(health));
      lock.lock();
    }
  }

  [[nodiscard]] std::string messageOf(const Topic* topic, Time time,
                                      const std::vector<Track>& tracks) const {
    const MessageHeader header = headerOf(time, odometry_frame_);
    if (topic == &detections_) return detectionMessage(header, tracks);
    return topic == &moving_ ? obstacleMessage(header, tracks) : markerMessage(header, tracks);
  }

  void publishPredictions(Time time, const map::PerceptionMap& map, const Pose& T_odom_robot) {
    if (map.local() == nullptr || (predicted_done_.valid() && !isReady(predicted_done_))) return;
    std::vector<std::size_t> due;
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      if (predicted_[i].isDue(time)) due.push_back(i);
    }
    if (due.empty()) return;
    predicted_done_ = predictions_.run([this, time, map, T_odom_robot, due] {
      const auto& local = *map.local();
      const auto query = map.inOdometryAt(time);
      for (const std::size_t i : due) {
        auto grid = windowAround(T_odom_robot, local.reach_m(), 2.0 * local.cell_m(),
                                 headerOf(time, odometry_frame_));
        setOccupancy(query.obstaclesAt(time + 0.5 * static_cast<double>(1 + i)).items, grid);
        publish(predicted_[i].publication, gridMessage(grid));
      }
    });
  }

  void publishMaps(const run::FrameResult& result, const map::PerceptionMap& map) {
    if (maps_done_.valid() && !isReady(maps_done_)) return;
    const MessageHeader header = headerOf(result.update.time, params_.map_frame);
    const auto grid = map.staticGrid();
    const auto dense = map.dense();
    // Unchanged ones, too, for those who came since.
    const bool has_grid = grid != nullptr && map_.isDue(result.update.time);
    const bool has_dense = dense != nullptr && dense_.isDue(result.update.time);
    if (!has_grid && !has_dense) return;
    maps_done_ = maps_.run([this, header, grid, dense, has_grid, has_dense] {
      if (has_grid) publish(map_.publication, gridMessage(header, *grid));
      if (has_dense) publish(dense_.publication, cloudMessage(header, *dense));
    });
  }

  const Ros2SinkParams params_;
  const Hooks hooks_;
  const std::string odometry_frame_;

  std::mutex mutex_;
  MotionBridge bridge_;                            // guarded by mutex_, like the members below
  std::optional<Pose> T_map_odom_, T_map_others_;  ///< of the newest frame, if they are known
  bool has_others_ = false;                        ///< did others ever publish the odometry?
  Topic odometry_;
  Publication transforms_, clock_;
  Time clock_time_ = 0.0;

  Topic map_, local_, obstacles_, dense_, detections_, moving_, markers_, diagnostics_;
  std::vector<Topic> predicted_;  ///< at 0.5 s, 1 s, ...
  /// Messages of a topic.
  struct Sent {
    std::size_t messages = 0;
    std::size_t taken = 0;   ///< by all subscribers, at least
    bool is_behind = false;  ///< a subscriber, by more than a second
  };
  std::vector<Publication> publications_;  ///< all
  mutable std::mutex sent_mutex_;
  std::map<std::string, Sent> sent_;  ///< by topic, guarded by sent_mutex_
  std::mutex checked_mutex_;          ///< of checked_
  std::mutex health_mutex_;
  std::condition_variable ends_;
  std::optional<std::pair<double, Time>> last_frame_;  ///< when it came; guarded by health_mutex_
  std::optional<DiagnosticLine> input_;                ///< the newest; guarded by health_mutex_
  std::atomic<bool> is_ending_{false};
  std::thread watch_;
  std::future<void> local_done_, objects_done_, predicted_done_, maps_done_, checked_;
  /// Last: they use the others.
  WorkerThread local_work_, objects_work_, checks_;
  WorkerThread predictions_{WorkerThread::Priority::kBackground};
  WorkerThread maps_{WorkerThread::Priority::kBackground};
};

TopicSink::TopicSink(Node& node, const Ros2SinkParams& params, Hooks hooks)
    : implementation_(std::make_unique<Implementation>(node, params, std::move(hooks))) {}

TopicSink::~TopicSink() = default;

void TopicSink::onLocal(Time time, const slam::SlamUpdate& camera, const map::PerceptionMap& map) {
  implementation_->onLocal(time, camera, map);
}

void TopicSink::onFrame(const run::FrameResult& result, pipeline::Perception& perception) {
  implementation_->onFrame(result, perception);
}

void TopicSink::addObservation(const mrpt::obs::CObservation& observation) {
  implementation_->addObservation(observation);
}

std::map<std::string, std::size_t> TopicSink::messages() const {
  return implementation_->messages();
}

}  // namespace headway::ros2
