// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "measured_box.h"

namespace headway::objects {

/// How good a box is, by its detector's score.
///
/// The scale of a score is the detector's own; its rank among the scores of the same class tells
/// near and unoccluded views from others. PointRCNN's boxes of cars, for example, have lengths to
/// within 0.19 m where the score is one standard deviation above the mean and 0.41 m where it is
/// one and a half below, at any range.
class ScoreQuality {
 public:
  /// Updates mean and standard deviation of the scores of the box's class.
  void learn(const MeasuredBox& box);

  /// The box with the noise of its size scaled: less for a score above the mean, more below.
  [[nodiscard]] MeasuredBox scaled(MeasuredBox box) const;

 private:
  struct Scores {
    std::size_t count = 0;
    double mean = 0.0;
    double squares = 0.0;  ///< sum of the squared deviations from the mean
  };
  std::array<Scores, kObjectClassCount> scores_{};
};

}  // namespace headway::objects
