#pragma once

#include <headway/core/detection.h>
#include <headway/core/moving_regions.h>
#include <headway/core/stereo_frame.h>
#include <headway/core/track.h>

#include <optional>

namespace headway::detect {

/// Finds objects in stereo frames.
///
/// Frames come in order of time. Deterministic: the same frames and poses give the same
/// detections, on any number of cores.
///
///     auto detector = makeDetector("stereo_motion", camera, params);
///     auto found = detector->detect(frame, T_map_robot);   // nullopt: did not look at this frame
///     if (found) tracker.update(index, pose, *found);
class Detector {
 public:
  virtual ~Detector() = default;

  /// Whether detect() wants to know where the robot is: such a detector runs after SLAM and its
  /// moving regions serve the next frame; any other one can run before SLAM and serve this one.
  [[nodiscard]] virtual bool needsPose() const { return false; }

  /// Looks at one frame.
  ///
  /// @param T_map_robot  where the robot was then; nullopt where it is lost or nobody knows
  /// @return  detections with boxes in the left image, and in 3D (frame of the left camera) where
  ///          the detector finds those; nullopt where it cannot use the frame, for a reason that
  ///          dropped() counts
  [[nodiscard]] virtual std::optional<Detections> detect(
      const StereoFrame& frame, const std::optional<Pose>& T_map_robot) = 0;

  /// Where that which moved in the frame last looked at is at another time, a few frames later at
  /// most; empty where the detector does not know.
  ///
  /// @param at  [s]; the time of the frame last looked at gives the regions of that frame itself
  [[nodiscard]] virtual MovingRegions movingRegions(Time /*at*/) const { return {}; }

  /// What it left out so far, by reason: frames it could not use, finds it did not believe.
  [[nodiscard]] virtual const DropCounts& dropped() const { return dropped_; }

 protected:
  void drop(const char* reason, std::size_t count = 1) {
    if (count > 0) dropped_[reason] += count;
  }

 private:
  DropCounts dropped_;
};

/// An empty report on a frame: nothing seen so far, boxes in the left camera's frame.
[[nodiscard]] Detections emptyDetections(const StereoFrame& frame);

}  // namespace headway::detect
