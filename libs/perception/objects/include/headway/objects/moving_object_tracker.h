// SPDX-License-Identifier: BSD-3-Clause
// Tracking of moving objects from frame to frame.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace headway::objects {

/// The tracks after one frame.
struct TrackUpdate {
  std::vector<Track> tracks;           ///< tentative, confirmed and coasting ones; ascending ids
  std::vector<TrackSample> finalised;  ///< smoothed samples that no later frame will change
  /// Predictions for detectors, of all tracks for which a detector had evidence of motion;
  /// ascending ids.
  std::vector<ExpectedObject> expected;
  std::size_t detections_used = 0;
  DropCounts detections_dropped;  ///< not used in this frame, by reason
};

/// Tracks, smooths and predicts moving objects: the paper's Algorithm 1.
///
/// Deterministic, and independent of the order of a frame's detections.
///
///     MovingObjectTracker tracker(params);
///     TrackUpdate update = tracker.update(frame.index, {frame.time, T_map_robot}, detections);
class MovingObjectTracker {
 public:
  /// @throws InputError if a parameter is out of range
  explicit MovingObjectTracker(const ObjectsParams& params);
  ~MovingObjectTracker();

  /// Updates, starts and ends tracks with the detections of one frame.
  ///
  /// A frame whose time does not increase changes nothing; its detections are counted as dropped
  /// for "time_backwards". Detections without a 3D box are dropped for "no_3d_box".
  ///
  /// @param frame        index that the tracks' samples carry
  /// @param T_map_robot  pose and time [s] of the frame
  /// @param detections   boxes in the axes of their sensor
  [[nodiscard]] TrackUpdate update(std::size_t frame, const Stamped<Pose>& T_map_robot,
                                   const Detections& detections);

  /// Predicts the tracks to a frame without detection.
  [[nodiscard]] TrackUpdate coast(std::size_t frame, Time time);

  /// The samples still inside the smoothing windows, to be appended to all `finalised` ones.
  [[nodiscard]] std::vector<TrackSample> flush();

  /// Ends all tracks, so that the next frame may have an earlier time.
  ///
  /// @return as flush()
  [[nodiscard]] std::vector<TrackSample> restart();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::objects
