// SPDX-License-Identifier: BSD-3-Clause
// Evidence of a fault, summed until it decides.
#pragma once

#include <algorithm>

namespace headway::pipeline {

/// Log-likelihood ratios of a fault, summed over observations until they decide.
///
/// The sum stays between 0 and little more than what decides, so that a fault that begins late is
/// found as soon, and so is its end, but one observation of many does not end it.
///
/// @see Page 1954, "Continuous inspection schemes"
class Evidence {
 public:
  static constexpr double kDecisive = 16.0;  ///< chance of 1e-7 a beginning

  /// @param log_ratio  of the likelihoods with and without the fault
  void add(double log_ratio) { sum_ = std::clamp(sum_ + log_ratio, 0.0, 1.4 * kDecisive); }
  /// Whether anything speaks for the fault.
  [[nodiscard]] bool isSuspected() const { return sum_ > 0.0; }
  [[nodiscard]] bool isDecisive() const { return sum_ >= kDecisive; }

 private:
  double sum_ = 0.0;
};

}  // namespace headway::pipeline
