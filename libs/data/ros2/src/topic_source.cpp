// SPDX-License-Identifier: BSD-3-Clause
// Topics of ROS 2 as live observations.
#include <headway/bags/bag_selection.h>
#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/text.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_sink.h>
#include <headway/ros2/topic_source.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>

#include "bag_file.h"
#include "bag_rig.h"
#include "message_import.h"
#include "messages.h"
#include "observations.h"

namespace headway::ros2 {
namespace {

using bags::BagSelection;
using bags::BagTopic;
using bags::MessageHeader;
using mrpt::obs::CObservation;

constexpr double kPatience_s = 2.0;       // for transforms of all sensors, after the first image
constexpr std::size_t kMaxReasons = 200;  // said and counted one by one, of so many characters each

constexpr char kTransforms[] = "/tf", kStaticTransforms[] = "/tf_static";
constexpr char kNone[] = "none";  // of wishes
constexpr char kInitialPose[] = "/initialpose";
constexpr char kPoseType[] = "geometry_msgs/PoseWithCovarianceStamped";
constexpr char kTransformType[] = "tf2_msgs/TFMessage";
constexpr char kInfoType[] = "sensor_msgs/CameraInfo";

std::vector<BagTopic> topicsOf(const std::vector<PublishedTopic>& published) {
  std::vector<BagTopic> topics;
  for (const auto& topic : published) {
    topics.push_back({topic.name, topic.type, bags::Encoding::kCdr, 1});
  }
  return topics;
}

bags::BagWishes wishesOf(const Ros2SourceParams& params) {
  return {params.left,     params.right, params.color, params.depth, params.imu,
          params.odometry, params.scan,  params.gnss,  kNone};  // transforms have their names
}

/// Selected topics with their types, and the calibration of images.
std::vector<BagTopic> neededOf(const BagSelection& selection, const std::vector<BagTopic>& topics) {
  std::vector<BagTopic> needed;
  for (const BagTopic& topic : topics) {
    if (!bags::useOf(topic, selection).empty() && topic.type != kInfoType) needed.push_back(topic);
  }
  for (const auto& image : {selection.left, selection.right, selection.color, selection.depth}) {
    if (image.empty()) continue;
    needed.push_back({bags::cameraInfoTopicOf(image), kInfoType, bags::Encoding::kCdr, 1});
  }
  return needed;
}

/// Texts of the import of bags name its option.
std::string withKeysOfRos2(std::string text) {
  const std::string option = "--base ";
  const auto at = text.find(option);
  if (at != std::string::npos) text.replace(at, option.size(), "[ros2] base_frame = ");
  return text;
}

bool isImage(const BagTopic& topic) { return topic.type.find("Image") != std::string::npos; }

}  // namespace

class TopicSource::Implementation {
 public:
  Implementation(Node& node, const Ros2SourceParams& params, const TopicSourceOptions& options,
                 Callbacks callbacks)
      : node_(node),
        wishes_(wishesOf(params)),
        options_(options),
        callbacks_(std::move(callbacks)),
        pairing_(options.pair_tolerance_s) {
    import_.base_frame = params.base_frame;
    if (!params.base_frame.empty()) robot_frame_ = params.base_frame;
    import_.calibration = options.calibration;
    selection_.tf = {kTransforms, kStaticTransforms};
    surveyor_.emplace(selection_, std::vector<BagTopic>());
  }

  ~Implementation() {
    stop();  // waits for a callback
    for (const auto& entry : subscriptions_) node_.unsubscribe(entry.first);
  }

  void start() {
    if (thread_.joinable()) return;
    stopping_ = false;
    subscribe({kTransforms, kTransformType, bags::Encoding::kCdr, 1}, {true, false, 100});
    subscribe({kStaticTransforms, kTransformType, bags::Encoding::kCdr, 1}, {true, true, 100});
    subscribe({kInitialPose, kPoseType, bags::Encoding::kCdr, 1}, {true, false, 1});
    thread_ = std::thread([this] { run(); });
  }

  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  std::vector<TopicStatus> status() const {
    const std::lock_guard lock(mutex_);
    std::vector<TopicStatus> result;
    for (const auto& [name, state] : status_) {
      result.push_back(state);
      result.back().age_s = monotonicSeconds() - state.age_s;
    }
    return result;
  }

