// SPDX-License-Identifier: BSD-3-Clause
// The occupancy grid as the sum of ground scans, of which one a place and direction is stored.
#include <headway/core/error.h>
#include <headway/map/static_grid.h>

#include <algorithm>
#include <utility>

#include "evidence_grid.h"
#include "stored_values.h"

namespace headway::map {
namespace {

/// The part of a segment of ground within a rectangle of the map; nullopt if there is none.
///
/// @see  Liang & Barsky 1984, "A new concept and method for line clipping"
std::optional<GroundScan::Free> clipped(const GroundScan::Free& piece, const Pose& T_map_robot,
                                        const Eigen::AlignedBox2d& area) {
  const Eigen::Vector2d from = (T_map_robot * piece.from.cast<double>()).head<2>();
  const Eigen::Vector2d way = (T_map_robot * piece.to.cast<double>()).head<2>() - from;
  double first = 0.0;
  double last = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double low = area.min()[axis] - from[axis];
    const double high = area.max()[axis] - from[axis];
    if (way[axis] == 0.0) {
      if (low > 0.0 || high < 0.0) return std::nullopt;
      continue;
    }
    first = std::max(first, std::min(low / way[axis], high / way[axis]));
    last = std::min(last, std::max(low / way[axis], high / way[axis]));
  }
  if (first > last) return std::nullopt;
  const Eigen::Vector3f along = piece.to - piece.from;
  return GroundScan::Free{piece.from + static_cast<float>(first) * along,
                          piece.from + static_cast<float>(last) * along};
}

/// What a scan contains within a rectangle of the map; segments are clipped.
GroundScan cropped(const GroundScan& scan, const Pose& T_map_robot,
                   const Eigen::AlignedBox2d& area) {
  GroundScan inside;
  const auto add_free = [&](const auto& from, auto& to) {
    for (const auto& piece : from) {
      if (const auto part = clipped(piece, T_map_robot, area)) to.push_back(*part);
    }
  };
  const auto add_obstacles = [&](const auto& from, auto& to) {
    for (const auto& obstacle : from) {
      const Eigen::Vector2d foot =
          (T_map_robot * obstacle.foot.template cast<double>()).template head<2>();
      if (area.contains(foot)) to.push_back(obstacle);
    }
  };
  add_free(scan.free, inside.free);
  add_free(scan.laser_passed, inside.laser_passed);
  add_obstacles(scan.obstacles, inside.obstacles);
  add_obstacles(scan.laser_obstacles, inside.laser_obstacles);
  return inside;
}

constexpr double kDrivenM = 5.0;  // farther apart, the way between scans is unknown
constexpr double kSeenM = 30.0;   // of ground around a place, for a first estimate of the area
// A scan that moved by less than a quarter of the usual cell stays where it was: at the distance of
// most ground, 15 m, the angle is as much.
constexpr double kMovedM = 0.05, kTurned = 0.003;
constexpr std::uint8_t kVersion = 2;  // of save(); one more with laser scans

}  // namespace

void RobotFootprint::describe(Params::Section section) {
  section.add("length_m", length_m, 0.0, 30.0, "m",
              "Length of the robot about its origin; the ground under it is free");
  section.add("width_m", width_m, 0.0, 30.0, "m", "Width of the robot about its origin");
}

void StaticGridParams::describe(Params::Section section) {
  section.user().add("resolution", resolution_m, 0.05, 2.0, "m",
                     "Side of a grid cell; the planner's resolution");
  section.add("spacing_m", spacing_m, 0.0, 10.0, "m",
              "Distance between places of which a ground scan is stored; 0: derived from the rig");
}

StaticGrid::StaticGrid(const StaticGridParams& params)
    : params_(validated(params)),
      resolution_m_(params.resolution_m),
      evidence_(std::make_unique<EvidenceGrid>(params.resolution_m, params.footprint)) {
  if (params_.spacing_m <= 0.0) params_.spacing_m = 1.0;
}

StaticGrid::~StaticGrid() = default;
StaticGrid::StaticGrid(StaticGrid&&) noexcept = default;
StaticGrid& StaticGrid::operator=(StaticGrid&&) noexcept = default;

void StaticGrid::add(const Pose& T_map_robot, const Pose& T_odom_robot, GroundScan scan) {
  const Place place = scanPlace(T_map_robot, params_.spacing_m);
  const auto same_place = scans_.find(place);
  const bool laser_only = scan.hasLaser() && !scan.hasStereo();
  if (laser_only && same_place != scans_.end() && same_place->second.scan.hasStereo()) {
    return;  // obstacles that no laser sees remain
  }
  if (last_ && last_->place != place) before_ = last_->T_odom_robot;
  last_ = Passed{place, T_odom_robot};
  if (before_) {
    const Eigen::Vector3d before = T_odom_robot.inverse() * before_->translation();
    if (before.norm() < kDrivenM) {
      scan.free.push_back({before.cast<float>(), Eigen::Vector3f::Zero()});
    }
  }
  StoredScan stored;
  stored.pose.T_map_robot = T_map_robot;
  stored.scan = std::move(scan);
  keyframes_.attach(stored.pose);
  replace(place, std::move(stored));
}

void StaticGrid::add(const StaticGrid& other, std::int64_t keyframe_shift) {
  for (const auto& [place, scan] : other.scans_) {
    StoredScan stored = scan;
    if (stored.pose.anchor.valid()) stored.pose.anchor.value += keyframe_shift;
    replace(scanPlace(stored.pose.T_map_robot, params_.spacing_m), std::move(stored));
  }
}

