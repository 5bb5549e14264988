// SPDX-License-Identifier: BSD-3-Clause
// The map as a snapshot of MRPT layers, static ones and moving objects.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/map/perception_map.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/maps/CColouredOctoMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/maps/TMetricMapInitializer.h>
#include <mrpt/maps/TMetricMapTypesRegistry.h>

#include <algorithm>
#include <filesystem>

namespace headway::map {
namespace {

using mrpt::maps::CColouredPointsMap;
using mrpt::maps::CMultiMetricMap;
using mrpt::maps::CPointsMap;

std::shared_ptr<CMultiMetricMap> defaultLayers() {
  auto layers = std::make_shared<CMultiMetricMap>();
  layers->maps.push_back(mrpt::maps::CSimplePointsMap::Create());
  layers->maps.push_back(CMovingObjectsMap::Create());
  return layers;
}

/// MRPT before 2.11.3 does not report unknown kinds of maps.
void requireKnownKinds(const mrpt::config::CConfigFileBase& file, const std::string& path,
                       const std::string& section) {
  const std::string ending = "_count";
  const auto& registered =
      mrpt::maps::internal::TMetricMapTypesRegistry::Instance().getAllRegistered();
  std::vector<std::string> keys;
  file.getAllKeys(section, keys);
  for (const auto& key : keys) {
    if (!endsWith(key, ending)) continue;
    const std::string kind = key.substr(0, key.size() - ending.size());
    if (registered.count(kind) == 0) {
      throw InputError(path + ": [" + section + "] " + key + ": no kind of map is called '" + kind +
                       "'");
    }
  }
}

/// Replaces all points of a layer; layers without colour ignore the grey value.
void insertLandmarks(const slam::MapView& static_map, CPointsMap& points) {
  points.clear();
  points.reserve(static_map.landmarks.size());
  for (const auto& landmark : static_map.landmarks) {
    const float grey = static_cast<float>(landmark.intensity) / 255.f;
    const Eigen::Vector3f p = landmark.position.cast<float>();
    points.insertPointRGB(p.x(), p.y(), p.z(), grey, grey, grey);
  }
  // MRPT computes these lazily: done here, because two readers must not do it concurrently.
  static_cast<void>(points.boundingBox());
  static_cast<void>(points.getLargestDistanceFromOrigin());
}

/// The same points as voxels, of the resolution and with the options of a layer.
mrpt::maps::CColouredOctoMap::Ptr octoMapOf(const CColouredPointsMap& points,
                                            const mrpt::maps::CColouredOctoMap& layer) {
  auto voxels = std::make_shared<mrpt::maps::CColouredOctoMap>(layer.getResolution());
  voxels->genericMapParams = layer.genericMapParams;
  voxels->insertionOptions = layer.insertionOptions;
  voxels->likelihoodOptions = layer.likelihoodOptions;
  voxels->renderingOptions = layer.renderingOptions;
  voxels->setVoxelColourMethod(mrpt::maps::CColouredOctoMap::SET);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Array3f p, colour;
    points.getPointRGB(i, p.x(), p.y(), p.z(), colour.x(), colour.y(), colour.z());
    const Eigen::Array3d at = p.cast<double>();
    const Eigen::Array<std::uint8_t, 3, 1> bytes = (255.0F * colour).round().cast<std::uint8_t>();
    voxels->updateVoxel(at.x(), at.y(), at.z(), true);
    voxels->updateVoxelColour(at.x(), at.y(), at.z(), bytes.x(), bytes.y(), bytes.z());
  }
  return voxels;
}

/// The first coloured points that are not the landmarks.
CColouredPointsMap::ConstPtr denseOf(const CMultiMetricMap& layers, const CPointsMap* landmarks) {
  for (const auto& layer : layers.maps) {
    const auto points = std::dynamic_pointer_cast<CColouredPointsMap>(layer);
    if (points != nullptr && points.get() != landmarks) return points;
  }
  return nullptr;
}

template <typename Layer>
std::shared_ptr<Layer> copyOf(const Layer& layer) {
  return std::dynamic_pointer_cast<Layer>(layer.duplicateGetSmartPtr());
}

}  // namespace

PerceptionMap::PerceptionMap() : PerceptionMap(defaultLayers()) {}

PerceptionMap::PerceptionMap(std::shared_ptr<CMultiMetricMap> layers)
    : layers_(layers),
      landmarks_(layers->mapByClass<CPointsMap>()),
      moving_objects_(layers->mapByClass<CMovingObjectsMap>()),
      dense_(denseOf(*layers, landmarks_.get())),
      static_map_(std::make_shared<slam::MapView>()) {
  if (landmarks_ == nullptr) throw InputError("the map has no layer of points (pointsMap)");
  auto no_landmarks = copyOf(*landmarks_);
  no_landmarks->clear();
  no_landmarks_ = no_landmarks;
  if (moving_objects_ == nullptr) throw InputError("the map has no layer movingObjectsMap");
}

