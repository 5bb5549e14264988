// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/core/warnings.h>
#include <headway/stereo/rectification.h>

#include <optional>

namespace headway::pipeline {

/// Compares left and right images while a recording runs, twice a second: rows that differ, images
/// of different times, and images that are swapped.
///
/// Corners of the left image are searched in a band of rows of the right one, in wide images at
/// half the resolution. A condition is reported when it occurs in two comparisons in a row, so
/// within 1 s. The rotation of the right camera is estimated from the rows of all comparisons.
class StereoCheck {
 public:
  /// Adds "vertical_offset" if all rows differ alike, "images_not_simultaneous" if they differ by
  /// place, as in images of a moving camera that were not taken at the same time, and
  /// "images_swapped" if most points have a negative disparity.
  void add(const StereoFrame& frame, Warnings& warnings);

  /// Whether a condition persists since two comparisons.
  [[nodiscard]] bool imagesContradict() const { return persists_; }

  /// The right camera's rotation against its calibration; nullopt with too few matches so far.
  [[nodiscard]] std::optional<stereo::RectificationError> rectification() const;

 private:
  enum class Finding { kNone, kSwapped, kOffset, kScattered };
  [[nodiscard]] Finding compare(const StereoFrame& frame, double& rows_px);

  std::optional<Time> last_;  ///< of the latest comparison
  Finding finding_ = Finding::kNone;
  bool persists_ = false;
  std::optional<stereo::RectificationEstimator> estimator_;  ///< after the first frame
};

}  // namespace headway::pipeline
