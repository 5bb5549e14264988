// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/objects_params.h>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "measured_box.h"

namespace headway::objects {

/// Predicted place of a track in this frame.
struct ExpectedPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (x, y) [m^2]
  double vertical_variance = 0.0;                            ///< of z [m^2]
  ObjectClass object_class = ObjectClass::kUnknown;
  std::optional<std::int64_t> detector_id;
  TrackId track;
};

/// Assignment of detections to tracks.
struct Matches {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< (track, detection), by track
  std::vector<std::size_t> unmatched_detections;           ///< each of a new object
};

/// One box for each object, and their duplicates.
struct DistinctBoxes {
  std::vector<MeasuredBox> boxes;
  std::vector<std::pair<std::size_t, MeasuredBox>> duplicates;  ///< index in `boxes`, duplicate

  /// Of a box and its duplicates, the one nearest to the track's prediction.
  [[nodiscard]] const MeasuredBox& likeliest(std::size_t box, const ExpectedPlace& track) const;
};

/// Whether a detector may confuse two classes; Unknown and Misc are compatible with all.
[[nodiscard]] bool compatible(ObjectClass a, ObjectClass b);

/// The consistency check of Sec. III-C3.
///
/// The cost of a pair is -2 log of the likelihood ratio of the detection under the track's
/// predicted Gaussian and as a new object; pairs are assigned at minimum total cost. The result
/// does not depend on the order of tracks or detections.
class ConsistencyCheck {
 public:
  explicit ConsistencyCheck(const ConsistencyParams& params) : params_(params) {}

  /// Keeps the box with the best score of each object.
  [[nodiscard]] DistinctBoxes withoutDuplicates(std::vector<MeasuredBox> boxes) const;

  [[nodiscard]] Matches match(const std::vector<ExpectedPlace>& tracks,
                              const std::vector<MeasuredBox>& detections) const;

 private:
  /// Distance beyond which no detection of such a variance matches a track [m].
  [[nodiscard]] double maxGate(const ExpectedPlace& track, double variance) const;
  [[nodiscard]] bool sameObject(const MeasuredBox& a, const MeasuredBox& b) const;
  /// -2 log of the likelihood ratio against a new object; nullopt outside the gate.
  [[nodiscard]] std::optional<double> cost(const ExpectedPlace& track,
                                           const MeasuredBox& detection) const;

  ConsistencyParams params_;
};

}  // namespace headway::objects
