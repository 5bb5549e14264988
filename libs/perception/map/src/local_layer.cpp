// SPDX-License-Identifier: BSD-3-Clause
// What is blocked and what is free around the robot now, by the newest frames.
#include <headway/map/local_layer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::map {
namespace {

using Eigen::Vector2d;

struct LocalEvidence {
  // Logarithms of odds of one column of the disparity image. Neighbouring columns share half of the
  // pixels that were matched, so that each counts half of ln(0.6 / 0.02), a surface that is matched
  // against one matched where nothing is, and of ln(0.98 / 0.4).
  double hit = 1.7;
  double pass = 0.45;
  double beam_hits = 3.0;       ///< columns that a beam of a laser, which hardly errs, counts
  double most_per_frame = 2.0;  ///< matching errors are alike in a whole frame, and another in
                                ///< the next; what is hit in both counts in full
  double most = 3.0;            ///< so that one frame can say that ground is free no more
  double known = 1.0;           ///< odds of 2.7 to 1
  double gap_ratio = 1.5;       ///< of the camera's height: a gap that ground scans bridge, too
  int free_round_gap = 5;       ///< of the eight cells round one that no column met
  double in_view_s = 0.5;       ///< of decay: two frames at 5 Hz may be missed
  /// Of the ray to ground that is seen: free ground begins where the lowest obstacle would hide it.
  double height_error_m = 0.15;
  // Of people who walk fast.
  double speed_mps = 1.5;
  double radius_m = 0.3;
  int cells_of_person = 3;  ///< at least, within the radius
  double follow_s = 0.5;    ///< in which the velocity of what comes is measured
  double follow_least_s = 0.2;
  double was_free_s = 2.0;    ///< before: what is blocked now has come
  double stands_ratio = 3.0;  ///< of the time for which what had not come counts
};
constexpr LocalEvidence kLocal;

struct LocalSize {
  double least_reach_m = 3.0;
  int cells_to_reach = 80;
  double least_cell_m = 0.05;
  double most_cell_m = 0.25;
};
constexpr LocalSize kSize;

}  // namespace

/// What one frame says about each cell.
class LocalLayer::Frame {
 public:
  explicit Frame(const LocalLayer& layer) : layer_(layer), cells_(layer.cells_.size()) {}

  void addPass(const Vector2d& from, const Vector2d& to) {
    const double step = 0.5 * layer_.cell_m_, length = (to - from).norm();
    const int steps = static_cast<int>(length / step);
    const Vector2d way = length > 0.0 ? Vector2d((to - from) / length) : Vector2d(Vector2d::Zero());
    std::size_t last = cells_.size();
    for (int i = 0; i <= steps; ++i) {
      Evidence* cell = at(from + i * step * way, last);
      if (cell != nullptr) cell->passes += 1.0F;
    }
  }

  /// Spread along the line of sight by the uncertainty of its distance.
  void addHit(const Vector2d& place, const Vector2d& from, const GroundScan::Obstacle& obstacle,
              double weight) {
    const Vector2d way = (place - from).normalized();
    const double sigma_m = static_cast<double>(obstacle.sigma_m);
    const double step = layer_.cell_m_;
    const int steps = static_cast<int>(std::ceil(2.0 * sigma_m / step));
    double sum = 0.0;
    for (int i = -steps; i <= steps; ++i) sum += density(i * step, sigma_m);
    for (int i = -steps; i <= steps; ++i) {
      std::size_t last = cells_.size();
      Evidence* cell = at(place + i * step * way, last);
      const double share = density(i * step, sigma_m) / sum;
      if (cell == nullptr) continue;
      cell->hits += static_cast<float>(weight * share);
      cell->heights.include({obstacle.low_m, obstacle.high_m});
    }
  }

  [[nodiscard]] const std::vector<Evidence>& cells() const { return cells_; }

 private:
  static double density(double distance, double sigma_m) {
    const double sigmas = distance / std::max(1e-3, sigma_m);
    return std::exp(-0.5 * sigmas * sigmas);
  }

  /// The cell at a place unless it is the last one, or beyond the layer: then null.
  Evidence* at(const Vector2d& place, std::size_t& last) {
    const Vector2d offset = place - layer_.T_odom_robot_.translation().head<2>();
    if (!(offset.cwiseAbs().maxCoeff() < layer_.reach_m_)) return nullptr;
    const std::size_t index =
        layer_.indexOf(static_cast<int>(std::floor(place.x() / layer_.cell_m_)),
                       static_cast<int>(std::floor(place.y() / layer_.cell_m_)));
    return std::exchange(last, index) == index ? nullptr : &cells_[index];
  }