  std::map<std::string, std::size_t> skipped() const {
    const std::lock_guard lock(mutex_);
    return skipped_;
  }

  std::string missing() const {
    const std::lock_guard lock(mutex_);
    return missing_;
  }

  std::string robotFrame() const {
    const std::lock_guard lock(mutex_);
    return robot_frame_;
  }

  std::optional<Pose> odometryAt(Time time) const {
    constexpr double kMaxGap = 0.5;  // between two transforms [s]: tf2 allows none for their future
    const std::lock_guard lock(mutex_);
    const auto after = std::find_if(odometry_.begin(), odometry_.end(),
                                    [&](const auto& pose) { return pose.time >= time; });
    if (after == odometry_.end()) {
      const bool is_near = !odometry_.empty() && time - odometry_.back().time < kMaxGap;
      return is_near ? std::optional(odometry_.back().value) : std::nullopt;
    }
    if (after == odometry_.begin()) {
      return after->time - time < kMaxGap ? std::optional(after->value) : std::nullopt;
    }
    const auto& a = *(after - 1);
    const auto& b = *after;
    const double ratio = (time - a.time) / (b.time - a.time);
    Pose pose = Pose::Identity();
    pose.translation() = (1.0 - ratio) * a.value.translation() + ratio * b.value.translation();
    pose.linear() = quaternionOf(a.value).slerp(ratio, quaternionOf(b.value)).toRotationMatrix();
    return pose;
  }

 private:
  struct Subscription {
    BagTopic topic;
    Qos qos;
  };

  void run() {
    double next_s = 0.0;
    while (!stopping_) {
      node_.spin(0.05);
      if (monotonicSeconds() < next_s) continue;
      next_s = monotonicSeconds() + 0.2;
      discover();
      if (!is_selected_ || !hasCamera()) continue;
      if (rig_) nameLateMounting();
      if (!rig_) calibrate();
    }
  }

  // Which topics -----------------------------------------------------------------------------

  void discover() {
    const auto published = node_.published();
    const auto topics = topicsOf(published);
    select(topics);
    for (const PublishedTopic& topic : published) check(topic);
    if (!is_selected_) return;
    for (const BagTopic& topic : neededOf(selection_, topics)) {
      const auto found =
          std::find_if(published.begin(), published.end(), [&](const PublishedTopic& other) {
            return other.name == topic.name && other.type == topic.type;
          });
      if (found == published.end() || subscriptions_.count(topic.name) > 0) continue;
      subscribe(topic, {found->is_reliable, found->is_transient_local, isImage(topic) ? 10 : 100});
    }
  }

  /// Chooses the camera once, and the other sensors as they come.
  void select(const std::vector<BagTopic>& topics) {
    try {
      BagSelection selection = bags::selectTopics(topics, wishesAmong(topics));
      const double now_s = monotonicSeconds();
      if (!camera_since_s_) camera_since_s_ = now_s;
      if (now_s - *camera_since_s_ < 0.5 * kPatience_s) return;  // for the other sensors
      wishes_.left = selection.left.empty() ? kNone : selection.left;
      wishes_.right = selection.right.empty() ? kNone : selection.right;
      wishes_.color = selection.color.empty() ? kNone : selection.color;
      wishes_.depth = selection.depth.empty() ? kNone : selection.depth;
      fix(selection.imu, wishes_.imu);
      fix(selection.scans, wishes_.scan);
      fix({selection.odometry}, wishes_.odometry);
      fix({selection.gnss}, wishes_.gnss);
      selection.tf = selection_.tf;
      selection_ = selection;
      import_.topics = selection;
      if (!std::exchange(is_selected_, true)) startSurvey();
    } catch (const InputError& error) {  // not all there yet, or not any more
      if (!is_selected_) setMissing(error.what());
    }
  }