void StaticGrid::crop(const Eigen::AlignedBox2d& area) {
  StaticGrid inside(params_);
  for (auto& [place, stored] : scans_) {
    const Eigen::Vector2d at = stored.pose.T_map_robot.translation().head<2>();
    if (!area.contains(at)) continue;
    StoredScan cut = std::move(stored);
    cut.scan = cropped(cut.scan, cut.pose.T_map_robot, area);
    inside.replace(place, std::move(cut));
  }
  inside.keyframes_ = std::move(keyframes_);
  *this = std::move(inside);
}

void StaticGrid::replace(const Place& place, StoredScan stored) {
  const auto [kept, is_new] = scans_.try_emplace(place);
  if (!is_new) evidence_->remove(kept->second.scan, kept->second.pose.T_map_robot);
  kept->second = std::move(stored);
  enter(kept->second);
}

void StaticGrid::enter(const StoredScan& stored) {
  places_.extend(stored.pose.T_map_robot.translation().head<2>());
  const Eigen::Vector2d sides = places_.sizes().array() + 2.0 * kSeenM;
  double resolution = resolution_m_;
  while (sides.prod() > EvidenceGrid::kMaxCells * resolution * resolution) resolution *= 2.0;
  if (resolution == resolution_m_) {
    if (evidence_->add(stored.scan, stored.pose.T_map_robot)) return;
    resolution *= 2.0;  // its scans reach farther than most
  }
  while (!enterAll(resolution)) resolution *= 2.0;
}

bool StaticGrid::enterAll(double resolution_m) {
  resolution_m_ = resolution_m;
  evidence_ = std::make_unique<EvidenceGrid>(resolution_m, params_.footprint);
  if (standing_ && !evidence_->add({}, *standing_)) return false;
  return std::all_of(scans_.begin(), scans_.end(), [this](const auto& item) {
    return evidence_->add(item.second.scan, item.second.pose.T_map_robot);
  });
}

void StaticGrid::standAt(const Pose& T_map_robot) {
  if (standing_) evidence_->remove({}, *standing_);
  standing_ = T_map_robot;
  if (evidence_->add({}, T_map_robot)) return;
  double resolution = resolution_m_;
  do resolution *= 2.0;
  while (!enterAll(resolution));
}

std::optional<Pose> StaticGrid::movedPose(StoredScan& stored) const {
  return keyframes_.movedPose(stored.pose, kMovedM, kTurned);
}

void StaticGrid::move(StoredScan& stored, const Pose& T_map_robot) {
  evidence_->remove(stored.scan, stored.pose.T_map_robot);
  stored.pose.T_map_robot = T_map_robot;
  enter(stored);
}

void StaticGrid::follow(const SharedChunks<slam::KeyframeView>& keyframes) {
  keyframes_.update(keyframes);
  for (auto& [place, stored] : scans_) {
    if (const auto T_map_robot = movedPose(stored)) move(stored, *T_map_robot);
  }
}

void StaticGrid::follow(const SharedChunks<slam::KeyframeView>& keyframes, std::size_t max_scans) {
  keyframes_.update(keyframes);
  to_move_.clear();
  for (auto& [place, stored] : scans_) {
    if (movedPose(stored)) to_move_.push_back(place);
  }
  std::sort(to_move_.begin(), to_move_.end(), [this](const Place& a, const Place& b) {
    return std::pair(scans_.at(a).pose.anchor, a) < std::pair(scans_.at(b).pose.anchor, b);
  });
  followMore(max_scans);
}

void StaticGrid::followMore(std::size_t max_scans) {
  for (std::size_t count = 0; count < max_scans && !to_move_.empty(); ++count) {
    StoredScan& stored = scans_.at(to_move_.back());  // scans are replaced, never removed
    to_move_.pop_back();
    if (const auto T_map_robot = movedPose(stored)) move(stored, *T_map_robot);
  }
}

mrpt::maps::COccupancyGridMap2D::Ptr StaticGrid::grid() const { return evidence_->grid(); }

std::string StaticGrid::save() const {
  ByteWriter out;
  const bool with_laser = std::any_of(scans_.begin(), scans_.end(),
                                      [](const auto& item) { return item.second.scan.hasLaser(); });
  out.value(static_cast<std::uint8_t>(kVersion + (with_laser ? 1 : 0)));
  out.count(scans_.size());
  for (const auto& [place, stored] : scans_) {
    out.values(place);
    write(out, stored.pose);
    write(out, stored.scan, with_laser);
  }
  return std::move(out.bytes);
}

void StaticGrid::load(const std::string& bytes) {
  try {
    *this = loaded(bytes);
  } catch (const InputError& error) {
    throw InputError(std::string("its ground scans cannot be read: ") + error.what());
  }
}

StaticGrid StaticGrid::loaded(const std::string& bytes) const {
  ByteReader in(bytes);
  StaticGrid loaded(params_);
  const auto version = in.value<std::uint8_t>();
  if (version != kVersion && version != kVersion + 1) {
    throw InputError("they are of another version");
  }
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    Place place{};
    in.values(place);
    StoredScan& stored = loaded.scans_[place];
    stored.pose = readAnchoredPose(in);
    stored.scan = readGroundScan(in, version > kVersion);
    loaded.enter(stored);
  }
  if (!in.atEnd()) throw InputError("damaged: there are data after their end");
  return loaded;
}

}  // namespace headway::map
