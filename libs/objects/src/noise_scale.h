#pragma once

#include "consistency.h"
#include "measured_box.h"

namespace headway::objects {

/// How much noisier (or better) a detector is than its configured noise, learnt as it is used.
///
/// If the noise is right, the squared distance of a detection from its expected place, in units of
/// what filter and detector together leave open, is 2 on average (it is chi-squared). Surprises
/// raise the scale, good hits lower it, until that holds.
///
/// @see Bar-Shalom et al. 2001, "Estimation with applications to tracking and navigation", 5.4
class NoiseScale {
 public:
  /// @param adaption  share of a surprise that changes the scale; 0 keeps it at 1
  explicit NoiseScale(double adaption) : adaption_(adaption) {}

  /// Takes in how far a detection lies from where a grown track expected it.
  void learn(const ExpectedPlace& expected, const MeasuredBox& detection);

  /// The box with its noise scaled.
  [[nodiscard]] MeasuredBox scaled(MeasuredBox box) const;

  /// Factor on the standard deviations.
  [[nodiscard]] double value() const { return scale_; }

 private:
  double adaption_;
  double scale_ = 1.0;
};

}  // namespace headway::objects
