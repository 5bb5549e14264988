// SPDX-License-Identifier: BSD-3-Clause
#include "time_check.h"

#include <headway/core/mrpt_pose.h>
#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace headway::import {
namespace {

constexpr std::size_t kMaxSamples = 200000;
constexpr std::size_t kMaxSensors = 200;
constexpr double kPairTolerance = 0.01;  // of headway's readers [s]
constexpr double kMaxRate = 1000.0;      // of turns [rad/s]
constexpr double kSlowSensor = 0.2;      // latency after which places no longer fit the images [s]
constexpr double kOtherClock = 1.0;      // of headway's readers: latencies are shorter [s]

bool isAnyImage(const mrpt::obs::CObservation& observation) {
  return dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr ||
         dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation) != nullptr ||
         dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation) != nullptr;
}

std::string classNameOf(const mrpt::obs::CObservation& observation) {
  const std::string name = observation.GetRuntimeClass()->className;
  return name.substr(name.rfind(':') + 1);
}

/// Distances of times from the nearest of others, both ascending, with their sign.
std::vector<double> offsets(const std::vector<Time>& times, const std::vector<Time>& others) {
  std::vector<double> result;
  for (const Time time : times) {
    const auto after = std::lower_bound(others.begin(), others.end(), time);
    double best = after != others.end() ? *after - time : 1e9;
    if (after != others.begin() && time - *(after - 1) < std::abs(best)) best = *(after - 1) - time;
    result.push_back(best);
  }
  return result;
}

/// States how far a sensor's times are from those of the images that arrive with them.
void addClock(const std::vector<float>& offsets, CheckItem& item) {
  const double offset = median(std::vector<double>(offsets.begin(), offsets.end()));
  item.value += formatted(", %+.3f s from the images", offset);
  const Verdict verdict = verdictOf(std::abs(offset), kSlowSensor, kOtherClock);
  if (verdict <= item.verdict) return;
  item.verdict = verdict;
  item.advice =
      "its times are not those of the images that arrive with it: use one clock (chrony), and "
      "times of capture";
}

}  // namespace

void TimeCheck::add(const mrpt::obs::CObservation& observation) {
  const std::string class_name = classNameOf(observation);
  const auto& label = observation.sensorLabel;
  const std::pair<std::string, std::string> key{label.empty() ? class_name : label, class_name};
  if (sensors_.size() >= kMaxSensors && sensors_.count(key) == 0) {
    ++of_further_sensors_;
    return;
  }
  Sensor& sensor = sensors_[key];
  const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation);
  sensor.is_needed = isAnyImage(observation) || imu != nullptr;
  ++sensor.count;
  images_ += isAnyImage(observation) ? 1 : 0;
  if (observation.timestamp == INVALID_TIMESTAMP) {
    ++sensor.without_time;
    return;
  }
  const Time time = io::timeFrom(observation.timestamp);
  if (sensor.count - sensor.without_time > 1) {
    if (time <= sensor.last) ++sensor.backwards;
    if (sensor.intervals.size() < kMaxSamples) {
      sensor.intervals.push_back(static_cast<float>(time - sensor.last));
    }
  }
  sensor.last = time;
  sensor.newest = time;
  if (isAnyImage(observation)) compareClocks(key, time);
  if (isAnyImage(observation) && sensor.times.size() < kMaxSamples) sensor.times.push_back(time);
  if (imu != nullptr) addTurn(time, *imu);
}

/// How far the times of what arrived between two images are from the time between these.
void TimeCheck::compareClocks(const Name& image, Time time) {
  if (!first_camera_) first_camera_ = image;
  if (*first_camera_ != image) return;
  const auto before = std::exchange(last_image_, time);
  for (auto& [name, sensor] : sensors_) {
    const auto newest = std::exchange(sensor.newest, std::nullopt);
    if (!before || !newest || name == image || sensor.offsets.size() >= kMaxSamples) continue;
    const Time nearest = std::clamp(*newest, std::min(*before, time), std::max(*before, time));
    sensor.offsets.push_back(static_cast<float>(*newest - nearest));
  }
}

