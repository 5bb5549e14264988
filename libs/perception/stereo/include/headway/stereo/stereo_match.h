// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/stereo/second_view.h>

#include <Eigen/Core>
#include <optional>

namespace headway::stereo {

/// Finds points of the left image in the right one, along the row, to a fraction of a pixel.
///
/// A search over all disparities at half resolution (zero-mean squared differences, with a
/// uniqueness test and a check from right to left) is followed by an alignment at full
/// resolution. Returns disparities [px] at level 0, positive. Those of a depth camera are given:
/// nothing is searched, and predictions and levels have no effect.
///
/// @see Hirschmueller & Scharstein 2009, "Evaluation of stereo matching costs"
class StereoMatcher {
 public:
  /// @param max_disparity  largest disparity searched [px], level 0
  /// @param min_zncc       correlation that a match needs
  StereoMatcher(int max_disparity, double min_zncc)
      : max_disparity_(max_disparity), min_zncc_(min_zncc) {}

  /// Disparity of a point without prediction; nullopt if there is no unique match.
  [[nodiscard]] std::optional<double> search(const ImagePyramid& left, const SecondView& second,
                                             const Eigen::Vector2d& uv) const;

  /// Disparity of a point near an expected one, compared at one pyramid level.
  ///
  /// @param expected  [px], level 0
  [[nodiscard]] std::optional<double> refine(const ImagePyramid& left, const SecondView& second,
                                             const Eigen::Vector2d& uv, double expected,
                                             int level) const;

 private:
  int max_disparity_ = 0;
  double min_zncc_ = 0.0;
};

}  // namespace headway::stereo
