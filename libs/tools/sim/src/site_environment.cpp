// SPDX-License-Identifier: BSD-3-Clause
// A hall, campus or warehouse as an environment, with the scene that is drawn of it.
#include "site_environment.h"

#include <headway/core/stereo_camera.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "drawn_objects.h"
#include "furniture.h"
#include "mesh_projection.h"
#include "site.h"
#include "site_furniture.h"
#include "stereo_rig.h"
#include "street.h"
#include "textures.h"

namespace headway::sim {

/// MRPT's scene of a site: one object for each material and orientation, built once.
class SiteScene : public Scene {
 public:
  /// The site must outlive the scene.
  SiteScene(const Site& site, const Grain& grain, std::uint64_t seed);

  void arrange(const Pose& T_world_robot, const Pose& T_left_right,
               const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) override;

 private:
  TexturedObject::Ptr add(const cv::Mat& picture, const Mesh& mesh);
  void addShaded(const cv::Mat& picture, const Mesh& mesh);
  /// Soft dark strips on the floor where something stands.
  [[nodiscard]] static Mesh contactShadows(const Site& site);

  std::vector<TexturedObject::Ptr> objects_;
  TexturedObject::Ptr sky_, shadows_;
  std::optional<ActorLayer> actors_;
};

namespace {

enum SiteScenePurpose : std::uint64_t {
  kSiteSkySeed = 401,
  kSiteMaterialSeed,
  kSiteMeadowSeed,
  kSiteAtlasSeed,
  kSiteActorSeed
};

/// Which of three brightnesses a triangle has by the way it faces: floors, walls along y, the rest.
std::size_t shadeOf(const std::array<MeshVertex, 3>& triangle) {
  const Eigen::Vector3f normal = (triangle[1].position - triangle[0].position)
                                     .cross(triangle[2].position - triangle[0].position)
                                     .cwiseAbs();
  if (normal.z() > std::max(normal.x(), normal.y())) return 0;
  return normal.x() > normal.y() ? 1 : 2;
}

constexpr std::array<double, 3> kShades = {1.0, 0.92, 0.8};

/// The upright rectangle around a drop's outline.
Eigen::AlignedBox2d boundsOf(const Drop& drop) {
  Eigen::AlignedBox2d bounds;
  for (const Eigen::Vector2d& corner : drop.outline) bounds.extend(corner);
  return bounds;
}

/// A wide plain a little below the ground, with holes for what is deeper.
Mesh plain(const Site& site) {
  constexpr double kReach = 150.0;  // [m]
  std::set<double> xs, ys;
  for (double d = -kReach; d <= kReach; d += 30.0) {
    xs.insert(d);
    ys.insert(d);
  }
  for (const Drop& drop : site.drops) {
    const auto bounds = boundsOf(drop);
    xs.insert({bounds.min().x(), bounds.max().x()});
    ys.insert({bounds.min().y(), bounds.max().y()});
  }
  Mesh mesh;
  const auto vertex = [&](double x, double y) {
    return MeshVertex{Eigen::Vector3d(x, y, -0.25).cast<float>(),
                      Eigen::Vector2d(x / kMeadowCell, y / kMeadowCell).cast<float>()};
  };
  for (auto x = xs.begin(); std::next(x) != xs.end(); ++x) {
    for (auto y = ys.begin(); std::next(y) != ys.end(); ++y) {
      const double x1 = *std::next(x), y1 = *std::next(y);
      const Eigen::Vector2d middle(0.5 * (*x + x1), 0.5 * (*y + y1));
      if (std::any_of(site.drops.begin(), site.drops.end(),
                      [&](const Drop& drop) { return boundsOf(drop).contains(middle); })) {
        continue;
      }
      mesh.addTriangle(vertex(*x, y1), vertex(x1, y1), vertex(x1, *y));
      mesh.addTriangle(vertex(*x, y1), vertex(x1, *y), vertex(*x, *y));
    }
  }
  return mesh;
}

}  // namespace

SiteScene::SiteScene(const Site& site, const Grain& grain, std::uint64_t seed) {
  const auto random = [&](std::uint64_t purpose, std::uint64_t item = 0) {
    return Random(seedOf({seed, purpose, item}));
  };
  for (const auto& [material, mesh] : site.surfaces) {
    Random own = random(kSiteMaterialSeed, static_cast<std::uint64_t>(material));
    addShaded(drawMaterial(material, grain, own), mesh);
  }
  for (const PicturedMesh& facade : site.facades)
    objects_.push_back(add(facade.picture, facade.mesh));
  Random atlas = random(kSiteAtlasSeed), meadow = random(kSiteMeadowSeed),
         sky = random(kSiteSkySeed), people = random(kSiteActorSeed);
  if (!site.furniture.triangles.empty()) {
    objects_.push_back(add(drawFurnitureAtlas(grain, atlas), site.furniture));
  }
  objects_.push_back(add(drawMeadow(grain, meadow), plain(site)));
  sky_ = add(drawSky(sky), skyMesh(kSkyRadius));
  shadows_ = add(drawShadow(), contactShadows(site));
  actors_.emplace(scene_, grain, people);
  actors_->stackShadows();
  scene_.getViewport()->setViewportClipDistances(kNearPlane, kFarPlane);
}

TexturedObject::Ptr SiteScene::add(const cv::Mat& picture, const Mesh& mesh) {
  auto object = std::make_shared<TexturedObject>(picture);
  object->setMesh(mesh);
  scene_.insert(object);
  return object;
}

void SiteScene::addShaded(const cv::Mat& picture, const Mesh& mesh) {
  std::array<Mesh, kShades.size()> parts;
  for (const auto& triangle : mesh.triangles)
    parts[shadeOf(triangle)].triangles.push_back(triangle);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].triangles.empty()) continue;
    cv::Mat shaded;
    picture.convertTo(shaded, -1, kShades[i]);
    objects_.push_back(add(shaded, parts[i]));
  }
}

