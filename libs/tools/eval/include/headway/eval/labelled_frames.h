// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

/// One object in one frame: a label or a tracker's output.
struct LabelledBox {
  std::int64_t id = -1;  ///< of the object, within its sequence
  ObjectClass object_class = ObjectClass::kUnknown;
  std::optional<Box2d> box2d;  ///< [px]
  std::optional<Box3d> box3d;  ///< optical frame, identical for truth and estimates
  int occlusion = 0;           ///< truth: 0 visible .. 3 unknown, as KITTI
  double truncation = 0.0;     ///< truth: ratio outside the image, 0..1
  double score = 0.0;          ///< estimates: confidence, greater is better
};

/// Truth and estimates of one frame.
struct LabelledFrame {
  std::vector<LabelledBox> truth;
  std::vector<Box2d> dont_care;  ///< unlabelled image regions [px]
  std::vector<LabelledBox> estimates;
};

/// One recording.
struct LabelledSequence {
  std::string name;
  std::vector<LabelledFrame> frames;  ///< by frame index
};

/// Trajectory of one object in a recording.
struct TrueObject {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<TrajectoryPoint> path;  ///< map frame, ascending frames, gaps where not labelled

  /// Position at a time, linearly interpolated between labelled frames [m].
  ///
  /// @param max_gap_s  maximum interval to interpolate over [s]
  /// @return           nullopt outside the path and in longer gaps
  [[nodiscard]] std::optional<Eigen::Vector3d> positionAt(Time time, double max_gap_s) const;
};

/// Transforms labels to the map frame, grouped by object; boxes without a 3D box are ignored.
///
/// @param T_map_cam  pose of the labels' optical frame at each frame
/// @return           in ascending order of ids
/// @throws InputError if a labelled frame has no pose
[[nodiscard]] std::vector<TrueObject> trueObjects(const std::vector<LabelledFrame>& frames,
                                                  const std::vector<Stamped<Pose>>& T_map_cam);

/// The same for the estimates: one path per track.
[[nodiscard]] std::vector<TrueObject> estimatedObjects(const std::vector<LabelledFrame>& frames,
                                                       const std::vector<Stamped<Pose>>& T_map_cam);

}  // namespace headway::eval
