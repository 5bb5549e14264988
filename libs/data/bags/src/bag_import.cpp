// SPDX-License-Identifier: BSD-3-Clause
// How messages become frames and observations: images are paired, and all put in the order of their
// times.
#include <headway/bags/bag_import.h>
#include <headway/core/error.h>

#include <algorithm>
#include <cmath>

#include "bag_file.h"
#include "bag_rig.h"
#include "message_import.h"
#include "observations.h"

namespace headway::bags {
namespace {

constexpr double kStereoTolerance = 0.01;   // between left and right image, as in rawlogs [s]
constexpr double kDepthTolerance = 0.02;    // between colour and depth [s]
constexpr std::size_t kSampleBytes = 1000;  // of an observation without images, about

bool isAmong(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::size_t bytesOf(const cv::Mat& image) { return image.total() * image.elemSize(); }

}  // namespace

MessageImport::MessageImport(const BagImportOptions& options, const BagRig& rig,
                             BagImportSummary& summary)
    : options_(options),
      rig_(rig),
      summary_(summary),
      is_stereo_(!options.topics.left.empty()),
      is_imu_split_(options.topics.imu.size() > 1),
      pairing_(is_stereo_ ? kStereoTolerance : kDepthTolerance) {}

void MessageImport::add(const BagTopic& topic, const BagMessage& message) {
  const auto& topics = options_.topics;
  try {
    if (topic.name == (is_stereo_ ? topics.left : topics.color)) {
      addImage(0, topic, message);
    } else if (topic.name == (is_stereo_ ? topics.right : topics.depth)) {
      addImage(1, topic, message);
    } else if (isAmong(topics.imu, topic.name)) {
      addImu(topic, message);
    } else if (topic.name == topics.odometry) {
      addOdometry(topic, message);
    } else if (isAmong(topics.scans, topic.name)) {
      addScan(topic, message);
    } else if (topic.name == topics.gnss) {
      addFix(topic, message);
    }
  } catch (const BrokenData&) {
    ++summary_.dropped["unreadable_" + topic.type];
  }
}

std::map<std::string, std::size_t> MessageImport::dropped(std::size_t waiting) const {
  auto dropped = summary_.dropped;
  const std::size_t unpaired = pairing_.unpaired() + waiting;
  if (unpaired > 0) dropped["unpaired_image"] += unpaired;
  return dropped;
}

Time MessageImport::timeOf(const MessageHeader& header, const BagMessage& message) {
  if (header.time_ns != 0) return static_cast<double>(header.time_ns) * 1e-9;
  ++summary_.dropped["header_without_time"];  // its time alone: that of the recording is used
  return static_cast<double>(message.received_ns) * 1e-9;
}

void MessageImport::addImage(std::size_t side, const BagTopic& topic, const BagMessage& message) {
  const bool is_depth = !is_stereo_ && side == 1;
  MessageHeader header;
  auto converted = convertImage(topic, message.content, is_depth, header);
  if (const auto* reason = std::get_if<std::string>(&converted)) {
    ++summary_.dropped[*reason];
    return;
  }
  const cv::Mat& image = std::get<cv::Mat>(converted);
  if (is_stereo_) {
    requireSize(image, topic.name, side == 0 ? rig_.stereo.left : rig_.stereo.right);
  } else {
    requireSize(image, topic.name, is_depth ? rig_.depth : rig_.color);
  }
  if (const auto pair = pairing_.add(side, {timeOf(header, message), image})) addPair(*pair);
}

void MessageImport::requireSize(const cv::Mat& image, const std::string& topic,
                                const io::RawCamera& lens) const {
  if (image.cols == lens.width && image.rows == lens.height) return;
  throw InputError(topic + ": its images have " + std::to_string(image.cols) + "x" +
                   std::to_string(image.rows) + " px, its calibration is for " +
                   std::to_string(lens.width) + "x" + std::to_string(lens.height));
}

void MessageImport::addPair(const ImagePairing::Pair& pair) {
  ++pairs_;
  const cv::Mat first = pair[0].value;
  const cv::Mat second = pair[1].value;
  const Time time = pair[0].time;
  TimeOrder::Event event;
  event.time = time;
  event.bytes = bytesOf(first) + bytesOf(second);
  event.dropped = dropped(0);
  if (!is_stereo_) {
    event.write = [first, second, time, &rig = rig_](io::RawlogSink& sink) {
      sink.write(*depthObservation(first, second, time, rig));
    };
  } else if (first.channels() == second.channels()) {
    event.write = [first, second, time, &rig = rig_](io::RawlogSink& sink) {
      sink.writeStereo(time, first, second, rig.stereo);
    };
  } else {
    ++summary_.dropped["colour_and_grey_pair"];
    return;
  }
  order_.add(std::move(event));
}

const Pose* MessageImport::mountingOf(const std::string& topic) {
  const auto found = rig_.T_robot_sensor.find(topic);
  if (found != rig_.T_robot_sensor.end()) return &found->second;
  const auto frame = rig_.frames.find(topic);
  ++summary_.dropped["no_tf_of_frame_" + (frame == rig_.frames.end() ? "" : frame->second)];
  return nullptr;
}

void MessageImport::addImu(const BagTopic& topic, const BagMessage& message) {
  ImuMessage imu = decodeImu(message.content, topic.encoding);
  if (is_imu_split_) leaveOutZeroRate(imu);
  const Pose* mounting = mountingOf(topic.name);
  if (mounting == nullptr) return;
  if (!isFinite(imu)) {
    ++summary_.dropped["imu_not_finite"];
    return;
  }
  const Time time = timeOf(imu.header, message);
  const auto observation = imuObservation(imu, time, *mounting);
  order_.add({time, "inertial samples", kSampleBytes,
              [observation](io::RawlogSink& sink) { sink.write(*observation); }});
}

void MessageImport::addOdometry(const BagTopic& topic, const BagMessage& message) {
  const OdometryMessage odometry = decodeOdometry(message.content, topic.encoding);
  const auto T_child_base = rig_.transforms.between(odometry.child_frame, rig_.base_frame);
  const Pose T_odom_base = odometry.T_odom_child * T_child_base.value_or(Pose::Identity());
  const Time time = timeOf(odometry.header, message);
  const Eigen::Vector3d place = T_odom_base.translation();
  const double yaw = yawOf(T_odom_base);
  order_.add({time, "odometry", kSampleBytes, [time, place, yaw](io::RawlogSink& sink) {
                sink.writeOdometry(time, place.x(), place.y(), yaw);
              }});
}

void MessageImport::addScan(const BagTopic& topic, const BagMessage& message) {
  const LaserScanMessage decoded = decodeLaserScan(message.content, topic.encoding);
  const Pose* mounting = mountingOf(topic.name);
  if (mounting == nullptr) return;
  const Time time = timeOf(decoded.header, message);
  const auto scan = scanFrom(decoded, time, *mounting);
  if (!scan) {
    ++summary_.dropped["broken_scan"];
    return;
  }
  const std::string label = topic.name;
  order_.add({time, "laser scans", kSampleBytes + sizeof(float) * scan->ranges.size(),
              [scan = *scan, label](io::RawlogSink& sink) { sink.writeLaser(scan, label); }});
}

void MessageImport::addFix(const BagTopic& topic, const BagMessage& message) {
  const NavSatFixMessage fix = decodeNavSatFix(message.content, topic.encoding);
  if (fix.status < 0) {
    ++summary_.dropped["gnss_without_fix"];
    return;
  }
  if (!(std::abs(fix.latitude_deg) <= 90.0) || !(std::abs(fix.longitude_deg) <= 180.0) ||
      !std::isfinite(fix.altitude_m)) {
    ++summary_.dropped["gnss_no_position"];
    return;
  }
  const Pose* mounting = mountingOf(topic.name);
  if (mounting == nullptr) return;
  const Time time = timeOf(fix.header, message);
  const auto observation = gnssObservation(fix, time, *mounting);
  order_.add({time, "satellite positions", kSampleBytes,
              [observation](io::RawlogSink& sink) { sink.write(*observation); }});
}

void MessageImport::finish() {
  summary_.dropped = dropped(pairing_.waiting());
  if (pairs_ > 0) return;
  const auto& topics = options_.topics;
  const std::string both = (is_stereo_ ? topics.left : topics.color) + " and " +
                           (is_stereo_ ? topics.right : topics.depth);
  std::string reasons;
  for (const auto& [reason, count] : summary_.dropped) {
    reasons += (reasons.empty() ? "; skipped " : ", ") + reason + " " + std::to_string(count);
  }
  if (std::isfinite(pairing_.nearest())) {
    throw InputError(
        "the times of images of " + both + " differ by " +
        std::to_string(static_cast<int>(std::lround(1e3 * pairing_.nearest()))) +
        " ms or more, allowed are " +
        std::to_string(static_cast<int>(1e3 * (is_stereo_ ? kStereoTolerance : kDepthTolerance))) +
        " ms: the cameras must be triggered together" + reasons);
  }
  throw InputError("no pair of images of " + both + reasons);
}

namespace {

/// What was dropped in the frames of a part alone.
class DroppedInPart {
 public:
  explicit DroppedInPart(const BagImportOptions& options) : options_(options) {}