  /// The wishes without sensors that are not published yet, which shall not keep the camera
  /// waiting.
  [[nodiscard]] bags::BagWishes wishesAmong(const std::vector<BagTopic>& topics) const {
    bags::BagWishes wishes = wishes_;
    for (std::string* wish : {&wishes.imu, &wishes.odometry, &wishes.scan, &wishes.gnss}) {
      if (wish->empty() || *wish == kNone) continue;
      std::istringstream names(std::exchange(*wish, kNone));
      for (std::string name; std::getline(names, name, ',');) {
        const bool is_published = std::any_of(
            topics.begin(), topics.end(), [&](const auto& topic) { return topic.name == name; });
        if (is_published) *wish = *wish == kNone ? name : *wish + "," + name;
      }
    }
    return wishes;
  }

  /// What was chosen once remains, so that a topic that comes later does not replace it.
  static void fix(const std::vector<std::string>& chosen, std::string& wish) {
    if (chosen.empty() || !wish.empty()) return;
    for (const auto& name : chosen) wish += (wish.empty() ? "" : ",") + name;
  }

  void startSurvey() {
    const auto survey = std::exchange(surveyor_, std::nullopt)->survey;
    std::vector<BagTopic> infos;
    for (const BagTopic& topic : neededOf(selection_, {})) infos.push_back(topic);
    if (!options_.calibration.empty()) infos.clear();
    surveyor_.emplace(selection_, infos);
    surveyor_->survey.transforms = survey.transforms;
    const bool is_stereo = !selection_.left.empty();
    pairing_ = bags::ImagePairing(std::max(options_.pair_tolerance_s, is_stereo ? 0.0 : 0.02));
    setMissing(hasCamera() ? "no images yet" : "");
  }

  void subscribe(const BagTopic& topic, const Qos& qos) {
    subscriptions_[topic.name] = {topic, qos};
    const std::string use = topic.name == kInitialPose ? "initial pose" : useOf(topic, selection_);
    {
      const std::lock_guard lock(mutex_);
      auto& status = status_[topic.name];
      status.topic = topic.name;
      status.use = use;
      status.age_s = monotonicSeconds();
    }
    node_.subscribe(topic.name, topic.type, qos,
                    [this, topic](std::string_view message) { receive(topic, message); });
  }

  /// Names what is odd about the publishers of a topic, and asks for no more than they offer.
  void check(const PublishedTopic& published) {
    const auto found = subscriptions_.find(published.name);
    if (found == subscriptions_.end()) return;
    auto& [topic, qos] = found->second;
    if (published.type != topic.type) {
      say(published.name + " is published as " + published.type +
          ", too, which is not used: it is " + topic.type);
      return;
    }
    const bool is_of_many = topic.type == kTransformType || topic.name == kInitialPose;
    if (!is_of_many && published.publishers > 1) {
      say(published.name + " has " + std::to_string(published.publishers) +
          " publishers, whose messages are mixed");
    }
    const bool asks_too_much = (qos.is_reliable && !published.is_reliable) ||
                               (qos.is_transient_local && !published.is_transient_local);
    if (!asks_too_much) return;
    say(published.name + " is not published as reliably as before: messages may be lost");
    Qos less = qos;
    less.is_reliable = qos.is_reliable && published.is_reliable;
    less.is_transient_local = qos.is_transient_local && published.is_transient_local;
    if (topic.name != kStaticTransforms) return subscribe(BagTopic(topic), less);
    qos = less;
    node_.widen(topic.name, less);  // later publishers may have sent theirs before, too
  }

  // Calibration and mounting -----------------------------------------------------------------

  [[nodiscard]] bool hasCamera() const {
    return !selection_.left.empty() || !selection_.color.empty();
  }

