// SPDX-License-Identifier: BSD-3-Clause
// Serialisation of poses, tracks, scans and views of the map in map files.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/scan.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/slam/map_view.h>

namespace headway::map {

// Serialisation of values in map files. Readers throw InputError if the bytes end early or contain
// invalid values.

void write(ByteWriter& out, const Pose& pose);
void write(ByteWriter& out, const Track& track);
void write(ByteWriter& out, const StereoCamera& camera);
void write(ByteWriter& out, const slam::MapView& static_map);
void write(ByteWriter& out, const GroundScan& scan, bool with_laser);

[[nodiscard]] Pose readPose(ByteReader& in);
[[nodiscard]] Track readTrack(ByteReader& in);
[[nodiscard]] StereoCamera readCamera(ByteReader& in);
[[nodiscard]] slam::MapView readMapView(ByteReader& in);
[[nodiscard]] GroundScan readGroundScan(ByteReader& in, bool with_laser);

void write(ByteWriter& out, const DepthScan& scan);

/// @throws InputError if the bytes end early, or contain an invalid camera or other numbers of
///         depths and colours than known cells
[[nodiscard]] DepthScan readDepthScan(ByteReader& in);

}  // namespace headway::map
