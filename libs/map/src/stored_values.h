#pragma once

#include <headway/core/ground_scan.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/slam/map_view.h>
#include <mrpt/serialization/CArchive.h>

namespace headway::map {

// How our values stand in an MRPT archive: fixed-width little-endian numbers, counts before lists.
// Readers throw std::exception where the archive ends early or holds what cannot be.

void write(mrpt::serialization::CArchive& out, const Pose& pose);
void write(mrpt::serialization::CArchive& out, const Track& track);
void write(mrpt::serialization::CArchive& out, const StereoCamera& camera);
void write(mrpt::serialization::CArchive& out, const slam::MapView& still_world);
void write(mrpt::serialization::CArchive& out, const GroundScan& scan);

[[nodiscard]] Pose readPose(mrpt::serialization::CArchive& in);
[[nodiscard]] Track readTrack(mrpt::serialization::CArchive& in);
[[nodiscard]] StereoCamera readCamera(mrpt::serialization::CArchive& in);
[[nodiscard]] slam::MapView readMapView(mrpt::serialization::CArchive& in);
[[nodiscard]] GroundScan readGroundScan(mrpt::serialization::CArchive& in);

}  // namespace headway::map
