// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>

#include <optional>
#include <string>

namespace headway::pipeline {

/// What a frame shows in which the camera is lost.
enum class LostReason {
  kTooDark,
  kCovered,      ///< even grey: a lens cover, a wall, fog
  kBlurred,      ///< by motion or focus
  kFewFeatures,  ///< a sharp image of surfaces without texture
  kMovedTooFast  ///< a usable image of another view than before
};

/// Name in `summary.json` and title: "too_dark", "covered", "blurred", "few_features",
/// "moved_too_fast".
[[nodiscard]] const char* toString(LostReason reason);

/// What was seen, and the keys or measures that help, one line.
[[nodiscard]] std::string explanationOf(LostReason reason);

/// Determines why a camera was lost, from its image and those of tracked frames.
class LostDiagnosis {
 public:
  /// Measures the image of a tracked frame, every tenth one.
  void addTracked(const StereoFrame& frame);
  [[nodiscard]] LostReason reasonOf(const StereoFrame& frame) const;

 private:
  std::optional<double> sharpness_;  ///< usual one of tracked frames
  int frames_ = 0;
};

}  // namespace headway::pipeline
