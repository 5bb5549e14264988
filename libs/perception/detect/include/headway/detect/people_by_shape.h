// SPDX-License-Identifier: BSD-3-Clause
// Finds people by their shape in the disparities of one frame, whether they move or not.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/params.h>
#include <headway/stereo/frame_context.h>

#include <memory>

namespace headway::detect {

/// Section [shape].
struct ShapeParams {
  double min_score = 0.95;   ///< of a person [-]
  double max_range_m = 0.0;  ///< 0: RigCapability::standing_to_m [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "shape"); }  ///< @throws InputError
};

/// Finds people on foot or seated by their shape: height above the ground, width and depth, by a
/// small network over whatever stands on the ground. No colour, no motion, no file: the network is
/// part of the library. For stereo and depth cameras alike.
///
/// What it says of a place is evidence of a person, not of motion. Frames without a ground plane
/// show nothing.
///
///     PeopleByShape people(params);
///     const Detections found = people.detect(context);
///
/// @see  training/README.md; Munaro & Menegatti 2014, "Fast RGB-D people tracking for service
///       robots" (places by height maps)
class PeopleByShape {
 public:
  explicit PeopleByShape(const ShapeParams& params);
  ~PeopleByShape();
  PeopleByShape(PeopleByShape&&) noexcept;

  /// @return  2D and 3D boxes of class Pedestrian with the covariance of their centres; the
  ///          score is the network's probability
  [[nodiscard]] Detections detect(const stereo::FrameContext& context);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::detect
