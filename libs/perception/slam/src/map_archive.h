// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/stereo_camera.h>

#include <optional>
#include <string>

#include "sparse_map.h"

namespace headway::slam {

/// The whole map as bytes: version, camera, keyframes, landmarks with patches and descriptors. The
/// patches, two thirds of them, are shared with the map and are only copied into the sink.
[[nodiscard]] ByteSource mapBytes(const SparseMap& map, const StereoCamera& camera);

/// The same in one string.
///
/// Law: unpackMap(packMap(map)) has the same landmarks, keyframes and links, bit by bit.
[[nodiscard]] std::string packMap(const SparseMap& map, const StereoCamera& camera);

/// Reads what packMap wrote.
///
/// @param camera  that is going to use the map; empty: any
/// @param made_by  gets the camera of the map, without its pose on the robot; null: not wanted
/// @throws InputError if the bytes are cut off, damaged, of another version, or the map was made
///         with another camera
[[nodiscard]] SparseMap unpackMap(const std::string& bytes,
                                  const std::optional<StereoCamera>& camera,
                                  StereoCamera* made_by = nullptr);

}  // namespace headway::slam
