// SPDX-License-Identifier: BSD-3-Clause
// Contents of the file map.headway.
#include <headway/core/byte_archive.h>
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/core/version.h>
#include <headway/map/dense_map.h>
#include <headway/map/map_file.h>
#include <headway/slam/stereo_slam.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include "checked_file.h"
#include "stored_values.h"

namespace headway::map {
namespace {

using mrpt::serialization::archiveFrom;

constexpr char kProgram[] = "program";  // whose version wrote the file; missing before 0.2
constexpr char kConfiguration[] = "configuration";
constexpr char kCamera[] = "camera";
constexpr char kStaticMap[] = "static_map";
constexpr char kLayers[] = "layers";
constexpr char kAttachment[] = "attachment:";

/// Version of each section's contents; newer sections cannot be read.
constexpr std::uint32_t kSectionVersion = 1;

template <typename Value>
SectionSource sectionOf(const std::string& name, const Value& value) {
  ByteWriter out;
  write(out, value);
  return {name, kSectionVersion, sourceOf(std::move(out.bytes))};
}

/// The layers are serialised by MRPT, without what is restored on loading: their landmarks, which
/// are a copy of the static map, and dense points with the scans that they follow from.
SectionSource layersWithoutPoints(PerceptionMap map, bool holds_scans) {
  map.update(slam::MapView());
  if (holds_scans && map.dense() != nullptr) {
    map.update(mrpt::maps::CColouredPointsMap::Create());
  }
  mrpt::io::CMemoryStream stream;
  archiveFrom(stream).WriteObject(map.layers());
  return {kLayers, kSectionVersion,
          sourceOf(std::string(static_cast<const char*>(stream.getRawBufferData()),
                               stream.getTotalBytesCount()))};
}

template <typename Read>
auto readSection(const Section& section, const Read& read) {
  if (section.version > kSectionVersion) {
    throw InputError("its section '" + section.name + "' is of a newer version than headway " +
                     headway::kVersion + " supports");
  }
  try {
    return read(section.bytes);
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    throw InputError("its section '" + section.name + "' cannot be read (" +
                     reason.substr(0, reason.find('\n')) + ")");
  }
}

template <typename Value>
Value readValue(const Section& section, Value (*read)(ByteReader&)) {
  return readSection(section, [&](const std::string& bytes) {
    ByteReader in(bytes);
    return read(in);
  });
}

// COccupancyGridMap2D of MRPT 2.5.8 is stored as class name, u8 version, u8 bits of a cell, u32
// columns, u32 rows, five floats, its cells and its options, among them one vector of floats.
constexpr std::string_view kGrid = "COccupancyGridMap2D";
constexpr std::size_t kGridHeader = 30;  // bytes of the former

/// Bytes of a stored grid from the end of its cells to the size of that vector; nullopt if MRPT
/// does not store it.
std::optional<std::size_t> bytesBeforeWeights() {
  mrpt::maps::COccupancyGridMap2D grid;
  grid.likelihoodOptions.OWA_weights = {1.2345F};
  const auto cells = static_cast<std::size_t>(grid.getSizeX()) * grid.getSizeY();
  mrpt::io::CMemoryStream stream;
  archiveFrom(stream) << grid;
  const std::string bytes(static_cast<const char*>(stream.getRawBufferData()),
                          static_cast<std::size_t>(stream.getTotalBytesCount()));
  std::string weights(8, '\0');
  const std::uint32_t count = 1;
  std::memcpy(&weights[0], &count, 4);
  std::memcpy(&weights[4], grid.likelihoodOptions.OWA_weights.data(), 4);
  const auto at = bytes.rfind(weights);
  if (at == bytes.npos) return std::nullopt;
  return at - (bytes.find(kGrid) + kGrid.size() + kGridHeader + cells);
}

/// Whether so many cells cover the extent, from which MRPT takes the number again on reading.
bool covers(std::uint64_t cells, float from, float to, float resolution) {
  return std::abs((static_cast<double>(to) - from) / resolution - static_cast<double>(cells)) < 0.5;
}

/// Refuses a grid with more cells or weights than bytes, because MRPT allocates what its sizes ask
/// for.
void requireGridsWithin(std::string_view bytes) {
  static const auto before_weights = bytesBeforeWeights();
  for (auto at = bytes.find(kGrid); at != bytes.npos; at = bytes.find(kGrid, at + 1)) {
    const auto left = bytes.substr(at + kGrid.size());
    if (left.size() < kGridHeader) return;
    ByteReader in(left.substr(2));
    const std::uint64_t columns = in.value<std::uint32_t>();
    const std::uint64_t rows = in.value<std::uint32_t>();
    if (rows > 0 && columns > left.size() / rows) {
      throw InputError("damaged: a grid has more cells than bytes");
    }
    const auto x_min = in.value<float>(), x_max = in.value<float>();
    const auto y_min = in.value<float>(), y_max = in.value<float>();
    const auto resolution = in.value<float>();
    if (!covers(columns, x_min, x_max, resolution) || !covers(rows, y_min, y_max, resolution)) {
      throw InputError("damaged: a grid's cells do not cover its extent");
    }
    if (!before_weights) continue;
    const std::size_t weights = kGridHeader + rows * columns + *before_weights;
    if (left.size() < weights + sizeof(std::uint32_t)) return;
    ByteReader options(left.substr(weights));
    if (options.value<std::uint32_t>() > left.size() / sizeof(float)) {
      throw InputError("damaged: a grid has more weights than bytes");
    }
  }
}

/// The same for layers and points: class name, u8 version, u32 count.
///
/// @param bytes_of_one  element, at least
void requireElementsWithin(std::string_view bytes, std::string_view name,
                           std::size_t bytes_of_one) {
  for (auto at = bytes.find(name); at != bytes.npos; at = bytes.find(name, at + 1)) {
    const auto left = bytes.substr(at + name.size());
    if (left.size() < 5) return;
    ByteReader in(left.substr(1));
    if (in.value<std::uint32_t>() > left.size() / bytes_of_one) {
      throw InputError("damaged: a " + std::string(name) + " has more elements than bytes");
    }
  }
}

std::shared_ptr<mrpt::maps::CMultiMetricMap> readLayers(const std::string& bytes) {
  requireGridsWithin(bytes);
  requireElementsWithin(bytes, "CMultiMetricMap", 3);
  requireElementsWithin(bytes, "PointsMap", 3 * sizeof(float));
  mrpt::io::CMemoryStream stream;
  stream.assignMemoryNotOwn(bytes.data(), bytes.size());
  auto layers = std::make_shared<mrpt::maps::CMultiMetricMap>();
  archiveFrom(stream).ReadObject(layers.get());
  return layers;
}

/// Applies one section; unknown ones are ignored, so that later versions may add some.
void apply(Section&& section, StoredMap& stored, std::optional<slam::MapView>& static_map) {
  const std::string attachment = kAttachment;
  if (section.name == kConfiguration) {
    stored.configuration = std::move(section.bytes);
  } else if (section.name == kCamera) {
    stored.camera = readValue(section, readCamera);
  } else if (section.name == kStaticMap) {
    static_map = readValue(section, readMapView);
  } else if (section.name == kLayers) {
    stored.map = PerceptionMap(readSection(section, readLayers));
  } else if (section.name.rfind(attachment, 0) == 0) {
    stored.attachments[section.name.substr(attachment.size())] = std::move(section.bytes);
  }
}

bool holds(const StoredMap& stored, const char* attachment) {
  return stored.attachments.count(attachment) > 0 || stored.made_attachments.count(attachment) > 0;
}

/// Whether the static map can be derived from SLAM's attachment.
bool holdsSlamMap(const StoredMap& stored) {
  return stored.camera && holds(stored, kSlamAttachment);
}

}  // namespace

void saveMap(const std::string& path, StoredMap stored) {
  std::vector<SectionSource> sections;
  sections.push_back(
      {kProgram, kSectionVersion, sourceOf(std::string("headway ") + headway::kVersion)});
  sections.push_back({kConfiguration, kSectionVersion, sourceOf(std::move(stored.configuration))});
  if (stored.camera) {
    sections.push_back(sectionOf(kCamera, *stored.camera));
  }
  if (!holdsSlamMap(stored)) {
    sections.push_back(sectionOf(kStaticMap, *stored.map.staticMap()));
  }
  sections.push_back(layersWithoutPoints(stored.map, holds(stored, kDenseAttachment)));
  auto attachments = std::move(stored.made_attachments);
  for (auto& [name, bytes] : stored.attachments) attachments[name] = sourceOf(std::move(bytes));
  for (auto& [name, bytes] : attachments) {
    sections.push_back({kAttachment + name, kSectionVersion, std::move(bytes)});
  }
  writeCheckedFile(path, sections);
}

StoredMap loadMap(const std::string& path) {
  std::string writer;
  try {
    StoredMap stored;
    std::optional<slam::MapView> static_map;
    for (auto& section : readCheckedFile(path)) {
      if (section.name == kProgram) writer = " (written by " + printable(section.bytes) + ")";
      apply(std::move(section), stored, static_map);
    }
    if (holdsSlamMap(stored)) {
      static_map =
          slam::savedMapView(stored.attachments[kSlamAttachment], stored.camera->T_robot_cam);
    }
    if (!static_map) throw InputError("it lacks the section 'static_map'");
    stored.map.update(std::move(*static_map));
    const auto scans = stored.attachments.find(kDenseAttachment);
    if (scans != stored.attachments.end()) {
      if (const auto dense = denseLayer(scans->second)) stored.map.update(dense);
    }
    return stored;
  } catch (const InputError& error) {
    throw InputError(path + ": not a map that can be read" + writer + ": " + error.what());
  }
}

}  // namespace headway::map
