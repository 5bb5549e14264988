// SPDX-License-Identifier: BSD-3-Clause
// Streets and their traffic as an environment, with the scene that is drawn of them.
#include <headway/core/error.h>
#include <headway/core/stereo_camera.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <set>
#include <vector>

#include "drawn_objects.h"
#include "environment.h"
#include "furniture.h"
#include "mesh_projection.h"
#include "occlusion.h"
#include "site_traffic.h"
#include "stereo_rig.h"
#include "street.h"
#include "textures.h"
#include "traffic.h"

namespace headway::sim {

/// MRPT's scene of a world and its actors: surfaces by stretch, and one object each for what
/// has a common picture.
class StreetScene : public Scene {
 public:
  /// @param camera  left camera without distortion; the right one sees as far
  StreetScene(const StereoCamera& camera, World& world);

  void arrange(const Pose& T_world_robot, const Pose& T_left_right,
               const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) override;

 private:
  using ObjectPtr = TexturedObject::Ptr;

  /// A surface with a picture of its own.
  struct Piece {
    ObjectPtr object;
    std::vector<Eigen::Vector3f> around;  ///< points whose hull it is in, from its anchor
    std::optional<Block> block;
  };

  /// A tree or the like.
  struct Item {
    Mesh mesh;  ///< from the shared anchor
    std::vector<Eigen::Vector3f> around;
  };

  ObjectPtr add(const cv::Mat& picture);
  /// Hides all surfaces, and gives up those out of view where textures grow scarce.
  void removeHidden(const std::vector<StretchKey>& visible);
  /// Removes what houses hide in both images.
  void hideBehindHouses(const std::vector<StretchKey>& visible, const Eigen::Vector3d& origin,
                        const Pose& T_left_right);
  [[nodiscard]] bool shows(const std::vector<Eigen::Vector3f>& around,
                           const Eigen::Vector3d& offset) const;
  /// The triangles that show.
  [[nodiscard]] Mesh shown(const Mesh& mesh, const Eigen::Vector3d& offset) const;
  void showStretches(const std::vector<StretchKey>& visible);
  void placeStill(const Eigen::Vector3d& origin);
  void rebuildShared(const std::vector<StretchKey>& visible);
  void placeAll(const Eigen::Vector3d& origin);

  StereoCamera camera_;
  World& world_;
  std::map<StretchKey, std::vector<Piece>> surfaces_;
  std::vector<Occlusion> occlusions_;  ///< by houses, in the left and in the right image
  std::set<StretchKey> shown_;
  ObjectPtr sky_, plain_, verges_, furniture_;
  std::optional<ActorLayer> actors_;
  Eigen::Vector3d shared_anchor_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector2i> plain_cell_;
  Eigen::Vector3d plain_anchor_ = Eigen::Vector3d::Zero();
  std::vector<Item> items_;                       ///< furniture of the stretches in view
  std::optional<std::vector<bool>> items_shown_;  ///< which of them are in furniture_
  Mesh verges_mesh_, plain_mesh_;                 ///< whole
  const Mesh sky_mesh_ = skyMesh(kSkyRadius);
};

/// A carriageway between kerbs as a site for a robot that is driven from outside, and the people
/// whom it meets there.
class Carriageway {
 public:
  Carriageway(const SimParams& params, const Route& route, World& world);

  void advance(double dt, const std::vector<Obstacle>& vehicles) {
    walkers_.advance(dt, robot_, vehicles);
    robot_.advance(dt, {});
  }
  [[nodiscard]] WheeledRobot& robot() { return robot_; }
  [[nodiscard]] const WheeledRobot& robot() const { return robot_; }
  [[nodiscard]] const Walkers& walkers() const { return walkers_; }
  [[nodiscard]] const Site& site() const { return site_; }

 private:
  Site site_;
  NavigationGrid grid_;
  WheeledRobot robot_;
  Walkers walkers_;
};

/// Streets through a town, and the traffic on them.
class StreetEnvironment : public Environment {
 public:
  /// @param camera  in whose left image the escort covers its ratio
  StreetEnvironment(const SimParams& params, const StereoCamera& camera, Driver driver);

  void advance(double dt) override;
  void observe() override { traffic_.observe(); }
  [[nodiscard]] Pose T_world_robot() const override {
    return driven_ ? driven_->robot().T_world_robot() : traffic_.robot().T_world_robot();
  }
  [[nodiscard]] bool arrived() const override { return !driven_ && traffic_.robot().arrived(); }
  [[nodiscard]] WheeledRobot* drivenRobot() override {
    return driven_ ? &driven_->robot() : nullptr;
  }
  [[nodiscard]] std::vector<Footprint> things() const override {
    return driven_ ? driven_->site().obstacles : std::vector<Footprint>();
  }
  [[nodiscard]] double pathLength() const override { return route_.end_s - route_.start_s; }
  [[nodiscard]] std::vector<Actor> actors(double reach) override;
  [[nodiscard]] std::vector<PlacedMesh> staticMeshes(double reach) override;
  [[nodiscard]] std::unique_ptr<Scene> makeScene(const StereoCamera& camera) override;

