#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/map/perception_map.h>

#include <map>
#include <optional>
#include <string>

namespace headway::map {

/// All that `map.headway` holds.
struct StoredMap {
  PerceptionMap map;
  std::string configuration;           ///< the .ini text it was made with
  std::optional<StereoCamera> camera;  ///< empty where poses came from elsewhere
  /// Sections that other rooms keep in the file, by name (place descriptors of slam, ...): bytes
  /// that are stored and handed back as they are.
  std::map<std::string, std::string> attachments;
};

/// Writes a map file: versioned, compressed and checksummed.
///
/// Written beside its final name first and then renamed, so that a file of that name is always a
/// whole one. Same contents, same bytes.
///
/// @throws InputError if it cannot be written
void saveMap(const std::string& path, const StoredMap& stored);

/// Reads a map file written by saveMap, of this or any earlier version.
///
/// @throws InputError saying whether the file is missing, foreign, truncated, damaged or of a
///         newer version than this program knows
[[nodiscard]] StoredMap loadMap(const std::string& path);

}  // namespace headway::map