  /// @param index  of the frame
  void add(std::size_t index, std::map<std::string, std::size_t> so_far) {
    if (index + 1 == options_.first_frame) before_ = so_far;
    if (index == options_.last_frame) at_last_ = std::move(so_far);
  }

  /// @param all  at the end of what was read, which may be beyond the part
  [[nodiscard]] std::map<std::string, std::size_t> of(
      const std::map<std::string, std::size_t>& all) const {
    std::map<std::string, std::size_t> part;
    for (const auto& [reason, count] : at_last_.value_or(all)) {
      const auto before = before_.find(reason);
      const std::size_t counted = count - (before == before_.end() ? 0 : before->second);
      if (counted > 0) part[reason] = counted;
    }
    return part;
  }

 private:
  const BagImportOptions& options_;
  std::map<std::string, std::size_t> before_;
  std::optional<std::map<std::string, std::size_t>> at_last_;
};

}  // namespace

BagImportSummary importBag(const std::string& path, const BagImportOptions& options,
                           io::RawlogSink& sink,
                           const std::function<bool(std::size_t, double)>& go_on) {
  BagImportSummary summary;
  const BagRig rig = rigOf(surveyBag(path, options.topics), options);
  summary.notes = rig.notes;
  MessageImport import(options, rig, summary);
  const auto bag = openBag(path);
  DroppedInPart dropped(options);
  std::size_t frames = 0;  // read
  bool is_selected = true;
  const auto write_due = [&](bool at_end) {
    while (is_selected) {
      const auto event = import.next(at_end);
      if (!event) return;
      const bool is_frame = event->kind == nullptr;
      is_selected = !is_frame || frames <= options.last_frame.value_or(frames);
      if (is_selected && frames >= options.first_frame) {
        event->write(sink);
        ++(is_frame ? summary.frames : summary.written[event->kind]);
      }
      if (is_selected && is_frame) dropped.add(frames++, event->dropped);
      summary.was_stopped = is_frame && !go_on(summary.frames, bag->progress());
      if (summary.was_stopped) is_selected = false;
    }
  };
  while (is_selected) {
    const auto message = bag->next();
    if (!message) break;
    import.add(bag->topics()[message->topic], *message);
    write_due(false);
  }
  write_due(true);
  if (!summary.was_stopped) import.finish();
  if (summary.frames == 0 && !summary.was_stopped) {
    throw InputError("--from-index " + std::to_string(options.first_frame) + ": the bag has only " +
                     std::to_string(frames) + " frames");
  }
  summary.dropped = dropped.of(summary.dropped);
  summary.truncation = bag->truncation();
  for (const auto& [reason, count] : bag->skipped()) summary.dropped[reason] += count;
  return summary;
}

}  // namespace headway::bags
