#include <headway/core/error.h>
#include <headway/map/map_file.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include "checked_file.h"
#include "stored_values.h"

namespace headway::map {
namespace {

using mrpt::serialization::archiveFrom;
using mrpt::serialization::CArchive;

constexpr char kConfiguration[] = "configuration";
constexpr char kCamera[] = "camera";
constexpr char kStillWorld[] = "still_world";
constexpr char kLayers[] = "layers";
constexpr char kAttachment[] = "attachment:";

/// Version of each section's contents; a section of a newer one cannot be read.
constexpr std::uint32_t kSectionVersion = 1;

template <typename Write>
Section sectionOf(const std::string& name, const Write& write) {
  mrpt::io::CMemoryStream stream;
  auto archive = archiveFrom(stream);
  write(archive);
  return {name, kSectionVersion,
          std::string(static_cast<const char*>(stream.getRawBufferData()),
                      stream.getTotalBytesCount())};
}

template <typename Read>
auto readSection(const Section& section, const Read& read) {
  if (section.version > kSectionVersion) {
    throw InputError("its section '" + section.name +
                     "' is of a newer version than this program knows");
  }
  mrpt::io::CMemoryStream stream;
  stream.assignMemoryNotOwn(section.bytes.data(), section.bytes.size());
  auto archive = archiveFrom(stream);
  try {
    return read(archive);
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    throw InputError("its section '" + section.name + "' cannot be read (" +
                     reason.substr(0, reason.find('\n')) + ")");
  }
}

std::shared_ptr<mrpt::maps::CMultiMetricMap> readLayers(CArchive& archive) {
  auto layers = std::make_shared<mrpt::maps::CMultiMetricMap>();
  archive.ReadObject(layers.get());
  return layers;
}

/// Takes one section over; those that are not known are left alone (a later minor addition).
void take(const Section& section, StoredMap& stored, std::optional<slam::MapView>& still_world) {
  const std::string attachment = kAttachment;
  if (section.name == kConfiguration) {
    stored.configuration = section.bytes;
  } else if (section.name == kCamera) {
    stored.camera = readSection(section, readCamera);
  } else if (section.name == kStillWorld) {
    still_world = readSection(section, readMapView);
  } else if (section.name == kLayers) {
    stored.map = PerceptionMap(readSection(section, readLayers));
  } else if (section.name.rfind(attachment, 0) == 0) {
    stored.attachments[section.name.substr(attachment.size())] = section.bytes;
  }
}

}  // namespace

void saveMap(const std::string& path, const StoredMap& stored) {
  std::vector<Section> sections;
  sections.push_back({kConfiguration, kSectionVersion, stored.configuration});
  if (stored.camera) {
    sections.push_back(sectionOf(kCamera, [&](CArchive& out) { write(out, *stored.camera); }));
  }
  sections.push_back(
      sectionOf(kStillWorld, [&](CArchive& out) { write(out, *stored.map.stillWorld()); }));
  sections.push_back(
      sectionOf(kLayers, [&](CArchive& out) { out.WriteObject(stored.map.layers()); }));
  for (const auto& [name, bytes] : stored.attachments) {
    sections.push_back({kAttachment + name, kSectionVersion, bytes});
  }
  writeCheckedFile(path, sections);
}

StoredMap loadMap(const std::string& path) {
  try {
    StoredMap stored;
    std::optional<slam::MapView> still_world;
    for (const auto& section : readCheckedFile(path)) take(section, stored, still_world);
    if (!still_world) throw InputError("it lacks the section 'still_world'");
    stored.map.update(std::move(*still_world));
    return stored;
  } catch (const InputError& error) {
    throw InputError(path + ": not a map that can be read: " + error.what());
  }
}

}  // namespace headway::map