  const LocalLayer& layer_;
  std::vector<Evidence> cells_;
};

void LocalLayer::Heights::include(const Heights& other) {
  low = high > 0.0F ? std::min(low, other.low) : other.low;
  high = std::max(high, other.high);
}

LocalLayer::LocalLayer(double reach_m, const RobotFootprint& footprint, double nearest_m)
    : reach_m_(std::max(reach_m, kSize.least_reach_m)),
      nearest_m_(nearest_m),
      cell_m_(std::clamp(reach_m_ / kSize.cells_to_reach, kSize.least_cell_m, kSize.most_cell_m)),
      size_(2 * static_cast<int>(std::ceil(reach_m_ / cell_m_)) + 2),
      footprint_(footprint),
      cells_(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_)) {}

std::size_t LocalLayer::indexOf(int x, int y) const {
  const auto wrapped = [this](int i) {
    return static_cast<std::size_t>(((i % size_) + size_) % size_);
  };
  return wrapped(y) * static_cast<std::size_t>(size_) + wrapped(x);
}

const LocalLayer::Cell* LocalLayer::find(const Vector2d& place) const {
  const Vector2d offset = place - T_odom_robot_.translation().head<2>();
  if (!is_started_ || !(offset.cwiseAbs().maxCoeff() < reach_m_)) return nullptr;
  const int x = static_cast<int>(std::floor(place.x() / cell_m_));
  const int y = static_cast<int>(std::floor(place.y() / cell_m_));
  const Cell& cell = cells_[indexOf(x, y)];
  return cell.x == x && cell.y == y && cell.odds != 0.0F ? &cell : nullptr;
}

bool LocalLayer::isInView(const Vector2d& place) const {
  if (!camera_) return false;
  const Vector2d offset = place - T_odom_robot_.translation().head<2>();
  if (!(offset.norm() < reach_m_)) return false;
  const Eigen::Vector3d ground = T_cam_odom_ * Eigen::Vector3d(place.x(), place.y(), ground_z_);
  if (ground.z() < nearest_m_) return false;
  const auto uvd = project(ground, *camera_);
  if (!uvd) return false;
  const double first = camera_->isDepthCamera() ? 0.0 : uvd->z();  // that the right camera sees
  return uvd->x() >= first && uvd->x() < camera_->width && uvd->y() < camera_->height;
}

bool LocalLayer::isAtEdgeOfView(const Vector2d& place) const {
  for (const double x : {-kLocal.radius_m, kLocal.radius_m}) {
    for (const double y : {-kLocal.radius_m, kLocal.radius_m}) {
      if (!isInView(place + Vector2d(x, y))) return true;
    }
  }
  return false;
}

double LocalLayer::oddsOf(const Cell& cell, bool in_view, Time now, double hold_s) const {
  const double age_s = std::max(0.0, now - start_ - static_cast<double>(cell.seen_s));
  const bool stood = cell.odds > 0.0F && cell.hit_s - cell.free_s >= kLocal.was_free_s;
  const double hold = stood ? kLocal.stands_ratio * hold_s : hold_s;
  return cell.odds *
         std::exp(-age_s / (in_view ? kLocal.in_view_s : std::max(kLocal.in_view_s, hold)));
}

/// Whether it may be at a place after a time, if it walks on.
bool LocalLayer::Intruder::isWithin(double seconds, const Vector2d& at, double caution) const {
  const double reach_m = kLocal.radius_m + caution * spread_mps * seconds;
  return (at - place - seconds * velocity).norm() < reach_m;
}

/// By what came since a time, when the place was seen to be free.
bool LocalLayer::mayBeEntered(const Vector2d& place, float since_s, Time now,
                              double caution) const {
  return std::any_of(intruders_.begin(), intruders_.end(), [&](const Intruder& one) {
    const double age_s = now - one.time;
    const bool is_older = static_cast<float>(one.time - start_) < since_s;
    if (is_older || age_s > caution * kLocalHold_s) return false;
    if (one.isWithin(age_s, place, caution)) return true;
    const Vector2d way = age_s * one.velocity, offset = place - one.place;
    const double ratio = offset.dot(way) / std::max(1e-9, way.squaredNorm());
    return (offset - std::clamp(ratio, 0.0, 1.0) * way).norm() < kLocal.radius_m;  // it stopped
  });
}

