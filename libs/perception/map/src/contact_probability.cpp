// SPDX-License-Identifier: BSD-3-Clause
// Probability of a contact between footprints, by the predicted paths of tracks and their
// covariance.
#include <headway/map/contact_probability.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

using Eigen::Vector2d;

constexpr int kSteps = 32;  // of outlines and integrals, for the accuracies that the header states
constexpr double kMinVariance = 1e-4;  // of 1 cm [m^2]

double normalCdf(double value) { return 0.5 * std::erfc(-value / std::sqrt(2.0)); }

/// Interval of a vertical line inside a convex polygon; empty if low > high.
struct Chord {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
};

Chord chordAt(const std::vector<Vector2d>& polygon, double x) {
  Chord chord;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    if ((a.x() - x) * (b.x() - x) > 0.0 || a.x() == b.x()) continue;
    const double y = a.y() + (x - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
    chord.low = std::min(chord.low, y);
    chord.high = std::max(chord.high, y);
  }
  return chord;
}

struct Dated {
  double horizon_s;
  PathSample sample;
};

/// Number 0 is the track itself, number i the i-th point of the path.
Dated pointOf(const Track& track, const PredictedPath& path, std::size_t i) {
  if (i == 0) {
    return {0.0, {track.position.head<2>(), track.position_covariance.topLeftCorner<2, 2>()}};
  }
  const auto& point = path.points[i - 1];
  return {point.horizon_s, {point.position.head<2>(), point.covariance}};
}

}  // namespace

double FootprintShape::radius() const {
  return round ? 0.5 * std::max(length_m, width_m) : 0.5 * std::hypot(length_m, width_m);
}

Vector2d FootprintShape::supportPoint(const Vector2d& normal) const {
  const Vector2d half(0.5 * length_m, 0.5 * width_m);
  if (!round) return {std::copysign(half.x(), normal.x()), std::copysign(half.y(), normal.y())};
  const Vector2d scaled = half.cwiseProduct(normal);
  const double length = scaled.norm();
  return length > 0.0 ? Vector2d(half.cwiseProduct(scaled) / length) : Vector2d::Zero();
}

FootprintShape footprintOf(const Track& track) {
  const bool person = track.object_class == ObjectClass::kPedestrian ||
                      track.object_class == ObjectClass::kPersonSitting;
  return {track.size.x(), track.size.y(), person};
}

std::vector<Vector2d> contactRegion(const FootprintShape& a, double yaw_a, const FootprintShape& b,
                                    double yaw_b) {
  const Eigen::Rotation2Dd rotation_a(yaw_a), rotation_b(yaw_b);
  std::vector<Vector2d> corners;
  for (int i = 0; i < kSteps; ++i) {
    const double angle = yaw_a + 2.0 * M_PI * (i + 0.5) / kSteps;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    corners.push_back(rotation_a * a.supportPoint(rotation_a.inverse() * normal) +
                      rotation_b * b.supportPoint(rotation_b.inverse() * normal));
  }
  return corners;
}

double probabilityInside(const std::vector<Vector2d>& polygon, const Vector2d& mean,
                         const Eigen::Matrix2d& covariance) {
  if (polygon.size() < 3) return 0.0;
  const double variance_x = std::max(covariance(0, 0), kMinVariance);
  const double sigma_x = std::sqrt(variance_x);
  const double slope = covariance(0, 1) / variance_x;
  const double sigma_y =
      std::sqrt(std::max(covariance(1, 1) - slope * covariance(0, 1), kMinVariance));
  double left = HUGE_VAL, right = -HUGE_VAL;
  for (const auto& corner : polygon) {
    left = std::min(left, corner.x());
    right = std::max(right, corner.x());
  }
  const double from = std::max(left, mean.x() - kContactSigmas * sigma_x);
  const double to = std::min(right, mean.x() + kContactSigmas * sigma_x);
  if (!(from < to)) return 0.0;
  // Sum over slices along x; within a slice y given x is normally distributed.
  const double step = (to - from) / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = from + (i + 0.5) * step;
    const Chord chord = chordAt(polygon, x);
    if (!(chord.low < chord.high)) continue;
    const double centre = mean.y() + slope * (x - mean.x());
    const double inside =
        normalCdf((chord.high - centre) / sigma_y) - normalCdf((chord.low - centre) / sigma_y);
    const double edge = from + i * step;
    const double weight =
        normalCdf((edge + step - mean.x()) / sigma_x) - normalCdf((edge - mean.x()) / sigma_x);
    sum += weight * inside;
  }
  return std::clamp(sum, 0.0, 1.0);
}

PathSample samplePath(const Track& track, const PredictedPath& path, double horizon_s) {
  const auto& points = path.points;
  if (points.empty() || !(horizon_s > 0.0)) return pointOf(track, path, 0).sample;
  const auto after =
      std::lower_bound(points.begin(), points.end(), horizon_s,
                       [](const PredictedPoint& p, double time) { return p.horizon_s < time; });
  const bool beyond = after == points.end();
  const auto next = static_cast<std::size_t>(after - points.begin()) + (beyond ? 0 : 1);
  const Dated b = pointOf(track, path, next), a = pointOf(track, path, next - 1);
  const double fraction = (horizon_s - a.horizon_s) / (b.horizon_s - a.horizon_s);
  PathSample sample{a.sample.centre + fraction * (b.sample.centre - a.sample.centre),
                    a.sample.covariance + fraction * (b.sample.covariance - a.sample.covariance)};
  if (beyond) {
    const double growth = horizon_s / b.horizon_s;
    sample.covariance = growth * growth * b.sample.covariance;
  }
  return sample;
}

void ContactSum::add(TrackId track, double of_future, double of_contact) {
  if (!current_ || *current_ != track) closeTrack();
  current_ = track;
  of_track_ += of_future * of_contact;
}

double ContactSum::total() {
  closeTrack();
  return 1.0 - none_;
}

void ContactSum::closeTrack() {
  if (of_track_ > max_probability_) {
    max_probability_ = of_track_;
    most_probable_ = current_;
  }
  none_ *= 1.0 - std::min(1.0, of_track_);
  of_track_ = 0.0;
}

}  // namespace headway::map