 private:
  Route route_;
  World world_;
  Traffic traffic_;
  std::unique_ptr<Carriageway> driven_;  ///< null: the robot drives itself
};

namespace {

constexpr std::size_t kMaxSurfaces = 170;  // MRPT has 192 textures, a few are shared ones

enum StreetScenePurpose : std::uint64_t {
  kSkySeed = 201,
  kMeadowSeed,
  kFurnitureAtlasSeed,
  kActorAtlasSeed
};

}  // namespace

StreetScene::StreetScene(const StereoCamera& camera, World& world)
    : camera_(camera), world_(world) {
  const auto seed = [&](StreetScenePurpose purpose) {
    return Random(seedOf({static_cast<std::uint64_t>(world.params().seed), purpose}));
  };
  Random sky = seed(kSkySeed), meadow = seed(kMeadowSeed), furniture = seed(kFurnitureAtlasSeed),
         actors = seed(kActorAtlasSeed);
  sky_ = add(drawSky(sky));
  const cv::Mat grass = drawMeadow(world.grain(), meadow);
  plain_ = add(grass);
  verges_ = add(grass);
  furniture_ = add(drawFurnitureAtlas(world.grain(), furniture));
  furniture_->hideBacks();
  actors_.emplace(scene_, world.grain(), actors);
  scene_.getViewport()->setViewportClipDistances(kNearPlane, kFarPlane);
}

StreetScene::ObjectPtr StreetScene::add(const cv::Mat& picture) {
  auto object = std::make_shared<TexturedObject>(picture);
  scene_.insert(object);
  return object;
}

void StreetScene::removeHidden(const std::vector<StretchKey>& visible) {
  std::vector<StretchKey> hidden;
  std::size_t count = 0;
  for (auto& [key, objects] : surfaces_) {
    for (auto& piece : objects) piece.object->setVisibility(false);
    count += objects.size();
    if (std::find(visible.begin(), visible.end(), key) == visible.end()) hidden.push_back(key);
  }
  for (const StretchKey& key : hidden) {
    if (world_.built().count(key) != 0 && count <= kMaxSurfaces / 2) continue;
    count -= surfaces_.at(key).size();
    for (auto& piece : surfaces_.at(key)) scene_.removeObject(piece.object);
    surfaces_.erase(key);
  }
}

void StreetScene::showStretches(const std::vector<StretchKey>& visible) {
  removeHidden(visible);
  std::size_t shown = 0;
  for (const StretchKey& key : visible) {
    const StreetStretch& stretch = world_.stretch(key);
    shown += stretch.surfaces.size();
    if (shown > kMaxSurfaces) break;
    auto known = surfaces_.find(key);
    if (known == surfaces_.end()) {
      std::vector<Piece> pieces;
      for (const Surface& surface : stretch.surfaces) {
        pieces.push_back({add(surface.picture), boxCorners(surface.mesh), surface.block});
        pieces.back().object->setMesh(surface.mesh);
        if (surface.block) pieces.back().object->hideBacks();
      }
      known = surfaces_.emplace(key, std::move(pieces)).first;
    }
    for (auto& piece : known->second) piece.object->setVisibility(true);
  }
}

void StreetScene::hideBehindHouses(const std::vector<StretchKey>& visible,
                                   const Eigen::Vector3d& origin, const Pose& T_left_right) {
  const Pose T_origin_left = T_origin_robot_ * camera_.T_robot_cam;
  occlusions_ = {Occlusion(camera_, T_origin_left.inverse()),
                 Occlusion(camera_, (T_origin_left * T_left_right).inverse())};
  const auto forAllShown = [&](const auto& visit) {
    for (const StretchKey& key : visible) {
      const auto pieces = surfaces_.find(key);
      if (pieces == surfaces_.end()) continue;
      const Eigen::Vector3d offset = world_.stretch(key).anchor - origin;
      for (Piece& piece : pieces->second) {
        if (piece.object->isVisible()) visit(piece, offset);
      }
    }
  };
  forAllShown([&](const Piece& piece, const Eigen::Vector3d& offset) {
    if (!piece.block) return;
    for (Occlusion& occlusion : occlusions_) occlusion.add(*piece.block, offset);
  });
  forAllShown([&](Piece& piece, const Eigen::Vector3d& offset) {
    piece.object->setVisibility(shows(piece.around, offset));
  });
}

bool StreetScene::shows(const std::vector<Eigen::Vector3f>& around,
                        const Eigen::Vector3d& offset) const {
  return std::any_of(occlusions_.begin(), occlusions_.end(),
                     [&](const Occlusion& occlusion) { return !occlusion.hides(around, offset); });
}

Mesh StreetScene::shown(const Mesh& mesh, const Eigen::Vector3d& offset) const {
  Mesh result;
  for (const auto& triangle : mesh.triangles) {
    if (shows(cornersOf(triangle), offset)) result.triangles.push_back(triangle);
  }
  return result;
}

void StreetScene::rebuildShared(const std::vector<StretchKey>& visible) {
  items_.clear();
  verges_mesh_ = {};
  shared_anchor_ = world_.stretch(visible.front()).anchor;
  for (const StretchKey& key : visible) {
    const StreetStretch& stretch = world_.stretch(key);
    const Eigen::Vector3f shift = (stretch.anchor - shared_anchor_).cast<float>();
    for (const Mesh& item : stretch.furniture) {
      const Mesh mesh = moved(item, Eigen::Matrix3f::Identity(), shift);
      items_.push_back({mesh, boxCorners(mesh)});
    }
    verges_mesh_.append(moved(stretch.verges, Eigen::Matrix3f::Identity(), shift));
  }
  items_shown_.reset();
}

void StreetScene::placeStill(const Eigen::Vector3d& origin) {
  const Eigen::Vector2i cell((origin.head<2>() / kMeadowCell).array().floor().cast<int>());
  if (!plain_cell_ || *plain_cell_ != cell) {
    plain_cell_ = cell;
    plain_anchor_ = origin;
    plain_mesh_ = plainMesh(world_.network(), cell, origin);
  }
  std::vector<bool> now;
  for (const Item& item : items_) now.push_back(shows(item.around, shared_anchor_ - origin));
  if (items_shown_ != now) {
    std::vector<const Mesh*> furniture;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (now[i]) furniture.push_back(&items_[i].mesh);
    }
    furniture_->setMeshes(furniture);
    items_shown_ = std::move(now);
  }
  verges_->setMesh(shown(verges_mesh_, shared_anchor_ - origin));
  plain_->setMesh(shown(plain_mesh_, plain_anchor_ - origin));
  sky_->setMesh(shown(sky_mesh_, Eigen::Vector3d::Zero()));
}

