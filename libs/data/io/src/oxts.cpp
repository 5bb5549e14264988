// SPDX-License-Identifier: BSD-3-Clause
#include "oxts.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "text_rows.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kOxtsFields = 30;
constexpr double kEarthRadius_m = 6378137.0;  // of the Mercator projection
constexpr double kMaxOxtsGap_s = 0.3;
constexpr double kMaxExtrapolation_s = 0.05;
constexpr double kRadPerDegree = M_PI / 180.0;

OxtsPacket readPacket(const std::string& path) {
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; an OXTS packet has 30 values");
  rows.requireSize(kOxtsFields, "an OXTS packet");
  for (std::size_t i = 0; i < 23; ++i) {
    if (!std::isfinite(rows.number(i)))
      rows.fail("value " + std::to_string(i + 1) + " is not finite");
  }
  OxtsPacket packet;
  packet.latitude_deg = rows.number(0);
  packet.longitude_deg = rows.number(1);
  packet.altitude_m = rows.number(2);
  if (std::abs(packet.latitude_deg) >= 90.0) rows.fail("the latitude is not between -90 and 90");
  packet.roll = rows.number(3);
  packet.pitch = rows.number(4);
  packet.yaw = rows.number(5);
  packet.velocity = {rows.number(7), rows.number(6), rows.number(10)};  // ve, vn, vu
  packet.acceleration = {rows.number(11), rows.number(12), rows.number(13)};
  packet.angular_velocity = {rows.number(17), rows.number(18), rows.number(19)};
  packet.satellites = static_cast<int>(rows.integer(26));
  packet.position_sigma_m = rows.number(23);
  return packet;
}

/// Position in metres, x east, y north.
Eigen::Vector3d mercator(const OxtsPacket& packet, double scale) {
  const double radius = scale * kEarthRadius_m;
  const double half_colatitude = (90.0 + packet.latitude_deg) * kRadPerDegree / 2.0;
  return {radius * packet.longitude_deg * kRadPerDegree,
          radius * std::log(std::tan(half_colatitude)), packet.altitude_m};
}

Eigen::Matrix3d rotationOf(const OxtsPacket& packet) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(packet.yaw, Eigen::Vector3d::UnitZ()) *
          AngleAxisd(packet.pitch, Eigen::Vector3d::UnitY()) *
          AngleAxisd(packet.roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

std::vector<OxtsPacket> readOxts(const std::string& folder,
                                 std::map<std::string, std::size_t>& dropped) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "data")) {
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  const auto times = readKittiTimestamps((fs::path(folder) / "timestamps.txt").string());
  std::vector<OxtsPacket> packets;
  for (const auto& file : files) {
    const auto number = parseNumber(file.stem().string());
    if (!number || !(*number >= 0.0) || *number >= static_cast<double>(times.size())) {
      ++dropped["oxts_without_time"];
      continue;
    }
    OxtsPacket packet = readPacket(file.string());
    packet.time = times[static_cast<std::size_t>(*number)];
    if (!packets.empty() && packet.time <= packets.back().time) {
      ++dropped["oxts_time_backwards"];
      continue;
    }
    packets.push_back(packet);
  }
  return packets;
}

std::vector<Stamped<Pose>> oxtsPath(const std::vector<OxtsPacket>& packets, OxtsPath path) {
  std::vector<Stamped<Pose>> poses;
  if (packets.empty()) return poses;
  const double scale = std::cos(packets.front().latitude_deg * kRadPerDegree);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const auto& packet = packets[k];
    if (path == OxtsPath::kPositions) {
      position = mercator(packet, scale);
    } else if (k > 0) {
      const auto& previous = packets[k - 1];
      position += 0.5 * (packet.time - previous.time) * (packet.velocity + previous.velocity);
    }
    Pose pose = Pose::Identity();
    pose.linear() = rotationOf(packet);
    pose.translation() = position;
    poses.push_back({packet.time, pose});
  }
  return poses;
}

std::optional<Pose> oxtsPoseAt(const std::vector<Stamped<Pose>>& path, Time time) {
  if (path.size() < 2) return std::nullopt;
  if (time < path.front().time - kMaxExtrapolation_s) return std::nullopt;
  if (time > path.back().time + kMaxExtrapolation_s) return std::nullopt;
  auto after = std::lower_bound(path.begin() + 1, path.end() - 1, time,
                                [](const auto& pose, Time t) { return pose.time < t; });
  const auto& [end_time, end] = *after;
  const auto& [start_time, start] = *(after - 1);
  if (end_time - start_time > kMaxOxtsGap_s) return std::nullopt;
  const double ratio = (time - start_time) / (end_time - start_time);
  Pose pose = start;
  pose.translation() += ratio * (end.translation() - start.translation());
  pose.linear() =
      start.linear() * expSo3(ratio * logSo3(start.linear().transpose() * end.linear()));
  return pose;
}

std::vector<Time> readKittiTimestamps(const std::string& path) {
  std::vector<Time> times;
  TextRows rows(path);
  while (rows.next()) {
    std::tm date{};
    double second = 0.0;
    const bool has_two = rows.size() == 2;
    const bool is_date = has_two && std::sscanf(rows.fields()[0].c_str(), "%4d-%2d-%2d",
                                                &date.tm_year, &date.tm_mon, &date.tm_mday) == 3;
    const bool is_time = has_two && std::sscanf(rows.fields()[1].c_str(), "%2d:%2d:%lf",
                                                &date.tm_hour, &date.tm_min, &second) == 3;
    if (!is_date || !is_time) rows.fail("is not a time 'YYYY-MM-DD hh:mm:ss.sss'");
    date.tm_year -= 1900;
    date.tm_mon -= 1;
    times.push_back(static_cast<double>(timegm(&date)) + second);
  }
  return times;
}

}  // namespace headway::io
