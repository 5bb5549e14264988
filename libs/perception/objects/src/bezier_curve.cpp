// SPDX-License-Identifier: BSD-3-Clause
#include "bezier_curve.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {
namespace {

// Gauss-Legendre nodes and weights on [0, 1], 5 points.
constexpr std::array<double, 5> kNodes = {0.046910077030668, 0.230765344947158, 0.5,
                                          0.769234655052842, 0.953089922969332};
constexpr std::array<double, 5> kWeights = {0.118463442528095, 0.239314335249683, 0.284444444444444,
                                            0.239314335249683, 0.118463442528095};
// Where the parametric speed varies more than this, a polynomial cannot follow its inverse.
constexpr double kSteadySpeedRatio = 0.75;
// Shorter curves are treated as straight [m].
constexpr double kNegligible_m = 0.01;

}  // namespace

BezierCurve::BezierCurve(const Eigen::Vector2d& start, const Eigen::Vector2d& control,
                         const Eigen::Vector2d& end)
    : start_(start), linear_(2.0 * (control - start)), quadratic_(start - 2.0 * control + end) {
  const double a = 4.0 * quadratic_.squaredNorm();
  const double b = 4.0 * linear_.dot(quadratic_);
  const double c = linear_.squaredNorm();
  const double min_speed_t = a > 0.0 ? std::clamp(-b / (2.0 * a), 0.0, 1.0) : 0.0;
  const double min_speed = c + min_speed_t * (b + min_speed_t * a);  // squared speeds
  const double fastest = std::max(c, a + b + c);
  if (fastest < kNegligible_m * kNegligible_m) {
    length_ = (end - start).norm();
  } else if (min_speed > kSteadySpeedRatio * kSteadySpeedRatio * fastest) {
    fitInverse();
  } else {
    tabulate();
  }
}

// Quintic Hermite interpolation of the parameter as a function of the fraction of the arc length:
// value, first and second derivative agree at both ends.
void BezierCurve::fitInverse() {
  for (std::size_t i = 0; i < kNodes.size(); ++i) length_ += kWeights[i] * speedAt(kNodes[i]);
  const Eigen::Vector2d end_tangent = linear_ + 2.0 * quadratic_;
  const double start_square = linear_.squaredNorm();
  const double end_square = end_tangent.squaredNorm();
  const double v0 = length_ / std::sqrt(start_square);
  const double v1 = length_ / std::sqrt(end_square);
  const double square = length_ * length_;
  const double a0 = -square * 2.0 * linear_.dot(quadratic_) / (start_square * start_square);
  const double a1 = -square * 2.0 * end_tangent.dot(quadratic_) / (end_square * end_square);
  inverse_ = {v0, 0.5 * a0, 10.0 - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
              -15.0 + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
              6.0 - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1};
}

void BezierCurve::tabulate() {
  tabulated_ = true;
  table_[0] = 0.0;
  constexpr double kStep = 1.0 / kTableSize;
  double speed = speedAt(0.0);
  for (int i = 0; i < kTableSize; ++i) {  // Simpson's rule in every cell
    const double next_speed = speedAt((i + 1) * kStep);
    length_ += kStep / 6.0 * (speed + 4.0 * speedAt((i + 0.5) * kStep) + next_speed);
    table_[i + 1] = length_;
    speed = next_speed;
  }
  if (length_ <= 0.0) return;
  for (double& fraction : table_) fraction /= length_;
}

double BezierCurve::tabulatedParameterAt(double fraction) const {
  if (length_ <= 0.0) return fraction;
  const auto above = std::upper_bound(table_.begin() + 1, table_.end() - 1, fraction);
  const double cell = static_cast<double>(above - table_.begin()) - 1.0;
  const double low = *(above - 1);
  const double width = *above - low;
  return (cell + (width > 0.0 ? (fraction - low) / width : 0.0)) / kTableSize;
}

}  // namespace headway::objects
