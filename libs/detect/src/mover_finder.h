#pragma once

#include <headway/detect/stereo_motion.h>

#include <vector>

#include "looked_at.h"
#include "mover.h"

namespace headway::detect {

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
                                                            const stereo::GroundPlane& floor,
                                                            double least_share,
                                                            const LookedAt& frame);

  StereoCamera camera_;
  StereoMotionParams params_;
  std::size_t implausible_ = 0;
};

}  // namespace headway::detect