PerceptionMap PerceptionMap::fromIni(const std::string& path, const std::string& section) {
  if (!std::filesystem::is_regular_file(path)) throw InputError(path + ": no such map description");
  try {
    const mrpt::config::CConfigFile file(path);
    if (!file.sectionExists(section)) throw InputError("no section [" + section + "]");
    requireKnownKinds(file, path, section);
    mrpt::maps::TSetOfMetricMapInitializers initializers;
    initializers.loadFromConfigFile(file, section);
    auto layers = std::make_shared<CMultiMetricMap>();
    layers->setListOfMaps(initializers);
    return PerceptionMap(layers);
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    throw InputError(reason.rfind(path, 0) == 0 ? reason : path + ": " + reason);
  }
}

template <typename Layer>
void PerceptionMap::replaceLayer(const std::shared_ptr<const Layer>& old_layer,
                                 const std::shared_ptr<Layer>& new_layer) {
  auto layers = std::make_shared<CMultiMetricMap>();
  layers->genericMapParams = layers_->genericMapParams;
  for (const auto& layer : layers_->maps) {
    layers->maps.push_back(layer.get() == old_layer.get() ? new_layer : layer);
  }
  layers_ = layers;
}

void PerceptionMap::update(slam::MapView static_map) {
  auto landmarks = copyOf(*no_landmarks_);
  insertLandmarks(static_map, *landmarks);
  replaceLayer<CPointsMap>(landmarks_, landmarks);
  landmarks_ = landmarks;
  static_map_ = std::make_shared<slam::MapView>(std::move(static_map));
}

void PerceptionMap::removeStaticLayers() {
  auto layers = std::make_shared<CMultiMetricMap>();
  layers->genericMapParams = layers_->genericMapParams;
  const auto grid = staticGrid();
  for (const auto& layer : layers_->maps) {
    const auto voxels = std::dynamic_pointer_cast<mrpt::maps::CColouredOctoMap>(layer);
    if (voxels != nullptr) {
      layers->maps.push_back(octoMapOf(CColouredPointsMap(), *voxels));
    } else if (layer.get() != grid.get() && layer.get() != dense_.get()) {
      layers->maps.push_back(layer);
    }
  }
  layers_ = layers;
  dense_.reset();
}

void PerceptionMap::update(Time time, std::vector<Track> tracks, const Pose& T_map_odom) {
  T_map_odom_ = T_map_odom;
  auto moving = CMovingObjectsMap::Create();
  moving->insertionOptions = moving_objects_->insertionOptions;
  moving->genericMapParams = moving_objects_->genericMapParams;
  moving->setTracks(time, std::move(tracks));
  replaceLayer<CMovingObjectsMap>(moving_objects_, moving);
  moving_objects_ = moving;
}

void PerceptionMap::update(const mrpt::maps::COccupancyGridMap2D::Ptr& static_grid) {
  ASSERTMSG_(static_grid != nullptr, "a map without a grid keeps the one it has");
  const auto old_grid = staticGrid();
  if (old_grid != nullptr) {  // the options of an .ini apply to later contents, too
    static_grid->genericMapParams = old_grid->genericMapParams;
    static_grid->insertionOptions = old_grid->insertionOptions;
    static_grid->likelihoodOptions = old_grid->likelihoodOptions;
  }
  auto layers = std::make_shared<CMultiMetricMap>();
  layers->genericMapParams = layers_->genericMapParams;
  for (const auto& layer : layers_->maps) {
    if (layer.get() != old_grid.get()) layers->maps.push_back(layer);
  }
  layers->maps.push_back(static_grid);
  layers_ = layers;
}

void PerceptionMap::update(const CColouredPointsMap::Ptr& dense) {
  ASSERTMSG_(dense != nullptr, "a map without dense points keeps those it has");
  if (dense_ != nullptr) {  // the options of an .ini apply to later contents, too
    dense->genericMapParams = dense_->genericMapParams;
    dense->insertionOptions = dense_->insertionOptions;
    dense->likelihoodOptions = dense_->likelihoodOptions;
    dense->renderOptions = dense_->renderOptions;
  }
  auto layers = std::make_shared<CMultiMetricMap>();
  layers->genericMapParams = layers_->genericMapParams;
  for (const auto& layer : layers_->maps) {
    const auto voxels = std::dynamic_pointer_cast<mrpt::maps::CColouredOctoMap>(layer);
    if (voxels != nullptr) {
      layers->maps.push_back(octoMapOf(*dense, *voxels));
    } else if (layer.get() != dense_.get()) {
      layers->maps.push_back(layer);
    }
  }
  layers->maps.push_back(dense);
  layers_ = layers;
  dense_ = dense;
}

}  // namespace headway::map