void TimeCheck::addTurn(Time time, const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  if (turns_.size() >= kMaxSamples || !imu.has(IMU_WX) || !imu.has(IMU_WY) || !imu.has(IMU_WZ)) {
    return;
  }
  const Eigen::Vector3d rate = fromMrpt(imu.sensorPose).linear() *
                               Eigen::Vector3d(imu.get(IMU_WX), imu.get(IMU_WY), imu.get(IMU_WZ));
  if (rate.norm() < kMaxRate) turns_.push_back({time, rate});
}

CheckItem TimeCheck::rateOf(const Name& name, const Sensor& sensor) {
  CheckItem item{"times of " + name.first + " (" + name.second + ")", "", Verdict::kOk, ""};
  if (sensor.without_time > 0) {
    item.value = formatted("%zu of %zu without a time", sensor.without_time, sensor.count);
    item.verdict = Verdict::kBad;
    item.advice = "the driver sets no timestamps: set them to the capture's time";
    return item;
  }
  const std::vector<double> intervals(sensor.intervals.begin(), sensor.intervals.end());
  const double usual = median(intervals);
  const double longest =
      intervals.empty() ? 0.0 : *std::max_element(intervals.begin(), intervals.end());
  const auto gaps = std::count_if(intervals.begin(), intervals.end(),
                                  [&](double interval) { return interval > 2.5 * usual; });
  item.value = formatted("%zu, %.2f Hz, longest gap %.3f s, %zd gaps", sensor.count,
                         usual > 0.0 ? 1.0 / usual : 0.0, longest, gaps);
  const double ratio =
      static_cast<double>(gaps) / std::max(1.0, static_cast<double>(intervals.size()));
  if (sensor.backwards > 0) {
    item.verdict = Verdict::kBad;
    item.advice = formatted(
        "%zu times are not after the one before: the clock was set, or two sensors "
        "share a label; slew clocks (chrony), give labels",
        sensor.backwards);
  } else if (gaps > 0) {
    const bool is_bad = sensor.is_needed && (longest > 1.0 || ratio > 0.05);
    item.verdict = is_bad ? Verdict::kBad : Verdict::kWarning;
    item.advice = "samples are missing: check bandwidth, disk and driver";
  }
  if (!sensor.offsets.empty()) addClock(sensor.offsets, item);
  return item;
}

std::vector<CheckItem> TimeCheck::items() const {
  std::vector<CheckItem> items;
  std::vector<std::pair<std::string, const Sensor*>> single;  // images, with their labels
  for (const auto& [name, sensor] : sensors_) {
    if (name.first.rfind("truth_", 0) != 0) items.push_back(rateOf(name, sensor));
    if (name.second == "CObservationImage" && isChosen(name.first)) {
      single.emplace_back(name.first, &sensor);
    }
  }
  if (of_further_sensors_ > 0) {
    items.push_back({"further sensors", formatted("%zu observations", of_further_sensors_),
                     Verdict::kWarning, formatted("only %zu sensors are checked", kMaxSensors)});
  }
  // Which of more than two belong together, --sensor-label tells.
  if (single.size() == 2 && !single[0].second->times.empty() && !single[1].second->times.empty()) {
    items.push_back(pairOffset(single[0].first + " and " + single[1].first,
                               offsets(single[0].second->times, single[1].second->times)));
  }
  return items;
}

/// Whether images with this label are those to check.
bool TimeCheck::isChosen(const std::string& label) const {
  return sensor_label_.empty() ||
         ("," + sensor_label_ + ",").find("," + label + ",") != std::string::npos;
}

CheckItem TimeCheck::pairOffset(const std::string& labels, std::vector<double> distances) {
  const double middle = median(distances);
  for (double& distance : distances) distance = std::abs(distance);
  const double usual = median(distances), most = percentile(distances, 0.95);
  CheckItem item{"times between " + labels,
                 formatted("median %+.1f ms, 95 %% within %.1f ms", 1e3 * middle, 1e3 * most),
                 verdictOf(most, 0.002, kPairTolerance), ""};
  if (usual > kPairTolerance) {
    item.advice = formatted(
        "the images of a pair are %.0f ms apart, allowed are %.0f ms: trigger both cameras "
        "together",
        1e3 * usual, 1e3 * kPairTolerance);
  } else if (item.verdict != Verdict::kOk) {
    item.advice = "the cameras are not triggered together: moving things get a wrong depth";
  }
  return item;
}

}  // namespace headway::import