Mesh SiteScene::contactShadows(const Site& site) {
  // Each a hair above the one before: at the same height they would show through each other.
  float height = 0.004F;            // [m], each a hair above the one before
  constexpr double kSpread = 0.16;  // [m]
  Mesh mesh;
  for (const Footprint& footprint : site.obstacles) {
    const Eigen::Vector2d along(std::cos(footprint.yaw), std::sin(footprint.yaw));
    const Eigen::Vector2f ex = ((0.5 * footprint.size.x() + kSpread) * along).cast<float>();
    const Eigen::Vector2f ey =
        ((0.5 * footprint.size.y() + kSpread) * Eigen::Vector2d(-along.y(), along.x()))
            .cast<float>();
    const Eigen::Vector2f middle = footprint.centre.cast<float>();
    const auto at = [&](float x, float y) {
      const Eigen::Vector2f corner = middle + x * ex + y * ey;
      return Eigen::Vector3f(corner.x(), corner.y(), height);
    };
    mesh.addQuad(at(1, 1), at(-1, 1), at(-1, -1), at(1, -1), UvRect{});
    height += 1e-5F;
  }
  return mesh;
}

void SiteScene::arrange(const Pose& T_world_robot, const Pose& /*T_left_right*/,
                        const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) {
  const Eigen::Vector3d origin = T_world_robot.translation();
  T_origin_robot_ = T_world_robot;
  T_origin_robot_.translation().setZero();
  const Eigen::Vector3d forward = T_origin_robot_.linear().col(0);
  actors_->show(actors, meshes, origin, [](const Mesh&) { return true; });
  double order = 5000.0;
  for (const auto& object : objects_) object->placeAt(-origin, forward, order -= 1.0);
  sky_->placeAt(Eigen::Vector3d::Zero(), forward, 3800.0);
  shadows_->placeAt(-origin, forward, 1.0);
  actors_->place(forward);
}

namespace {

enum SitePurpose : std::uint64_t {
  kGrainSeed = 501,
  kLayoutSeed,
  kRobotSeed,
  kVehicleSeed,
  kPeopleSeed,
  kBicycleSeed,
  kStartSeed,
  kEncounterSeed = 509,
  kCoverSeed = 512,
  kMachineSeed
};

/// Distance of a stop to the middle of the nearest drop [m].
double distanceToDrop(const Eigen::Vector2d& stop, const std::vector<Drop>& drops) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Drop& drop : drops) {
    Eigen::AlignedBox2d bounds;
    for (const Eigen::Vector2d& corner : drop.outline) bounds.extend(corner);
    nearest = std::min(nearest, (bounds.center() - stop).norm());
  }
  return nearest;
}

/// With half of the seeds the robot starts beside a drop, which it would otherwise seldom see.
Site withStart(Site site, std::uint64_t seed) {
  Random random(seed);
  if (random.chance(0.5)) return site;
  auto& stops = site.robot_stops;
  const auto nearest = std::min_element(
      stops.begin(), stops.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return distanceToDrop(a, site.drops) < distanceToDrop(b, site.drops);
      });
  std::iter_swap(stops.begin(), nearest);
  return site;
}