  void calibrate() {
    if (!first_image_s_) return;
    const bool waits = monotonicSeconds() - *first_image_s_ < kPatience_s;
    if (!surveyor_->isComplete() && waits) return;
    try {
      rig_ = bags::rigOf(surveyor_->survey, import_);
      infos_ = surveyor_->survey.camera_infos;
      for (const auto& note : rig_->notes) say(withKeysOfRos2(note));
      setRobotFrame(rig_->base_frame);
      setMissing("");
    } catch (const InputError& error) {
      setMissing(withKeysOfRos2(error.what()));
      surveyor_->renewInfos();  // drivers may send some before they are calibrated
    }
  }

  /// Says once for each frame that it moves another on which a sensor is mounted: as at the start.
  void nameMovingMounting(const bags::TransformMessage& now) {
    const auto& transforms = surveyor_->survey.transforms;
    const auto known = transforms.between(now.header.frame, now.child_frame);
    if (!known || known->isApprox(now.T_parent_child, 1e-3)) return;
    if (moving_.size() > kMaxReasons || !moving_.insert(now.child_frame).second) return;
    bags::TransformTree moved = transforms;
    moved.add(now, true);
    auto frames = surveyor_->survey.frames;
    const std::string& camera = selection_.left.empty() ? selection_.depth : selection_.left;
    const std::string base = baseFrame().empty() ? frames[camera] : baseFrame();
    for (const auto& [topic, frame] : frames) {
      const auto before = transforms.between(base, frame), after = moved.between(base, frame);
      if (!before || !after || after->isApprox(*before, 1e-3)) continue;
      say("the mounting of " + frame + " moves by that of " + now.child_frame +
          ": it is taken as at the start");
    }
  }

  /// Says once that a driver was restarted with other settings, which are not taken up.
  void compareInfo(const std::string& topic, const io::CameraInfo& now) {
    const auto used = infos_.find(topic);
    if (!rig_ || used == infos_.end()) return;
    const auto numbers = [](const io::CameraInfo& info) {
      return std::tie(info.width, info.height, info.D, info.K, info.R, info.P);
    };
    if (numbers(used->second) == numbers(now)) return;
    say(topic + " is not what it was at the start, which is still used: start headway-live again");
  }

  /// Says once that tf came when images were used already, whose camera does not move any more.
  void nameLateMounting() {
    if (is_late_mounting_named_ || !rig_->base_frame.empty()) return;
    const std::string& camera = selection_.left.empty() ? selection_.depth : selection_.left;
    const auto& survey = surveyor_->survey;
    const auto frame = survey.frames.find(camera);
    if (frame == survey.frames.end()) return;
    const std::string base = bags::baseOf(survey.transforms, frame->second);
    if (base.empty()) return;
    is_late_mounting_named_ = true;
    say("tf mounts the camera on " + base +
        " only now, after its images were used without: start again, or set base_frame = " + base +
        " in [ros2], which waits for tf");
  }

  /// Where a sensor is mounted; nullopt if it is unknown, which is counted.
  std::optional<Pose> mountingOf(const std::string& topic, const std::string& frame) {
    const auto known = mounting_.find(topic);
    if (known != mounting_.end()) return known->second;
    const auto& transforms = surveyor_->survey.transforms;
    std::optional<Pose> mounting;
    if (rig_ && rig_->base_frame.empty()) {
      const std::string& camera = selection_.left.empty() ? selection_.depth : selection_.left;
      mounting = transforms.between(surveyor_->survey.frames[camera], frame);
      if (mounting) mounting = rig_->T_robot_sensor.at(camera) * *mounting;
    } else {
      mounting = transforms.between(baseFrame(), frame);
    }
    if (mounting) mounting_[topic] = *mounting;
    if (!mounting) skip("no_tf_of_frame_" + frame, topic);
    return mounting;
  }

  [[nodiscard]] std::string baseFrame() const { return rig_ ? rig_->base_frame : robot_frame_; }

