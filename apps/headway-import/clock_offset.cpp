// SPDX-License-Identifier: BSD-3-Clause
#include "clock_offset.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::import {
namespace {

constexpr double kMaxOffset = 0.5;  // [s]
constexpr double kStep = 0.001;     // [s]
constexpr std::size_t kMinSteps = 20;
constexpr double kMinDeviation = 0.02;  // of the rates [rad/s]
constexpr double kMinCorrelation = 0.7;
constexpr double kMaxSampleGap = 0.25;  // [s]

/// The gyroscope's amount of turn from its start, interpolated between samples.
class TurnSum {
 public:
  explicit TurnSum(const std::vector<TurnSample>& samples) {
    for (const auto& sample : samples) {
      if (!times_.empty() && sample.time <= times_.back()) continue;
      const double dt = times_.empty() ? 0.0 : sample.time - times_.back();
      const double rate = sample.rate.norm();
      sums_.push_back(times_.empty() ? 0.0 : sums_.back() + 0.5 * dt * (rate + last_rate_));
      times_.push_back(sample.time);
      last_rate_ = rate;
    }
  }

  /// nullopt beyond the samples and in gaps.
  [[nodiscard]] std::optional<double> at(Time time) const {
    const auto after = std::lower_bound(times_.begin(), times_.end(), time);
    if (after == times_.begin() || after == times_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - times_.begin());
    const double gap = times_[i] - times_[i - 1];
    if (gap > kMaxSampleGap) return std::nullopt;
    const double ratio = (time - times_[i - 1]) / gap;
    return (1.0 - ratio) * sums_[i - 1] + ratio * sums_[i];
  }

 private:
  std::vector<Time> times_;
  std::vector<double> sums_;
  double last_rate_ = 0.0;
};

struct Correlation {
  double value = 0.0;
  double camera_deviation = 0.0;  ///< [rad/s]
};

/// Of the mean rates in all steps, the gyroscope's times taken to be later by an offset.
std::optional<Correlation> correlationAt(const std::vector<TurnStep>& steps, const TurnSum& sum,
                                         double offset) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (const auto& step : steps) {
    const auto begin = sum.at(step.begin + offset), end = sum.at(step.end + offset);
    if (!begin || !end) continue;
    const double dt = step.end - step.begin;
    const double a = step.angle / dt, b = (*end - *begin) / dt;
    n += 1.0, x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
  }
  if (n < static_cast<double>(kMinSteps)) return std::nullopt;
  const double a = xx / n - x * x / n / n, b = yy / n - y * y / n / n;
  if (!(a > 0.0 && b > 0.0)) return std::nullopt;
  return Correlation{(xy / n - x * y / n / n) / std::sqrt(a * b), std::sqrt(a)};
}

}  // namespace

std::optional<ClockOffset> clockOffset(const std::vector<TurnStep>& steps,
                                       const std::vector<TurnSample>& samples) {
  const TurnSum sum(samples);
  std::optional<ClockOffset> best;
  const int count = static_cast<int>(kMaxOffset / kStep);
  for (int i = -count; i <= count; ++i) {
    const auto correlation = correlationAt(steps, sum, i * kStep);
    if (!correlation || correlation->camera_deviation < kMinDeviation) continue;
    if (best && !(correlation->value > best->correlation)) continue;
    best = ClockOffset{i * kStep, correlation->value};
  }
  if (!best || !(best->correlation >= kMinCorrelation)) return std::nullopt;
  if (std::abs(best->offset_s) > kMaxOffset - 0.5 * kStep) return std::nullopt;  // may lie beyond
  return best;
}

}  // namespace headway::import