/// What left the view, going on, unless it is seen not to be where it would be now.
bool LocalLayer::mayCome(const Vector2d& place, Time now, double within_s, double caution) const {
  return std::any_of(intruders_.begin(), intruders_.end(), [&](const Intruder& one) {
    const double age_s = now - one.time;
    if (age_s > caution * kLocalHold_s) return false;
    if (!one.isWithin(age_s + within_s, place, caution)) return false;
    const Cell* there = find(one.place + age_s * one.velocity);
    return there == nullptr || there->free_s < static_cast<float>(one.time - start_);
  });
}

LocalState LocalLayer::at(const Vector2d& place, Time now, double caution, double within_s) const {
  const bool in_view = isInView(place);
  const Cell* cell = find(place);
  const double odds = cell == nullptr ? 0.0 : oddsOf(*cell, in_view, now, caution * kLocalHold_s);
  if (odds >= kLocal.known) return LocalState::kBlocked;
  const bool is_free = odds <= -kLocal.known;
  const float since_s = is_free ? cell->seen_s : 0.0F;
  if (!in_view && mayBeEntered(place, since_s, now, caution)) return LocalState::kEntered;
  if (within_s > 0.0 && mayCome(place, now, within_s, caution)) return LocalState::kEntered;
  if (is_free) return LocalState::kFree;
  if (in_view && isGap(place, now)) return LocalState::kFree;
  return in_view ? LocalState::kUnknown : LocalState::kNotInView;
}

bool LocalLayer::wasSeenFree(const Vector2d& place, Time since, Time now, double caution) const {
  if (at(place, now, caution) != LocalState::kFree) return false;
  const Cell* cell = find(place);
  return isInView(place) || (cell != nullptr && start_ + static_cast<double>(cell->seen_s) > since);
}

/// A cell without evidence of its own, narrower than what would be matched of an obstacle, between
/// cells that are free.
bool LocalLayer::isGap(const Vector2d& place, Time now) const {
  int free = 0;
  for (int i = 0; i < 9; ++i) {
    const Cell* cell = find(place + cell_m_ * Vector2d(i % 3 - 1, i / 3 - 1));
    const double odds = cell == nullptr ? 0.0 : oddsOf(*cell, true, now, 0.0);
    const bool was_hit = cell != nullptr && now - start_ - cell->hit_s < kLocal.in_view_s;
    if (was_hit) return false;
    free += odds <= -kLocal.known ? 1 : 0;
  }
  return free >= kLocal.free_round_gap;
}

std::vector<Vector2d> LocalLayer::blocked(Time now, double caution) const {
  std::vector<Vector2d> places;
  for (const Cell& cell : cells_) {
    if (cell.odds < kLocal.known) continue;
    const Vector2d place = centreOf(cell);
    if (find(place) == &cell && at(place, now, caution) == LocalState::kBlocked) {
      places.push_back(place);
    }
  }
  return places;
}

/// Whether what had come to a cell would hide ground that is seen behind it, if it were still
/// there: the ray to the ground passes at a height at which it was seen.
bool LocalLayer::wouldHide(const Cell& cell, const Vector2d& ground) const {
  if (cell.hit_s - cell.free_s >= kLocal.was_free_s) return false;
  const Vector2d eye = (T_odom_robot_ * camera_->T_robot_cam).translation().head<2>();
  const double ratio = (centreOf(cell) - eye).norm() / (ground - eye).norm();
  const double height = (1.0 - ratio) * camera_->T_robot_cam.translation().z();
  const double at_most = height + kLocal.height_error_m;
  return cell.heights.low < at_most && cell.heights.high > at_most;
}

/// A gap between the robot and the ground that is seen first, as far as nothing stands in it: who
/// has come since would hide that ground.
void LocalLayer::addStrip(const Vector2d& from, const Vector2d& to, Frame& frame) const {
  const double length = (to - from).norm(), step = 0.5 * cell_m_;
  if (length > kLocal.gap_ratio * camera_->T_robot_cam.translation().z()) return;
  Vector2d clear = to;
  for (double back = 0.0; back < length; back += step) {
    const Vector2d place = to + back / length * (from - to);
    if (back > kLocal.radius_m && isInView(place)) return;  // the gap is in the image
    const Cell* cell = find(place);
    const bool is_blocked = cell != nullptr && oddsOf(*cell, false, time_, kLocalHold_s) > 0.0;
    if (is_blocked && !wouldHide(*cell, to)) break;
    clear = place;
  }
  frame.addPass(clear, to);
}

/// The point of the robot that is nearest to one in its frame.
Vector2d LocalLayer::nearestOfRobot(const Eigen::Vector3f& point) const {
  const Vector2d half(0.5 * footprint_.length_m, 0.5 * footprint_.width_m);
  const Vector2d inside = point.head<2>().cast<double>().cwiseMax(-half).cwiseMin(half);
  return (T_odom_robot_ * Eigen::Vector3d(inside.x(), inside.y(), 0.0)).head<2>();
}