  /// @param base  on which tf mounts the camera; empty: on none
  void setRobotFrame(const std::string& base) {
    if (base.empty() || base == robot_frame_) return;
    const std::lock_guard lock(mutex_);
    robot_frame_ = base;
    mounting_.clear();
    odometry_.clear();
  }

  // Messages ---------------------------------------------------------------------------------

  void receive(const BagTopic& topic, std::string_view message) {
    {
      const std::lock_guard lock(mutex_);
      auto& status = status_[topic.name];
      ++status.messages;
      status.age_s = monotonicSeconds();
    }
    try {
      surveyor_->use(topic, message);
      convert(topic, message);
    } catch (const bags::BrokenData& error) {
      skip("unreadable_" + topic.type, topic.name + ": " + error.what());
    }
  }

  void convert(const BagTopic& topic, std::string_view message) {
    const auto& name = topic.name;
    if (topic.type == kInfoType) {
      compareInfo(name, bags::decodeCameraInfo(message, topic.encoding).info);
    } else if (topic.type == kTransformType) {
      addTransforms(message);
    } else if (name == kInitialPose) {
      const auto pose = bags::decodePose(message, topic.encoding);
      if (pose.header.frame != options_.map_frame) {
        return skip("initial_pose_not_in_frame_" + options_.map_frame,
                    "in \"" + pose.header.frame + "\"");
      }
      if (callbacks_.initial_pose) callbacks_.initial_pose(pose.pose);
    } else if (isImage(topic)) {
      const bool is_first = name == selection_.left || name == selection_.color;
      addImage(is_first ? 0 : 1, topic, message);
    } else if (topic.type == "sensor_msgs/Imu") {
      addImu(name, bags::decodeImu(message, topic.encoding));
    } else if (topic.type == "nav_msgs/Odometry") {
      addOdometry(bags::decodeOdometry(message, topic.encoding));
    } else if (topic.type == "sensor_msgs/LaserScan") {
      addScan(name, bags::decodeLaserScan(message, topic.encoding));
    } else if (topic.type == "sensor_msgs/NavSatFix") {
      addFix(name, bags::decodeNavSatFix(message, topic.encoding));
    }
  }

  /// The header's time; that of now if it is not set.
  static Time timeOf(const MessageHeader& header) {
    if (header.time_ns != 0) return 1e-9 * static_cast<double>(header.time_ns);
    return io::timeFrom(mrpt::Clock::now());
  }

  void addTransforms(std::string_view message) {
    for (const auto& transform : bags::decodeTransforms(message, bags::Encoding::kCdr)) {
      if (rig_) nameMovingMounting(transform);
      if (transform.header.frame != options_.odom_frame) continue;
      const auto T_child_robot =
          surveyor_->survey.transforms.between(transform.child_frame, robot_frame_);
      if (!T_child_robot) continue;
      const Stamped<Pose> pose{timeOf(transform.header), transform.T_parent_child * *T_child_robot};
      const std::lock_guard lock(mutex_);
      if (!odometry_.empty() && pose.time <= odometry_.back().time) odometry_.clear();
      odometry_.push_back(pose);
      while (pose.time - odometry_.front().time > kPatience_s) odometry_.pop_front();
    }
  }

  void addImage(std::size_t side, const BagTopic& topic, std::string_view message) {
    if (!first_image_s_) first_image_s_ = monotonicSeconds();
    const bool is_stereo = !selection_.left.empty();
    const bool is_depth = !is_stereo && side == 1;
    MessageHeader header;
    const auto converted = bags::convertImage(topic, message, is_depth, header);
    if (const auto* reason = std::get_if<std::string>(&converted)) {
      return skip(*reason, topic.name);
    }
    if (!rig_) return skip("before_calibration", "");
    const auto& image = std::get<cv::Mat>(converted);
    const io::RawCamera& lens = is_stereo ? (side == 0 ? rig_->stereo.left : rig_->stereo.right)
                                          : (side == 0 ? rig_->color : rig_->depth);
    if (image.cols != lens.width || image.rows != lens.height) {
      return skip("image_size", topic.name + ": " + std::to_string(image.cols) + "x" +
                                    std::to_string(image.rows) + " px, its calibration is for " +
                                    std::to_string(lens.width) + "x" + std::to_string(lens.height));
    }
    const std::size_t unpaired = pairing_.unpaired();
    const auto pair = pairing_.add(side, {timeOf(header), image});
    if (pairing_.unpaired() > unpaired) {
      skip("unpaired_image", "images without a partner of the other camera within " +
                                 std::to_string(options_.pair_tolerance_s) + " s");
    }
    if (pair) addPair(*pair, is_stereo);
  }

