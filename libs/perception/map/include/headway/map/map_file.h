// SPDX-License-Identifier: BSD-3-Clause
// Contents of the file map.headway.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/stereo_camera.h>
#include <headway/map/perception_map.h>

#include <map>
#include <optional>
#include <string>

namespace headway::map {

/// Name of the attachment with StereoSlam::save(). If present, landmarks are stored in it only, and
/// loading derives the map's view of them.
inline constexpr char kSlamAttachment[] = "slam";

/// Name of the attachment with StaticGrid::save().
inline constexpr char kGridAttachment[] = "grid";

/// Name of the attachment with DenseMap::save(). If present, the layer of dense points is not
/// stored, and loading derives it.
inline constexpr char kDenseAttachment[] = "dense";

/// Contents of `map.headway`.
struct StoredMap {
  PerceptionMap map;
  std::string configuration;           ///< .ini text of the run that produced it
  std::optional<StereoCamera> camera;  ///< empty if poses were given
  /// Sections of other libraries, by name: bytes that are stored and returned unchanged.
  std::map<std::string, std::string> attachments;
  /// Attachments whose bytes are made while the file is written. Loading gives `attachments`.
  std::map<std::string, ByteSource> made_attachments;
};

/// Writes a map file: versioned, compressed and checksummed.
///
/// Written to a temporary file first and then renamed, so that a file of that name is always
/// complete. Same contents, same bytes. A map that is handed over (std::move) is not copied, nor
/// are the bytes of its made attachments ever in memory together.
///
/// @throws InputError if it cannot be written
void saveMap(const std::string& path, StoredMap stored);

/// Reads a map file written by saveMap.
///
/// @throws InputError stating whether the file is missing, not a map, truncated, damaged or of
///         another format version
[[nodiscard]] StoredMap loadMap(const std::string& path);

}  // namespace headway::map
