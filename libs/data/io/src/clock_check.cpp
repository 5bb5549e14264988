// SPDX-License-Identifier: BSD-3-Clause
#include "clock_check.h"

#include <cmath>
#include <cstdio>

namespace headway::io {
namespace {

constexpr double kMaxDifference = 1.0;   // latencies are shorter [s]
constexpr int kMinImages = 10;           // until a difference is reported
constexpr std::size_t kMaxSensors = 64;  // labels of broken recordings may be arbitrary

std::string textOf(const std::string& sensor, double difference) {
  char amount[64];
  std::snprintf(amount, sizeof amount, "%.3f s %s", std::abs(difference),
                difference > 0.0 ? "after" : "before");
  return "the times of sensor '" + sensor + "' are " + amount +
         " those of the images that arrive with them, so that it cannot be used; synchronise the "
         "clocks of its computer and of the camera's, or let both drivers use the time of arrival";
}

/// The label without other characters than ASCII's, for terminals and JSON.
std::string asciiOf(std::string label) {
  for (char& c : label) {
    if (c < ' ' || c > '~') c = '?';
  }
  return label;
}

}  // namespace

void ClockCheck::addSample(const std::string& label, Time time) {
  const std::string sensor = asciiOf(label);
  if (sensors_.size() < kMaxSensors || sensors_.count(sensor) > 0) sensors_[sensor].newest = time;
}

void ClockCheck::addImage(std::size_t frame, Time time, Warnings& warnings) {
  for (auto& [name, sensor] : sensors_) {
    if (!sensor.newest) continue;
    const double difference = *sensor.newest - time;
    sensor.images = std::abs(difference) > kMaxDifference ? sensor.images + 1 : 0;
    if (sensor.images >= kMinImages) {
      addWarning("clocks_differ_" + name, frame, textOf(name, difference), warnings);
    }
    sensor.newest.reset();
  }
}

}  // namespace headway::io