  void addPair(const bags::ImagePairing::Pair& pair, bool is_stereo) {
    const auto& [first, second] = pair;
    if (!is_stereo) {
      return deliver(bags::depthObservation(first.value, second.value, first.time, *rig_));
    }
    if (first.value.channels() != second.value.channels()) return skip("colour_and_grey_pair", "");
    auto observation = mrpt::obs::CObservationStereoImages::Create();
    observation->timestamp = io::mrptTime(first.time);
    observation->sensorLabel = "stereo";
    observation->imageLeft = mrpt::img::CImage(first.value, mrpt::img::SHALLOW_COPY);
    observation->imageRight = mrpt::img::CImage(second.value, mrpt::img::SHALLOW_COPY);
    io::setCalibration(rig_->stereo, *observation);
    deliver(observation);
  }

  void addImu(const std::string& topic, bags::ImuMessage imu) {
    if (selection_.imu.size() > 1) bags::leaveOutZeroRate(imu);
    const auto mounting = mountingOf(topic, imu.header.frame);
    if (!mounting) return;
    if (!bags::isFinite(imu)) {
      return skip("imu_not_finite", topic);
    }
    deliver(bags::imuObservation(imu, timeOf(imu.header), *mounting));
  }

  void addOdometry(const bags::OdometryMessage& odometry) {
    const auto T_child_base =
        surveyor_->survey.transforms.between(odometry.child_frame, baseFrame());
    const Pose T_odom_base = odometry.T_odom_child * T_child_base.value_or(Pose::Identity());
    auto observation = mrpt::obs::CObservationOdometry::Create();
    observation->timestamp = io::mrptTime(timeOf(odometry.header));
    observation->sensorLabel = "odometry";
    observation->odometry = mrpt::poses::CPose2D(T_odom_base.translation().x(),
                                                 T_odom_base.translation().y(), yawOf(T_odom_base));
    deliver(observation);
  }

  void addScan(const std::string& topic, const bags::LaserScanMessage& message) {
    const auto mounting = mountingOf(topic, message.header.frame);
    if (!mounting) return;
    const auto scan = bags::scanFrom(message, timeOf(message.header), *mounting);
    if (!scan) return skip("broken_scan", topic);
    deliver(io::laserObservation(*scan, topic));
  }

  void addFix(const std::string& topic, const bags::NavSatFixMessage& fix) {
    if (fix.status < 0) return skip("gnss_without_fix", topic);
    if (!(std::abs(fix.latitude_deg) <= 90.0) || !(std::abs(fix.longitude_deg) <= 180.0) ||
        !std::isfinite(fix.altitude_m)) {
      return skip("gnss_no_position", topic);
    }
    const auto mounting = mountingOf(topic, fix.header.frame);
    if (mounting) deliver(bags::gnssObservation(fix, timeOf(fix.header), *mounting));
  }

  void deliver(const CObservation::Ptr& observation) { callbacks_.observation(observation); }

  // What is wrong ----------------------------------------------------------------------------