void StreetScene::placeAll(const Eigen::Vector3d& origin) {
  const Eigen::Vector3d forward = T_origin_robot_.linear().col(0);
  const auto place = [&](const ObjectPtr& object, const Eigen::Vector3d& anchor, double order) {
    object->placeAt(anchor - origin, forward, order);
  };
  place(furniture_, shared_anchor_, 5500.0);
  for (const auto& [key, pieces] : surfaces_) {
    const Eigen::Vector3d& anchor = world_.stretch(key).anchor;
    const double distance = (anchor - origin).norm();
    for (const auto& piece : pieces) place(piece.object, anchor, 5000.0 - distance);
  }
  place(verges_, shared_anchor_, 4000.0);
  place(plain_, plain_anchor_, 3900.0);
  place(sky_, origin, 3800.0);
  actors_->place(forward);
}

void StreetScene::arrange(const Pose& T_world_robot, const Pose& T_left_right,
                          const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) {
  const Eigen::Vector3d origin = T_world_robot.translation();
  const Eigen::Vector3d viewpoint = (T_world_robot * camera_.T_robot_cam).translation();
  const auto visible = world_.inView(viewpoint, viewCone(camera_, T_world_robot));
  showStretches(visible);
  const std::set<StretchKey> now(visible.begin(), visible.end());
  if (now != shown_ && !visible.empty()) rebuildShared(visible);
  shown_ = now;
  T_origin_robot_ = T_world_robot;
  T_origin_robot_.translation().setZero();
  hideBehindHouses(visible, origin, T_left_right);
  placeStill(origin);
  actors_->show(actors, meshes, origin,
                [&](const Mesh& mesh) { return shows(boxCorners(mesh), Eigen::Vector3d::Zero()); });
  placeAll(origin);
}

