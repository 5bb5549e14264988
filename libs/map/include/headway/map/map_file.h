#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/map/perception_map.h>

#include <map>
#include <optional>
#include <string>

namespace headway::map {

/// Name of the attachment that holds StereoSlam::save(). Where it is there, the file holds the
/// landmarks in it alone, and loading derives the map's view of them.
inline constexpr char kSlamAttachment[] = "slam";

/// Name of the attachment that holds StaticGrid::save().
inline constexpr char kGridAttachment[] = "grid";

/// All that `map.headway` holds.
struct StoredMap {
  PerceptionMap map;
  std::string configuration;           ///< the .ini text it was made with
  std::optional<StereoCamera> camera;  ///< empty where poses came from elsewhere
  /// Sections of other libraries, by name: bytes that are stored and returned unchanged.
  std::map<std::string, std::string> attachments;
};

/// Writes a map file: versioned, compressed and checksummed.
///
/// Written beside its final name first and then renamed, so that a file of that name is always a
/// whole one. Same contents, same bytes.
///
/// @throws InputError if it cannot be written
void saveMap(const std::string& path, const StoredMap& stored);

/// Reads a map file written by saveMap.
///
/// @throws InputError saying whether the file is missing, foreign, truncated, damaged or of
///         another version than this program reads
[[nodiscard]] StoredMap loadMap(const std::string& path);

}  // namespace headway::map
