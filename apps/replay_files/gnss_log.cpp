// SPDX-License-Identifier: BSD-3-Clause
#include "gnss_log.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace headway::replay {
namespace {

constexpr double kMaxFrameGap = 1.0;  // [s]
constexpr std::uint32_t kGnssVersion = 1;

/// The pose at a time between two frames.
Pose poseBetween(const slam::FrameEstimate& before, const slam::FrameEstimate& after, Time time) {
  const double ratio = (time - before.time) / (after.time - before.time);
  Pose pose = Pose::Identity();
  pose.linear() = quaternionOf(before.T_map_robot)
                      .slerp(ratio, quaternionOf(after.T_map_robot))
                      .toRotationMatrix();
  pose.translation() =
      (1.0 - ratio) * before.T_map_robot.translation() + ratio * after.T_map_robot.translation();
  return pose;
}

bool isEarlier(const GnssFix& fix, Time time) { return fix.time < time; }

bool isEarlierOnMap(const geo::FixOnMap& a, const geo::FixOnMap& b) {
  return a.fix.time < b.fix.time;
}

template <typename Fix>
void removeEverySecond(std::vector<Fix>& fixes) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < fixes.size(); i += 2) fixes[kept++] = fixes[i];
  fixes.resize(kept);
}

std::vector<geo::FixOnMap> fixesAlong(const std::vector<GnssFix>& fixes,
                                      const slam::TrajectoryVisit& visit) {
  std::vector<GnssFix> sorted = fixes;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const GnssFix& a, const GnssFix& b) { return a.time < b.time; });
  std::vector<geo::FixOnMap> result;
  std::optional<slam::FrameEstimate> before;
  visit([&](const slam::FrameEstimate& after) {
    const auto last = std::exchange(before, after.tracked ? std::optional(after) : std::nullopt);
    if (!last || !before || !(after.time > last->time) || after.time - last->time > kMaxFrameGap) {
      return;
    }
    auto fix = std::lower_bound(sorted.begin(), sorted.end(), last->time, isEarlier);
    for (; fix != sorted.end() && fix->time < after.time; ++fix) {
      result.push_back({*fix, poseBetween(*last, after, fix->time) * fix->antenna});
    }
  });
  return result;
}

geo::FixOnMap readFix(ByteReader& in) {
  geo::FixOnMap read;
  GnssFix& fix = read.fix;
  fix.time = in.finiteValue<double>();
  fix.antenna = in.finiteMatrix<Eigen::Vector3d>();
  fix.latitude_deg = in.finiteValue<double>();
  fix.longitude_deg = in.finiteValue<double>();
  fix.altitude_m = in.finiteValue<double>();
  fix.sigma_m = in.finiteValue<double>();
  read.in_map = in.finiteMatrix<Eigen::Vector3d>();
  if (!(fix.sigma_m > 0.0) || std::abs(fix.latitude_deg) > 90.0) {
    throw InputError("damaged: a satellite fix is none");
  }
  return read;
}

}  // namespace

void GnssLog::add(const std::vector<GnssFix>& fixes) {
  for (const auto& fix : fixes) {
    if (added_++ % step_ != 0) continue;
    fixes_.push_back(fix);
    if (fixes_.size() <= max_fixes_) continue;
    removeEverySecond(fixes_);
    step_ *= 2;
  }
}

void GnssLog::load(const std::string& bytes, const slam::MapView& map) {
  ByteReader in(bytes);
  const auto version = in.value<std::uint32_t>();
  if (version != kGnssVersion) {
    throw InputError("its satellite fixes are of version " + std::to_string(version) +
                     ", this program reads version " + std::to_string(kGnssVersion));
  }
  before_ = in.list<geo::FixOnMap>(readFix);
  if (!in.atEnd()) throw InputError("damaged: there are data after its satellite fixes");
  for (const auto& keyframe : map.keyframes) loaded_[keyframe.id] = keyframe.T_map_robot;
}

std::vector<geo::FixOnMap> GnssLog::onMap(const slam::TrajectoryVisit& trajectory,
                                          const slam::MapView& map) const {
  struct Moved {
    Eigen::Vector3d before;  ///< of the keyframe's robot
    Pose T_now_before;
  };
  std::vector<Moved> keyframes;
  for (const auto& keyframe : map.keyframes) {
    const auto loaded = loaded_.find(keyframe.id);
    if (loaded == loaded_.end()) continue;
    keyframes.push_back({loaded->second.translation(),
                         keyframe.T_map_robot * loaded->second.inverse(Eigen::Isometry)});
  }
  std::vector<geo::FixOnMap> fixes = before_;
  for (geo::FixOnMap& fix : fixes) {
    const auto nearest = std::min_element(
        keyframes.begin(), keyframes.end(), [&fix](const Moved& a, const Moved& b) {
          return (a.before - fix.in_map).squaredNorm() < (b.before - fix.in_map).squaredNorm();
        });
    if (nearest != keyframes.end()) fix.in_map = nearest->T_now_before * fix.in_map;
  }
  const auto own = fixesAlong(fixes_, trajectory);
  fixes.insert(fixes.end(), own.begin(), own.end());
  std::stable_sort(fixes.begin(), fixes.end(), isEarlierOnMap);
  return fixes;
}

std::string gnssBytes(std::vector<geo::FixOnMap> fixes) {
  while (fixes.size() > GnssLog::kMaxFixes) removeEverySecond(fixes);
  ByteWriter out;
  out.value(kGnssVersion);
  out.count(fixes.size());
  for (const auto& [fix, in_map] : fixes) {
    out.value(fix.time);
    out.matrix(fix.antenna);
    out.value(fix.latitude_deg);
    out.value(fix.longitude_deg);
    out.value(fix.altitude_m);
    out.value(fix.sigma_m);
    out.matrix(in_map);
  }
  return std::move(out.bytes);
}

}  // namespace headway::replay