Site makeSite(const WorldParams& params, const Grain& grain, std::uint64_t seed) {
  switch (params.kind) {
    case WorldParams::Kind::kCampus:
      return makeCampus(params, grain, seed);
    case WorldParams::Kind::kWarehouse:
      return makeWarehouse(params, grain, seed);
    case WorldParams::Kind::kHall:
    case WorldParams::Kind::kStreet:
      break;
  }
  return makeHall(params, grain, seed);
}

/// With machines that `params` ask for, at places of their own seed.
Site withMachines(Site site, const WorldParams& params, std::uint64_t seed) {
  if (params.machines == 0) return site;
  Random random(seed);
  SiteBuilder builder(site);
  addMachines(builder, params.machines, random);
  return site;
}

}  // namespace

SiteEnvironment::SiteEnvironment(const SimParams& params, const StereoCamera& camera, Driver driver)
    : seed_(static_cast<std::uint64_t>(params.world.seed)),
      grain_(seedOf({seed_, kGrainSeed})),
      site_(withMachines(withStart(makeSite(params.world, grain_, seedOf({seed_, kLayoutSeed})),
                                   seedOf({seed_, kStartSeed})),
                         params.world, seedOf({seed_, kMachineSeed}))),
      grid_(site_),
      robot_(driver == Driver::kCaller
                 ? steeredRobot(params, site_, grid_, seed_)
                 : WheeledRobot(params, site_, grid_, seedOf({seed_, kRobotSeed}))),
      vehicles_(params.traffic, site_, robot_.obstacle(), seedOf({seed_, kVehicleSeed}), next_id_),
      walkers_(params.traffic, site_, grid_, seedOf({seed_, kPeopleSeed})),
      cover_(params.traffic, camera, seedOf({seed_, kCoverSeed}), next_id_) {
  walkers_.populate(robot_, next_id_);
  if (robot_.course() && params.traffic.pedestrians > 0)
    walkers_.meet(robot_, seedOf({seed_, kEncounterSeed}), next_id_);
  Random random(seedOf({seed_, kBicycleSeed}));
  for (const Spot& spot : site_.bicycles) {
    Actor bicycle = drawActor(ActorKind::kBicycle, next_id_++, random);
    bicycle.position = Eigen::Vector3d(spot.position.x(), spot.position.y(), 0.0);
    bicycle.yaw = spot.yaw;
    bicycle.parked = true;
    bicycles_.push_back(bicycle);
  }
}

std::vector<Footprint> SiteEnvironment::things() const {
  std::vector<Footprint> things = site_.obstacles;
  things.insert(things.end(), site_.edges.begin(), site_.edges.end());
  return things;
}

void SiteEnvironment::advance(double dt) {
  const auto people = obstaclesFrom(walkers_.actors());
  const auto vehicles = obstaclesFrom(vehicles_.actors());
  auto around_robot = people;
  around_robot.insert(around_robot.end(), vehicles.begin(), vehicles.end());
  auto around_vehicles = people;
  around_vehicles.push_back(robot_.obstacle());
  walkers_.advance(dt, robot_, vehicles);
  vehicles_.advance(dt, around_vehicles);
  robot_.advance(dt, around_robot);
  cover_.advance(dt, robot_.T_world_robot());
}

std::vector<Actor> SiteEnvironment::actors(double /*reach*/) {
  std::vector<Actor> actors = walkers_.actors();
  const auto& vehicles = vehicles_.actors();
  actors.insert(actors.end(), vehicles.begin(), vehicles.end());
  actors.insert(actors.end(), bicycles_.begin(), bicycles_.end());
  actors.insert(actors.end(), cover_.actors().begin(), cover_.actors().end());
  return actors;
}

std::vector<PlacedMesh> SiteEnvironment::staticMeshes(double /*reach*/) {
  std::vector<PlacedMesh> meshes;
  for (const auto& [material, mesh] : site_.surfaces) meshes.push_back({&mesh});
  for (const PicturedMesh& facade : site_.facades) meshes.push_back({&facade.mesh});
  meshes.push_back({&site_.furniture});
  return meshes;
}

std::unique_ptr<Scene> SiteEnvironment::makeScene(const StereoCamera& /*camera*/) {
  return std::make_unique<SiteScene>(site_, grain_, seed_);
}

std::unique_ptr<Environment> makeEnvironment(const SimParams& params, const StereoCamera& camera,
                                             Driver driver) {
  if (params.world.kind != WorldParams::Kind::kStreet) {
    return std::make_unique<SiteEnvironment>(params, camera, driver);
  }
  return makeStreetEnvironment(params, camera, driver);
}

}  // namespace headway::sim
