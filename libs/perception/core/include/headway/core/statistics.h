// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
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

}  // namespace headway
