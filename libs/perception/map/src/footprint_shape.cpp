// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/footprint_shape.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace headway::map {
namespace {

using Eigen::Vector2d;

constexpr int kNormals = 32;
constexpr int kSlices = 32;
constexpr double kReachSigmas = 5.0;
constexpr double kMinVariance = 1e-4;  ///< [m^2]

double normalCdf(double value) { return 0.5 * std::erfc(-value / std::sqrt(2.0)); }

/// Interval of a vertical line inside a convex polygon; empty if low > high.
struct Chord {
  double low = 1e300;
  double high = -1e300;
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
  const Eigen::Rotation2Dd turn_a(yaw_a), turn_b(yaw_b);
  std::vector<Vector2d> corners;
  for (int i = 0; i < kNormals; ++i) {
    const double angle = yaw_a + 2.0 * M_PI * (i + 0.5) / kNormals;
    const Vector2d normal(std::cos(angle), std::sin(angle));
    corners.push_back(turn_a * a.supportPoint(turn_a.inverse() * normal) +
                      turn_b * b.supportPoint(turn_b.inverse() * normal));
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
  double left = 1e300, right = -1e300;
  for (const auto& corner : polygon) {
    left = std::min(left, corner.x());
    right = std::max(right, corner.x());
  }
  const double from = std::max(left, mean.x() - kReachSigmas * sigma_x);
  const double to = std::min(right, mean.x() + kReachSigmas * sigma_x);
  if (!(from < to)) return 0.0;
  // Sum over slices along x; within a slice y given x is normally distributed.
  const double step = (to - from) / kSlices;
  double sum = 0.0;
  for (int i = 0; i < kSlices; ++i) {
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

}  // namespace headway::map
