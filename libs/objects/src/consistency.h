#pragma once

#include <headway/objects/objects_params.h>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "measured_box.h"

namespace headway::objects {

/// Where a track should be found in this frame.
struct ExpectedPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (x, y) [m^2]
  double vertical_variance = 0.0;                            ///< of z [m^2]
  ObjectClass object_class = ObjectClass::kUnknown;
  std::optional<std::int64_t> detector_id;
};

/// Which detection continues which track.
struct Matches {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< (track, detection), by track
  std::vector<std::size_t> unmatched_detections;           ///< seen for the first time
};

/// Boxes of different objects, and what else was said of them.
struct DistinctBoxes {
  std::vector<MeasuredBox> boxes;
  std::vector<std::pair<std::size_t, MeasuredBox>> duplicates;  ///< index in `boxes`, another box

  /// Of a box and its duplicates, the one nearest to where a track expects it.
  [[nodiscard]] const MeasuredBox& likeliest(std::size_t box, const ExpectedPlace& track) const;
};

/// Classes that a detector may take for one another; Unknown and Misc go with everything.
[[nodiscard]] bool compatible(ObjectClass a, ObjectClass b);

/// The consistency check of Sec. III-C3.
///
/// Every track expects its object inside a Gaussian; a detection is worth to a track its
/// likelihood there against that of a new object, and the tracks share the detections out for the
/// greatest worth in all. The result does not depend on the order of tracks or detections.
class ConsistencyCheck {
 public:
  explicit ConsistencyCheck(const ConsistencyParams& params) : params_(params) {}

  /// One box of every object that several boxes describe: the one with the best score.
  [[nodiscard]] DistinctBoxes withoutDuplicates(std::vector<MeasuredBox> boxes) const;

  [[nodiscard]] Matches match(const std::vector<ExpectedPlace>& tracks,
                              const std::vector<MeasuredBox>& detections) const;

 private:
  [[nodiscard]] bool sameObject(const MeasuredBox& a, const MeasuredBox& b) const;
  /// -2 log of the likelihood ratio against a new object; nullopt outside the gate.
  [[nodiscard]] std::optional<double> cost(const ExpectedPlace& track,
                                           const MeasuredBox& detection) const;

  ConsistencyParams params_;
};

}  // namespace headway::objects