namespace {

enum TrafficPurpose : std::uint64_t {
  kStreetVehicleSeed = 301,
  kStreetPedestrianSeed,
  kStreetRobotSeed,
  kStreetEscortSeed = 308,
  kStreetMeetingSeed = 312
};

/// The part of a street that a robot is driven on, with stops in its lane.
Site carriagewayOf(const Route& route, World& world) {
  constexpr double kBefore = 20.0, kLength = 36.0;  // of the stops, with room around them [m]
  constexpr double kKerb = 0.3, kStop = 3.0;        // width of a kerb, spacing of stops [m]
  Site site;
  const double begin = route.start_s - kBefore, end = route.start_s + kLength + kBefore;
  for (double s = begin; s < end; s += 1.0) {
    for (const double side : {1.0, -1.0}) {
      const double left = side * (kStreet.carriageway + 0.5 * kKerb);
      const Eigen::Vector2d place = route.street.beside(s, left).head<2>();
      site.obstacles.push_back({place, {1.1, kKerb}, route.street.at(s).yaw});
      site.area.extend(place);
    }
  }
  const Eigen::Vector3d middle = route.street.at(route.start_s + 0.5 * kLength).position;
  for (const Actor& car : world.parkedNear(middle, kLength + kBefore)) {
    site.obstacles.push_back({car.position.head<2>(), car.size.head<2>(), car.yaw});
  }
  for (double s = route.start_s; s < route.start_s + kLength; s += kStop) {
    site.robot_stops.push_back(route.street.beside(s, route.robot_left).head<2>());
    site.destinations.push_back(route.street.beside(s, -route.robot_left).head<2>());
  }
  return site;
}

TrafficSeeds trafficSeeds(const SimParams& params) {
  const auto seed = [&](TrafficPurpose purpose) {
    return seedOf({static_cast<std::uint64_t>(params.world.seed), purpose});
  };
  return {seed(kStreetVehicleSeed), seed(kStreetPedestrianSeed), seed(kStreetRobotSeed),
          seed(kStreetEscortSeed)};
}

}  // namespace

Carriageway::Carriageway(const SimParams& params, const Route& route, World& world)
    : site_(carriagewayOf(route, world)),
      grid_(site_),
      robot_(steeredRobot(params, site_, grid_, static_cast<std::uint64_t>(params.world.seed))),
      walkers_(params.traffic, site_, grid_,
               seedOf({static_cast<std::uint64_t>(params.world.seed), kStreetMeetingSeed})) {
  std::int64_t first_id = 1'000'000;  // beyond those of the traffic
  if (params.traffic.pedestrians > 0)
    walkers_.meet(robot_,
                  seedOf({static_cast<std::uint64_t>(params.world.seed), kStreetMeetingSeed}),
                  first_id);
}

StreetEnvironment::StreetEnvironment(const SimParams& params, const StereoCamera& camera,
                                     Driver driver)
    : route_(makeRoute(params.route, params.world.hill_height_m)),
      world_(params.world, route_),
      traffic_(params, route_, world_.network(), camera, trafficSeeds(params)) {
  if (driver == Driver::kItself) return;
  driven_ = std::make_unique<Carriageway>(params, route_, world_);
  traffic_.follow(driven_->robot().obstacle());
}

void StreetEnvironment::advance(double dt) {
  if (driven_) {
    traffic_.follow(driven_->robot().obstacle());
    driven_->advance(dt, obstaclesFrom(traffic_.vehicles().actors()));
  }
  traffic_.advance(dt);
}

std::vector<Actor> StreetEnvironment::actors(double reach) {
  std::vector<Actor> actors = traffic_.actors();
  const auto parked = world_.parkedNear(T_world_robot().translation(), reach);
  actors.insert(actors.end(), parked.begin(), parked.end());
  if (driven_) {
    const auto& met = driven_->walkers().actors();
    actors.insert(actors.end(), met.begin(), met.end());
  }
  return actors;
}

std::vector<PlacedMesh> StreetEnvironment::staticMeshes(double reach) {
  const Eigen::Vector3d robot = T_world_robot().translation();
  ViewCone all_around;
  all_around.viewpoint = robot.head<2>();
  std::vector<PlacedMesh> meshes;
  for (const StretchKey& key : world_.inView(robot, all_around)) {
    const StreetStretch& stretch = world_.stretch(key);
    if ((stretch.anchor - robot).head<2>().norm() > reach + kStretch) continue;
    for (const Surface& surface : stretch.surfaces) {
      meshes.push_back({&surface.mesh, stretch.anchor});
    }
    for (const Mesh& item : stretch.furniture) meshes.push_back({&item, stretch.anchor});
  }
  return meshes;
}

std::unique_ptr<Scene> StreetEnvironment::makeScene(const StereoCamera& camera) {
  return std::make_unique<StreetScene>(camera, world_);
}

std::unique_ptr<Environment> makeStreetEnvironment(const SimParams& params,
                                                   const StereoCamera& camera, Driver driver) {
  SimParams used = params;
  if (driver == Driver::kCaller) {
    if (params.world.hill_height_m > 0.0) {
      throw InputError("[world] hill_height_m: must be 0 for a robot that is driven from outside");
    }
    used.robot.standing = true;  // the route's own robot follows the driven one
  }
  return std::make_unique<StreetEnvironment>(used, camera, driver);
}

}  // namespace headway::sim
