#pragma once

#include <headway/core/detection.h>
#include <headway/core/expected_object.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <memory>
#include <vector>

namespace headway::objects {

/// What one frame's detections did to the tracks.
struct TrackUpdate {
  std::vector<Track> tracks;         ///< tentative, confirmed and coasting ones; ascending ids
  std::vector<TrackSample> finalised;  ///< smoothed samples that no later frame will change
  /// Of all tracks that a detector saw move, those not shown included; ascending ids.
  std::vector<ExpectedObject> expected;
  std::size_t detections_used = 0;
  DropCounts detections_dropped;  ///< left out in this frame, by reason
};

/// Tracks, smooths and predicts everything that moves: the paper's Algorithm 1.
///
/// Deterministic, independent of the order in which a frame lists its detections.
///
///     MovingObjectTracker tracker(params);
///     TrackUpdate update = tracker.update(frame.index, {frame.time, T_map_robot}, detections);
class MovingObjectTracker {
 public:
  explicit MovingObjectTracker(const ObjectsParams& params);
  ~MovingObjectTracker();

  /// Continues, starts and ends tracks with the detections of one frame.
  ///
  /// A frame whose time does not increase changes nothing; its detections are counted as dropped
  /// for "time_backwards". Detections without a 3D box are dropped for "no_3d_box".
  [[nodiscard]] TrackUpdate update(std::size_t frame, const Stamped<Pose>& T_map_robot,
                                   const Detections& detections);

  /// Carries the tracks on to a frame in which nobody looked for objects.
  [[nodiscard]] TrackUpdate coast(std::size_t frame, Time time);

  /// The samples still inside the smoothing windows: the end of `finalised`.
  [[nodiscard]] std::vector<TrackSample> flush();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::objects
