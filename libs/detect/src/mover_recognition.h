#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "looked_at.h"
#include "mover.h"
#include "object_identities.h"

namespace headway::detect {

/// Between a mover and where it is expected, from which it is another [m].
[[nodiscard]] double recognitionGate(double depth);

/// Knows movers again by bodies that flow as they must.
///
/// That something moves must show in several frames, as long as it is followed. What was followed
/// is soon lost in a crowd, but a mover that was found before needs less evidence: a body near the
/// place where it must be now, whose flow in this frame is that of its velocity.
///
/// @param missing  identities that were not found in this frame
/// @param bodies   followed; the movers point into them
/// @param movers   found in this frame already, what is part of one is none; others are appended
void recogniseBodies(const LookedAt& frame, const std::vector<ObjectIdentity>& missing,
                     std::vector<BlobTrack>& bodies, const StereoCamera& camera,
                     std::vector<Mover>& movers);

/// Knows movers again by how they looked, where stereo does not show them: half hidden, or at the
/// edge that the other camera does not see.
///
/// What stopped is not taken for moving on: the place of the likeness must be nearer to the one
/// expected than to the one where the mover was seen last. Its distance is the expected one, the
/// more uncertain the longer ago it was measured. What was found in one frame alone is not sought.
///
/// @param movers  as above
void recogniseLooks(const LookedAt& frame, const std::vector<ObjectIdentity>& missing,
                    const StereoCamera& camera, std::vector<Mover>& movers);

}  // namespace headway::detect