void LocalLayer::add(Time time, const Pose& T_odom_robot, const GroundScan& scan,
                     const std::optional<StereoCamera>& camera, int step) {
  if (is_started_ && time < time_) *this = LocalLayer(reach_m_, footprint_, nearest_m_);
  if (!is_started_) start_ = time;
  const double before = std::exchange(time_, time);
  is_started_ = true;
  T_odom_robot_ = T_odom_robot;
  camera_ = camera;
  ground_z_ = T_odom_robot.translation().z();
  if (camera_) T_cam_odom_ = (T_odom_robot * camera_->T_robot_cam).inverse(Eigen::Isometry);
  const auto placeOf = [&](const Eigen::Vector3f& point) {
    return Vector2d((T_odom_robot * point.cast<double>()).head<2>());
  };
  const Vector2d robot = T_odom_robot.translation().head<2>();
  const Vector2d eye =
      camera_ ? Vector2d((T_odom_robot * camera_->T_robot_cam).translation().head<2>()) : robot;
  Frame frame(*this);
  for (const auto& piece : scan.free) {
    frame.addPass(placeOf(piece.from), placeOf(piece.to));
    addStrip(nearestOfRobot(piece.from), placeOf(piece.from), frame);
  }
  for (const auto& obstacle : scan.obstacles) {
    frame.addHit(placeOf(obstacle.foot), eye, obstacle, 1.0);
  }
  for (const auto& obstacle : scan.laser_obstacles) {
    frame.addHit(placeOf(obstacle.foot), robot, obstacle, kLocal.beam_hits);
  }
  enter(frame, before, std::min(step, 2));
  standAt(T_odom_robot);
  const auto forget = [&](std::vector<Intruder>& all, double after_s) {
    const auto is_over = [&](const Intruder& one) { return time - one.time > after_s; };
    all.erase(std::remove_if(all.begin(), all.end(), is_over), all.end());
  };
  forget(intruders_, kLocalHold_s);
  forget(come_, kLocal.follow_s);
}

/// @param before  time of the frame before [s]
void LocalLayer::enter(const Frame& frame, Time before, double weight) {
  const Time time = time_;
  const auto now_s = static_cast<float>(time - start_);
  const auto before_s = static_cast<float>(before - start_);
  const Vector2d robot = T_odom_robot_.translation().head<2>();
  std::vector<Intruder> come, seen;
  const int first_x = static_cast<int>(std::floor((robot.x() - reach_m_) / cell_m_));
  const int first_y = static_cast<int>(std::floor((robot.y() - reach_m_) / cell_m_));
  for (int y = first_y; y < first_y + size_; ++y) {
    for (int x = first_x; x < first_x + size_; ++x) {
      const std::size_t index = indexOf(x, y);
      const Evidence& evidence = frame.cells()[index];
      if (evidence.hits == 0.0F && evidence.passes == 0.0F) continue;
      Cell& cell = cells_[index];
      if (cell.x != x || cell.y != y) cell = {x, y};
      const Vector2d place = centreOf(cell);
      const double last_odds = oddsOf(cell, isInView(place), time, kLocalHold_s);
      const double change = weight * (kLocal.hit * evidence.hits - kLocal.pass * evidence.passes);
      const bool is_struck = change >= kLocal.most_per_frame;
      const bool counts_in_full = is_struck && wasStruckNear(cell, before_s);
      const double most = counts_in_full ? 2.0 * kLocal.most : kLocal.most_per_frame;
      const double odds = std::clamp(last_odds + std::clamp(change, -kLocal.most_per_frame, most),
                                     -kLocal.most, kLocal.most);
      cell.odds = static_cast<float>(odds);
      cell.seen_s = now_s;
      if (odds <= -kLocal.known) cell.free_s = now_s;
      if (evidence.hits > 0.0F) {
        if (last_odds <= 0.0) cell.heights = {};
        cell.heights.include(evidence.heights);
        cell.hit_s = now_s;
      }
      if (is_struck) cell.struck_before_s = std::exchange(cell.struck_s, now_s);
      const bool has_come =
          odds >= kLocal.known && now_s - cell.free_s < kLocal.was_free_s && !isAtStanding(place);
      if (has_come) come.push_back({place, time, Vector2d::Zero(), kLocal.speed_mps});
    }
  }
  for (Intruder& one : come) {
    const auto near = std::count_if(come.begin(), come.end(), [&](const Intruder& other) {
      return (one.place - other.place).norm() < kLocal.radius_m;
    });
    if (near < kLocal.cells_of_person) continue;  // an error of matching is narrower
    dropSeenAgain(one.place, time);
    if (!isAtEdgeOfView(one.place)) continue;
    measureVelocity(come, one);
    seen.push_back(one);
  }
  intruders_.insert(intruders_.end(), seen.begin(), seen.end());
  come_.insert(come_.end(), come.begin(), come.end());
}

