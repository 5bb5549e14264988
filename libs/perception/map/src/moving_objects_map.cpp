// SPDX-License-Identifier: BSD-3-Clause
// Moving objects as an MRPT metric map, and their 3D picture.
#include <headway/core/error.h>
#include <headway/core/mrpt_compat.h>
#include <headway/core/object_class.h>
#include <headway/core/output_file.h>
#include <headway/map/map_export.h>
#include <headway/map/moving_objects_map.h>
#include <headway/map/track_geometry.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTriangles.h>
#include <mrpt/opengl/CText.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "stored_values.h"

namespace headway::map {
namespace {

constexpr double kDashM = 0.8, kGapM = 0.5;  // of predictions in streets
constexpr double kShortestPathM = 0.5;       // a prediction that stays within this is no path
constexpr double kMinProbability = 0.05;     // of a prediction that is shown

/// Flat bands, from the lowest to the highest, so that they do not have the same depth.
enum class Band { kUncertainty, kTrail, kPrediction };

double bandWidth(const Track& track, double scale) {
  return std::sqrt(scale) * (isVehicle(track.object_class) ? 0.30 : 0.16);
}

std::vector<Eigen::Vector3d> raised(std::vector<Eigen::Vector3d> polyline, Band band) {
  for (auto& point : polyline) point.z() += 0.03 + 0.02 * static_cast<int>(band);  // [m]
  return polyline;
}

mrpt::math::TPoint3Df toFloat(const Eigen::Vector3d& point) {
  return {static_cast<float>(point.x()), static_cast<float>(point.y()),
          static_cast<float>(point.z())};
}

void appendFace(const std::array<Eigen::Vector3d, 8>& corners, const std::array<int, 4>& face,
                const mrpt::img::TColor& colour, mrpt::opengl::CSetOfTriangles& out) {
  const auto at = [&](int i) { return toFloat(corners[static_cast<std::size_t>(face[i])]); };
  mrpt::opengl::TTriangle first(at(0), at(1), at(2));
  mrpt::opengl::TTriangle second(at(0), at(2), at(3));
  for (auto* triangle : {&first, &second}) {
    triangle->setColor(colour);
    out.insertTriangle(*triangle);
  }
}

/// Translucent sides and, on the roof, a wedge that points to the front.
void appendFaces(const Track& track, mrpt::opengl::CSetOfTriangles& out) {
  const auto corners = boxCorners(track);
  const Colour c = colourOf(track.object_class);
  const std::uint8_t opacity = track.status == TrackStatus::kConfirmed ? 70 : 32;
  const mrpt::img::TColor colour(c.red, c.green, c.blue, opacity);
  for (const std::array<int, 4>& face :
       {std::array<int, 4>{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}}) {
    appendFace(corners, face, colour, out);
  }
  const Eigen::Vector3d above(0.0, 0.0, 0.02);
  const Eigen::Vector3d nose = 0.5 * (corners[4] + corners[5]) + above;
  const Eigen::Vector3d left = 0.5 * (corners[4] + corners[7]) + above;
  const Eigen::Vector3d right = 0.5 * (corners[5] + corners[6]) + above;
  mrpt::opengl::TTriangle wedge(toFloat(nose), toFloat(left), toFloat(right));
  wedge.setColor(mrpt::img::TColor(c.red, c.green, c.blue, 200));
  out.insertTriangle(wedge);
}

void appendEdges(const Track& track, mrpt::opengl::CSetOfLines& out) {
  const auto corners = boxCorners(track);
  for (const auto& [a, b] : kBoxEdges) {
    out.appendLine(toFloat(corners[static_cast<std::size_t>(a)]),
                   toFloat(corners[static_cast<std::size_t>(b)]));
  }
}

void appendTrail(const Track& track, double scale, mrpt::opengl::CSetOfTriangles& out) {
  const auto trail = raised(groundTrail(track), Band::kTrail);
  appendRibbon(
      trail, HalfWidths(trail.size(), 0.5 * bandWidth(track, scale)), colourOf(track.object_class),
      [](double along) { return 40.0 + 190.0 * along; }, out);
}

void appendDashes(const Track& track, const PredictedPath& prediction, double scale, Colour colour,
                  mrpt::opengl::CSetOfTriangles& out) {
  const auto path = raised(groundPath(track, prediction), Band::kPrediction);
  const double opacity = 90.0 + 165.0 * prediction.probability;
  for (const auto& dash : dashesOf(path, scale * kDashM, scale * kGapM)) {
    appendRibbon(dash, 1.2 * bandWidth(track, scale), colour, opacity, out);
  }
}

/// A band of one standard deviation to each side, across the path.
void appendUncertainty(const Track& track, const PredictedPath& prediction, double scale,
                       Colour colour, mrpt::opengl::CSetOfTriangles& out) {
  const auto path = raised(groundPath(track, prediction), Band::kUncertainty);
  HalfWidths half_widths{0.5 * bandWidth(track, scale)};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d way = (path[i] - path[i - 1]).head<2>();
    Eigen::Vector2d normal = Eigen::Vector2d::UnitY();
    if (way.norm() > 1e-9) normal = Eigen::Vector2d(-way.y(), way.x()) / way.norm();
    const double variance = normal.dot(prediction.points[i - 1].covariance * normal);
    half_widths.push_back(std::sqrt(std::max(variance, 0.0)));
  }
  const double probability = prediction.probability;
  appendRibbon(
      path, half_widths, colour,
      [probability](double along) { return probability * (44.0 - 34.0 * along); }, out);
}

std::shared_ptr<mrpt::opengl::CText> labelOf(const Track& track) {
  auto label = mrpt::opengl::CText::Create(std::string(displayName(track.object_class)) + " " +
                                           std::to_string(track.id.value));
  const Colour c = colourOf(track.object_class);
  label->setColor_u8(c.red, c.green, c.blue);
  label->setLocation(track.position.x(), track.position.y(),
                     track.position.z() + 0.5 * track.size.z() + 0.3);
  return label;
}

std::shared_ptr<mrpt::opengl::CSetOfTriangles> newTriangles(const std::string& name) {
  auto triangles = mrpt::opengl::CSetOfTriangles::Create();
  triangles->setName(name);
  triangles->enableLight(false);
  return triangles;
}

std::vector<const Track*> shownTracks(const std::vector<Track>& tracks, bool show_tentative) {
  std::vector<const Track*> shown;
  for (const auto& track : tracks) {
    if (isShown(track) || (show_tentative && track.status == TrackStatus::kTentative)) {
      shown.push_back(&track);
    }
  }
  return shown;
}

void insertPaths(const std::vector<const Track*>& tracks,
                 const CMovingObjectsMap::TInsertionOptions& options, double scale, Colour colour,
                 mrpt::opengl::CSetOfObjects& out) {
  auto uncertainty = newTriangles("uncertainty");
  auto predictions = newTriangles("predictions");
  auto trails = newTriangles("trails");
  for (const Track* track : tracks) {
    if (!isMoving(*track)) continue;  // static objects have neither trail nor prediction
    appendTrail(*track, scale, *trails);
    for (const auto& prediction : track->predictions) {
      if (prediction.probability < kMinProbability ||
          lengthOf(groundPath(*track, prediction)) < kShortestPathM) {
        continue;
      }
      if (options.show_uncertainty)
        appendUncertainty(*track, prediction, scale, colour, *uncertainty);
      if (options.show_predictions) appendDashes(*track, prediction, scale, colour, *predictions);
    }
  }
  out.insert(uncertainty);
  out.insert(trails);
  out.insert(predictions);
}

void insertEdges(const std::vector<const Track*>& tracks, mrpt::opengl::CSetOfObjects& out) {
  for (int i = 0; i < kObjectClassCount; ++i) {
    const auto object_class = static_cast<ObjectClass>(i);
    auto edges = mrpt::opengl::CSetOfLines::Create();
    for (const Track* track : tracks) {
      if (track->object_class == object_class) appendEdges(*track, *edges);
    }
    if (edges->empty()) continue;
    const Colour c = colourOf(object_class);
    edges->setName("edges_" + std::string(toString(object_class)));
    edges->setColor_u8(c.red, c.green, c.blue);
    edges->setLineWidth(2.f);
    out.insert(edges);
  }
}

/// Adds the 3D objects that show tracks, one per kind and not one per track, since drawing time
/// depends on the number of objects: `uncertainty`, `predictions`, `trails`, `faces`,
/// `edges_<class>`, `labels`.
///
/// @param scale              of widths of paths and lengths of dashes; 1 for streets
/// @param prediction_colour  of predicted paths and their uncertainty
void insertTrackVisual(const std::vector<Track>& tracks,
                       const CMovingObjectsMap::TInsertionOptions& options, double scale,
                       Colour prediction_colour, mrpt::opengl::CSetOfObjects& out) {
  const auto shown = shownTracks(tracks, options.show_tentative);
  if (shown.empty()) return;
  insertPaths(shown, options, scale, prediction_colour, out);
  auto faces = newTriangles("faces");
  for (const Track* track : shown) appendFaces(*track, *faces);
  out.insert(faces);
  insertEdges(shown, out);
  if (!options.show_labels) return;
  auto labels = mrpt::opengl::CSetOfObjects::Create();
  labels->setName("labels");
  for (const Track* track : shown) labels->insert(labelOf(*track));
  out.insert(labels);
}

}  // namespace
}  // namespace headway::map

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
