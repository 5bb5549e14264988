#pragma once

#include <headway/detect/stereo_motion.h>

#include <vector>

#include "blob_follower.h"
#include "motion_verdict.h"
#include "object_extent.h"

namespace headway::detect {

/// Something that moves, as found in one frame.
struct Mover {
  ObjectExtent extent;
  MeasuredVelocity velocity;         ///< over the ground, world of the path
  int first_frame = 0;               ///< the velocity was measured since then
  int points = 0;                    ///< sightings that tell of it
  std::vector<std::size_t> members;  ///< points that move with it
  std::vector<BlobTrack*> bodies;    ///< that are it
};

/// What is known of a frame when movers are looked for in it.
struct LookedAt {
  const CameraPath& path;
  const DisparityImage& disparity;
  const std::optional<GroundPlane>& ground;
  const Eigen::Vector3d& up;  ///< normal of the ground, world of the path
  const std::vector<PointTrack>& points;
  const std::vector<PointVerdict>& verdicts;  ///< one for each point
  double noise_scale = 1.0;                   ///< true errors of sightings over those assumed [-]
};

/// When a point counts as moving, by the parameters of the detector.
[[nodiscard]] VerdictParams verdictParamsOf(const StereoMotionParams& params);

/// Finds movers in a frame: points that move alike, and bodies that move as a whole.
///
/// What both tell of, or several of either, is one mover: pieces that lie where it is seen, or on
/// the ground that it covers or will cover at once.
class MoverFinder {
 public:
  MoverFinder(const StereoCamera& camera, const StereoMotionParams& params)
      : camera_(camera), params_(params) {}

  /// @param bodies  followed; the movers found point into them
  [[nodiscard]] std::vector<Mover> find(const LookedAt& frame, std::vector<BlobTrack>& bodies);

  /// Movers left out since the last call because what surrounds them belies them.
  [[nodiscard]] std::size_t takeImplausible();

 private:
  void addClusters(const LookedAt& frame, std::vector<Mover>& movers);
  void addBodies(const LookedAt& frame, std::vector<BlobTrack>& bodies, std::vector<Mover>& movers);
  [[nodiscard]] std::optional<MeasuredVelocity> velocityOf(const BlobTrack& body,
                                                           const LookedAt& frame) const;
  [[nodiscard]] std::optional<ObjectExtent> plausibleExtent(const std::vector<ObjectCell>& cells,
                                                            const Eigen::Vector3d& velocity,
                                                            const GroundPlane& floor,
                                                            double least_share,
                                                            const LookedAt& frame);

  StereoCamera camera_;
  StereoMotionParams params_;
  std::size_t implausible_ = 0;
};

}  // namespace headway::detect