/// The velocity of what came about a place, by the middle of what came within a person's walk of it
/// before; unknown at first.
void LocalLayer::measureVelocity(const std::vector<Intruder>& come, Intruder& one) const {
  const auto middleOf = [](const std::vector<Intruder>& all, Time time, const Vector2d& place,
                           double radius_m) {
    Vector2d sum = Vector2d::Zero();
    int count = 0;
    for (const Intruder& other : all) {
      if (other.time != time || (other.place - place).norm() > radius_m) continue;
      sum += other.place;
      ++count;
    }
    return count > 0 ? std::optional(Vector2d(sum / count)) : std::nullopt;
  };
  const auto here = middleOf(come, one.time, one.place, kLocal.radius_m);
  Time tried = -std::numeric_limits<double>::infinity();
  for (const Intruder& before : come_) {  // the oldest first
    const double seconds = one.time - before.time;
    if (seconds < kLocal.follow_least_s) return;
    if (before.time == std::exchange(tried, before.time)) continue;
    const double walk_m = kLocal.radius_m + kLocal.speed_mps * seconds;
    const auto there = middleOf(come_, before.time, *here, walk_m);
    if (!there) continue;
    one.velocity = (*here - *there) / seconds;
    one.spread_mps = 0.5 * kLocal.speed_mps;  // people who turn or stop
    return;
  }
}

/// Whether the frame before hit a cell from which a person walks to this one until now.
bool LocalLayer::wasStruckNear(const Cell& cell, float before_s) const {
  const double walk_m = kLocal.speed_mps * std::min(kLocal.in_view_s, time_ - start_ - before_s);
  const int cells = 1 + static_cast<int>(walk_m / cell_m_);
  for (int y = cell.y - cells; y <= cell.y + cells; ++y) {
    for (int x = cell.x - cells; x <= cell.x + cells; ++x) {
      const Cell& other = cells_[indexOf(x, y)];
      const bool was_struck = other.struck_s == before_s || other.struck_before_s == before_s;
      if (other.x == x && other.y == y && was_struck) return true;
    }
  }
  return false;
}

/// Whether the place is at the edge of what has been blocked for long, which noise moves.
bool LocalLayer::isAtStanding(const Vector2d& place) const {
  const double now_s = time_ - start_;
  for (int i = 0; i < 25; ++i) {
    const Cell* cell = find(place + cell_m_ * Vector2d(i % 5 - 2, i / 5 - 2));
    const bool stands =
        cell != nullptr && cell->odds >= kLocal.known && now_s - cell->free_s >= kLocal.was_free_s;
    if (stands) return true;
  }
  return false;
}

/// What was at the edge of the view and is in it now, where it may have gone, has not left it.
void LocalLayer::dropSeenAgain(const Vector2d& place, Time time) {
  const auto is_this = [&](const Intruder& intruder) {
    const double age_s = time - intruder.time;
    return (place - intruder.place - age_s * intruder.velocity).norm() <
           kLocal.radius_m + intruder.spread_mps * age_s;
  };
  intruders_.erase(std::remove_if(intruders_.begin(), intruders_.end(), is_this), intruders_.end());
}

/// The ground under the robot is free.
void LocalLayer::standAt(const Pose& T_odom_robot) {
  if (footprint_.empty()) return;
  const double step = 0.5 * cell_m_;
  const auto now_s = static_cast<float>(time_ - start_);
  const double length = footprint_.length_m, width = footprint_.width_m;
  for (double x = 0.0; x < length + step; x += step) {
    for (double y = 0.0; y < width + step; y += step) {
      const Eigen::Vector3d at(std::min(x, length) - 0.5 * length, std::min(y, width) - 0.5 * width,
                               0.0);
      const Eigen::Vector3d place = T_odom_robot * at;
      const int column = static_cast<int>(std::floor(place.x() / cell_m_));
      const int row = static_cast<int>(std::floor(place.y() / cell_m_));
      Cell& cell = cells_[indexOf(column, row)] = {column, row};
      cell.odds = static_cast<float>(-kLocal.most);
      cell.seen_s = cell.free_s = now_s;
    }
  }
}

}  // namespace headway::map
