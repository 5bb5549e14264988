// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/mrpt_compat.h>
#include <headway/core/output_file.h>
#include <headway/map/moving_objects_map.h>
#include <headway/map/object_file.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <sstream>

#include "stored_values.h"
#include "track_visual.h"

using headway::CMovingObjectsMap;

// Registered for multi-metric maps under both names ...
MAP_DEFINITION_REGISTER("headway::CMovingObjectsMap,movingObjectsMap", headway::CMovingObjectsMap)

namespace headway {

IMPLEMENTS_SERIALIZABLE(CMovingObjectsMap, CMetricMap, headway)

namespace {

// ... and for serialisation under its class name, which some compilers fill in at start-up: after
// it, not by MRPT_INITIALIZER, which may run before.
struct MovingObjectsMapRegistration {
  MovingObjectsMapRegistration() { mrpt::rtti::registerClass(CLASS_ID(CMovingObjectsMap)); }
} const moving_objects_map_registration;

/// A string as CArchive writes it: its size (u32), then its bytes. Read in blocks, because CArchive
/// allocates the size that a damaged stream claims.
std::string readString(mrpt::serialization::CArchive& in) {
  constexpr std::size_t kBlock = 1 << 16;
  std::string result;
  for (std::size_t left = in.ReadAs<std::uint32_t>(); left > 0;) {
    const std::size_t block = std::min(left, kBlock), end = result.size();
    result.resize(end + block);
    if (in.ReadBuffer(&result[end], block) != block) throw InputError("damaged: tracks end early");
    left -= block;
  }
  return result;
}

}  // namespace

using mrpt::serialization::CArchive;

void CMovingObjectsMap::setTracks(Time time, std::vector<Track> tracks) {
  time_ = time;
  tracks_ = std::move(tracks);
}

std::string CMovingObjectsMap::asString() const {
  return "Moving objects map with " + std::to_string(tracks_.size()) + " tracks.";
}

std::uint8_t CMovingObjectsMap::serializeGetVersion() const { return 1; }

void CMovingObjectsMap::serializeTo(CArchive& out) const {
  ByteWriter tracks;
  tracks.count(tracks_.size());
  for (const auto& track : tracks_) map::write(tracks, track);
  out << time_ << tracks.bytes;
  out << insertionOptions.show_tentative << insertionOptions.show_labels
      << insertionOptions.show_predictions << insertionOptions.show_uncertainty;
  out << genericMapParams;
}

void CMovingObjectsMap::serializeFrom(CArchive& in, std::uint8_t serial_version) {
  switch (serial_version) {
    case 1: {
      in >> time_;
      const std::string bytes = readString(in);
      ByteReader tracks(bytes);
      tracks_ = tracks.list<Track>(map::readTrack);
      in >> insertionOptions.show_tentative >> insertionOptions.show_labels >>
          insertionOptions.show_predictions >> insertionOptions.show_uncertainty;
      in >> genericMapParams;
    } break;
    default:
      MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(serial_version);
  }
}

void CMovingObjectsMap::getVisualizationInto(mrpt::opengl::CSetOfObjects& out) const {
  if (!genericMapParams.enableSaveAs3DObject) return;
  map::insertTrackVisual(tracks_, insertionOptions, line_scale, prediction_colour, out);
}

void CMovingObjectsMap::saveMetricMapRepresentationToFile(const std::string& prefix) const {
  mrpt::opengl::COpenGLScene scene;
  auto objects = mrpt::opengl::CSetOfObjects::Create();
  getVisualizationInto(*objects);
  scene.insert(objects);
  map::writeObject(prefix + "_moving_objects.3Dscene", scene);
  std::ostringstream text;
  text << "# time id class status x y z yaw vx vy vz length width height\n";
  text.precision(9);
  for (const auto& track : tracks_) {
    text << std::fixed << time_ << ' ' << track.id.value << ' ' << toString(track.object_class)
         << ' ' << toString(track.status) << ' ' << track.position.transpose() << ' ' << track.yaw
         << ' ' << track.velocity.transpose() << ' ' << track.size.transpose() << '\n';
  }
  writeFile(prefix + "_moving_objects.txt", text.str());
}

void CMovingObjectsMap::internal_clear() {
  tracks_.clear();
  time_ = 0.0;
}

bool CMovingObjectsMap::internal_insertObservation(
    const mrpt::obs::CObservation& /*observation*/,
    const std::optional<const mrpt::poses::CPose3D>& /*robot_pose*/) {
  return false;
}

double CMovingObjectsMap::internal_computeObservationLikelihood(
    const mrpt::obs::CObservation& /*observation*/,
    const mrpt::poses::CPose3D& /*taken_from*/) const {
  return 0.0;
}

bool CMovingObjectsMap::internal_canComputeObservationLikelihood(
    const mrpt::obs::CObservation& /*observation*/) const {
  return false;
}

void CMovingObjectsMap::TInsertionOptions::loadFromConfigFile(
    const mrpt::config::CConfigFileBase& source, const std::string& section) {
  show_tentative = source.read_bool(section, "show_tentative", show_tentative);
  show_labels = source.read_bool(section, "show_labels", show_labels);
  show_predictions = source.read_bool(section, "show_predictions", show_predictions);
  show_uncertainty = source.read_bool(section, "show_uncertainty", show_uncertainty);
}

void CMovingObjectsMap::TInsertionOptions::dumpToTextStream(std::ostream& out) const {
  out << "show_tentative   = " << (show_tentative ? "true" : "false") << "\n"
      << "show_labels      = " << (show_labels ? "true" : "false") << "\n"
      << "show_predictions = " << (show_predictions ? "true" : "false") << "\n"
      << "show_uncertainty = " << (show_uncertainty ? "true" : "false") << "\n";
}

CMovingObjectsMap::TMapDefinition::TMapDefinition() = default;

void CMovingObjectsMap::TMapDefinition::loadFromConfigFile_map_specific(
    const mrpt::config::CConfigFileBase& source, const std::string& section_prefix) {
  insertionOpts.loadFromConfigFile(source, section_prefix + "_insertOpts");
}

void CMovingObjectsMap::TMapDefinition::dumpToTextStream_map_specific(std::ostream& out) const {
  insertionOpts.dumpToTextStream(out);
}

MrptCreatedMap CMovingObjectsMap::internal_CreateFromMapDefinition(
    const mrpt::maps::TMetricMapInitializer& definition) {
  const auto& ours = dynamic_cast<const TMapDefinition&>(definition);
  auto map = std::make_unique<CMovingObjectsMap>();
  map->insertionOptions = ours.insertionOpts;
  return MrptCreatedMap(map.release());
}

}  // namespace headway
