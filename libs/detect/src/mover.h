#pragma once

#include <headway/core/detection.h>

#include <optional>
#include <vector>

#include "blob_follower.h"
#include "object_extent.h"

namespace headway::detect {

/// What tells that a mover is there.
enum class MoverEvidence {
  kMotion,  ///< nothing but motion explains how it was seen in several frames
  kFlow,    ///< something flows as a known mover must, where that must be now
  kLook     ///< something looks like a known mover, where that must be now
};

/// Something that moves, as found in one frame.
struct Mover {
  ObjectExtent extent;
  MeasuredVelocity velocity;         ///< over the ground, world of the path
  int first_frame = 0;               ///< the velocity was measured since then
  int points = 0;                    ///< sightings that tell of it
  std::vector<std::size_t> members;  ///< points that move with it
  std::vector<BlobTrack*> bodies;    ///< that are it
  MoverEvidence evidence = MoverEvidence::kMotion;
  std::optional<std::int64_t> known_as;  ///< identity that it was recognised as
};

constexpr double kLeastAcross = 0.3;  ///< speed of a body that its flow alone tells of [m/s]

/// Whether a piece is seen where a mover is and at its depth, or stands on the ground it covers.
[[nodiscard]] bool isPartOf(const ObjectExtent& piece, const Mover& mover);

/// Whether it is a part of any of them.
[[nodiscard]] bool isPartOfAny(const ObjectExtent& piece, const std::vector<Mover>& movers);

/// Whether things move so much alike that they may be parts of one.
[[nodiscard]] bool isAsFast(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other);

/// Whether things move apart, so that they cannot be parts of one.
[[nodiscard]] bool isOpposite(const Eigen::Vector3d& velocity, const Eigen::Vector3d& other);

}  // namespace headway::detect
