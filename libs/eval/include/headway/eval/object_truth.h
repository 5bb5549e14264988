#pragma once

#include <headway/core/track.h>
#include <headway/eval/labelled_frames.h>

#include <optional>
#include <vector>

namespace headway::eval {

/// One object's path through a recording.
struct TrueObject {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<TrajectoryPoint>
      path;  ///< map frame, ascending frames; gaps where it is not labelled

  /// Place at a time, between two labelled frames on the line between them.
  ///
  /// @param max_gap_s  greatest time between the two [s]
  /// @return           nullopt outside the path and in longer gaps
  [[nodiscard]] std::optional<Eigen::Vector3d> positionAt(Time time, double max_gap_s) const;
};

/// Brings labels to the map frame, object by object; boxes without a place in space are left out.
///
/// @param T_map_cam  of each frame: where the labels' optical frame stands
/// @return           ascending ids
/// @throws InputError if a labelled frame has no pose
[[nodiscard]] std::vector<TrueObject> trueObjects(const std::vector<LabelledFrame>& frames,
                                                  const std::vector<Stamped<Pose>>& T_map_cam);

/// The same for what a tracker reported, a path for each of its tracks.
[[nodiscard]] std::vector<TrueObject> estimatedObjects(const std::vector<LabelledFrame>& frames,
                                                       const std::vector<Stamped<Pose>>& T_map_cam);

}  // namespace headway::eval