  void skip(std::string reason, const std::string& detail) {
    reason.resize(std::min(reason.size(), kMaxReasons));  // it may contain a text of the message
    bool is_new = false;
    {
      const std::lock_guard lock(mutex_);
      if (skipped_.count(reason) == 0 && skipped_.size() >= kMaxReasons) reason = "other_reasons";
      is_new = ++skipped_[reason] == 1;
    }
    if (is_new && reason != "before_calibration") {
      say("message not used, like others that are counted: " + reason +
          (detail.empty() ? "" : " (" + detail + ")"));
    }
  }

  void say(const std::string& text) {
    if (said_.size() > kMaxReasons || !said_.insert(text).second) return;
    if (callbacks_.message) callbacks_.message("ROS 2: " + text);
  }

  void setMissing(const std::string& text) {
    const std::lock_guard lock(mutex_);
    missing_ = text;
  }

  Node& node_;
  bags::BagWishes wishes_;
  const TopicSourceOptions options_;
  const Callbacks callbacks_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;

  // The thread's:
  BagSelection selection_;
  bool is_selected_ = false;
  bags::BagImportOptions import_;
  std::optional<double> camera_since_s_;
  std::optional<double> first_image_s_;
  std::optional<bags::Surveyor> surveyor_;       ///< of tf alone until topics are selected
  std::optional<bags::BagRig> rig_;              ///< once the camera is calibrated
  std::map<std::string, io::CameraInfo> infos_;  ///< by which it is, by topic
  bool is_late_mounting_named_ = false;
  std::map<std::string, Pose> mounting_;  ///< by topic
  std::set<std::string> moving_;          ///< frames
  bags::ImagePairing pairing_;
  std::map<std::string, Subscription> subscriptions_;  ///< by topic
  std::set<std::string> said_;

  mutable std::mutex mutex_;
  std::map<std::string, TopicStatus> status_;  // guarded by mutex_, like the members below; age_s:
                                               // when the newest message came
  std::map<std::string, std::size_t> skipped_;
  std::string missing_ = "no topics yet";
  std::deque<Stamped<Pose>> odometry_;  ///< T_odom_robot of others
  std::string robot_frame_ = "base_link";
};

TopicSource::TopicSource(Node& node, const Ros2SourceParams& params,
                         const TopicSourceOptions& options, Callbacks callbacks)
    : implementation_(
          std::make_unique<Implementation>(node, params, options, std::move(callbacks))) {}

TopicSource::~TopicSource() = default;

void TopicSource::start() { implementation_->start(); }

void TopicSource::stop() { implementation_->stop(); }

std::vector<TopicStatus> TopicSource::status() const { return implementation_->status(); }

std::map<std::string, std::size_t> TopicSource::skipped() const {
  return implementation_->skipped();
}

std::string TopicSource::missing() const { return implementation_->missing(); }

std::string TopicSource::robotFrame() const { return implementation_->robotFrame(); }

std::optional<Pose> TopicSource::odometryAt(Time time) const {
  return implementation_->odometryAt(time);
}

std::string listOfTopics(Node& node, const Ros2SourceParams& params) {
  const double until_s = monotonicSeconds() + kPatience_s;
  while (monotonicSeconds() < until_s) node.spin(0.1);
  const auto published = node.published();
  BagSelection selection;
  std::string problem;
  try {
    auto wishes = wishesOf(params);
    wishes.tf = "";
    selection = bags::selectTopics(topicsOf(published), wishes);
  } catch (const InputError& error) {
    problem = error.what();
  }
  std::ostringstream text;
  for (const PublishedTopic& topic : published) {
    const std::string use =
        bags::useOf({topic.name, topic.type, bags::Encoding::kCdr, 1}, selection);
    text << printable(topic.name + "  " + topic.type) << "  " << topic.publishers << " publisher"
         << (topic.publishers == 1 ? "" : "s")
         << (topic.is_reliable ? ", reliable" : ", best effort")
         << (use.empty() ? "" : "  <- " + use) << "\n";
  }
  if (published.empty()) text << "no topics on " << node.network() << "\n";
  if (!problem.empty() && !published.empty()) text << printable(problem) << "\n";
  return text.str();
}

}  // namespace headway::ros2
