// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/per_class.h>

#include <array>

#include "measured_box.h"

namespace headway::objects {

/// Votes of a track's detections for its class.
///
/// A classifier's class is known at once. One derived from size and speed is provisional: it is
/// wrong in one of three frames, and successive frames err together, so that half of their
/// information counts. Three votes ahead of every other kind of motion leave it a chance of 1 in 9.
class ClassEvidence {
 public:
  explicit ClassEvidence(const MeasuredBox& first) : assumed_(first.object_class) { add(first); }

  void add(const MeasuredBox& detection);

  /// The class of most votes, of which the track's motion parameters are.
  [[nodiscard]] ObjectClass assumed() const { return assumed_; }
  /// The same, once it is known; Unknown before.
  [[nodiscard]] ObjectClass known() const { return is_known_ ? assumed_ : ObjectClass::kUnknown; }

 private:
  [[nodiscard]] bool leads() const;

  ObjectClass assumed_;
  bool is_known_ = false;
  std::array<double, kObjectClassCount> votes_{};
};

}  // namespace headway::objects
