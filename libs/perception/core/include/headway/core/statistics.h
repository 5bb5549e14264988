// SPDX-License-Identifier: BSD-3-Clause
// Percentiles, histograms in bounded memory, and the rate of frames.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace headway {

[[nodiscard]] constexpr double square(double x) { return x * x; }

/// What 99 % of the sums of so many squared normal residuals are below: the chi-square quantile.
///
/// @param degrees_of_freedom  1, 2 or 3
[[nodiscard]] constexpr double chiSquare99(int degrees_of_freedom) {
  constexpr double kQuantiles[] = {6.63, 9.21, 11.34};
  return kQuantiles[degrees_of_freedom - 1];
}

/// Percentile of the samples by nearest rank, `fraction` in [0, 1]; 0 if there are none.
[[nodiscard]] double percentile(std::vector<double> samples, double fraction);

/// Median of the samples in any order, the upper one of an even number; 0 if there are
/// none.
[[nodiscard]] double median(std::vector<double> samples);

/// Standard deviation over the median of absolute deviations, of a normal distribution.
inline constexpr double kSigmaOfMedian = 1.4826;

/// Distribution of positive samples in bounded memory: bins whose limits have a ratio of 1.01.
///
/// Count, sum and maximum are exact. A percentile is the mean of the samples in its bin, so it
/// differs from the exact one by less than 1 %, and not at all if the bin holds one value. Samples
/// below 1e-3 share the lowest bin and those above 1e9 the highest one: 2,778 bins at most.
class Histogram {
 public:
  void add(double sample);
  void merge(const Histogram& other);

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double sum() const { return sum_; }
  /// 0 if there are no samples, like the other figures.
  [[nodiscard]] double mean() const;
  [[nodiscard]] double max() const { return max_; }
  /// Percentile by nearest rank, `fraction` in [0, 1].
  [[nodiscard]] double percentile(double fraction) const;

 private:
  struct Bin {
    std::size_t count = 0;
    double sum = 0.0;
  };
  std::map<int, Bin> bins_;  ///< those that hold samples, by the logarithm of the lower limit
  std::size_t count_ = 0;
  double sum_ = 0.0;
  double max_ = 0.0;
};

/// The rate of frames, by the median of their intervals so far, and their time in it.
///
/// Parameters that mean a time are in seconds, whatever the rate is; isOver() compares them with
/// the times of frames to the nearest frame, since these jitter.
class FrameRate {
 public:
  static constexpr double kAssumed_hz = 10.0;  ///< before it is measured

  /// Takes the time of the next frame [s]; one that is not later than the last has no interval.
  void add(double time);

  /// From the last frame but one to the last: 0 if it is not later, the assumed interval for the
  /// first frame [s].
  [[nodiscard]] double lastInterval() const { return last_interval_s_; }
  [[nodiscard]] double interval() const { return interval_s_; }  ///< median [s]
  [[nodiscard]] double hz() const { return 1.0 / interval_s_; }

  /// Whether a time has passed that is at least a period, to the nearest frame [s].
  [[nodiscard]] bool isOver(double seconds, double period_s) const {
    constexpr double kNearest =
        0.55;  ///< of an interval: more than a half, so that ties do not flip
    return seconds + kNearest * interval_s_ >= period_s;
  }

 private:
  std::optional<double> last_;
  double last_interval_s_ = 1.0 / kAssumed_hz;
  double interval_s_ = 1.0 / kAssumed_hz;
  Histogram intervals_;
};

}  // namespace headway
