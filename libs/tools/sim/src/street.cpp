// SPDX-License-Identifier: BSD-3-Clause
// Streets: their stretches with houses and parked vehicles, built as they come into view.
#include "street.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "furniture.h"
#include "house.h"
#include "route.h"
#include "textures.h"

namespace headway::sim {

/// What a stretch's random numbers are drawn for; each has a seed of its own.
enum StretchPurpose : std::uint64_t {
  kGroundSeed = 1,
  kHouseSeed,
  kFurnitureSeed,
  kParkedSeed,
  kFenceSeed
};

[[nodiscard]] inline std::uint64_t stretchSeed(const WorldParams& params, const StretchKey& key,
                                               StretchPurpose purpose, std::uint64_t side = 0) {
  return seedOf({static_cast<std::uint64_t>(params.seed), key.road,
                 static_cast<std::uint64_t>(key.number), purpose, side});
}

/// Coordinates along and beside one stretch.
struct StreetBuilder::Site {
  StretchKey key;
  const Road& road;
  double begin = 0.0;   ///< along the street's axis [m]
  double length = 0.0;  ///< [m]
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d world(double s, double left) const {
    return road.axis.beside(s, left);
  }
  /// Relative to the anchor.
  [[nodiscard]] Eigen::Vector3f local(double s, double left, double up) const {
    return (world(s, left) + Eigen::Vector3d(0, 0, up) - anchor).cast<float>();
  }
  /// Cells of ground along the stretch.
  [[nodiscard]] int groundSteps() const {
    return std::max(1, static_cast<int>(std::lround(length / 2.0)));
  }
  [[nodiscard]] float yaw(double s) const { return static_cast<float>(road.axis.at(s).yaw); }
  [[nodiscard]] bool drawn(double s) const {
    const auto i = static_cast<std::size_t>(std::max(0.0, s));
    return i < road.drawn.size() && road.drawn[i];
  }
};

/// A cell of the ground: number along the stretch; its two edges as (left, up, left, up) [m].
struct StreetBuilder::GroundCell {
  int step = 0;
  std::array<double, 4> edges{};
};

StreetBuilder::StreetBuilder(const RoadNetwork& network, const WorldParams& params,
                             const Grain& grain)
    : network_(network), params_(params), grain_(grain) {}

bool StreetBuilder::exists(const StretchKey& key) const {
  const Road& road = network_.roads()[key.road];
  const auto begin = static_cast<std::size_t>(key.number * kStretch);
  const auto end = std::min(begin + static_cast<std::size_t>(kStretch), road.drawn.size());
  if (begin >= end) return false;
  return std::any_of(road.drawn.begin() + static_cast<long>(begin),
                     road.drawn.begin() + static_cast<long>(end), [](bool drawn) { return drawn; });
}

Eigen::Vector3d StreetBuilder::middle(const StretchKey& key) const {
  return network_.roads()[key.road].axis.at((key.number + 0.5) * kStretch).position;
}

bool StreetBuilder::isFree(const Site& site, double s, double left, double margin) const {
  return !network_.nearOther(site.world(s, left).head<2>(), kStreet.edge + margin, site.key.road, s,
                             false);
}

StreetStretch StreetBuilder::build(const StretchKey& key) const {
  const Road& road = network_.roads()[key.road];
  Site site{key, road};
  site.begin = key.number * kStretch;
  site.length = std::min(kStretch, road.axis.length() - site.begin);
  site.anchor = middle(key);
  StreetStretch stretch;
  stretch.anchor = site.anchor;
  Random ground(stretchSeed(params_, key, kGroundSeed));
  layGround(site, stretch, ground);
  layVerges(site, stretch);
  for (const double side : {1.0, -1.0}) {
    Random houses(stretchSeed(params_, key, kHouseSeed, side > 0));
    buildHouses(site, side, stretch, houses);
  }
  Random furniture(stretchSeed(params_, key, kFurnitureSeed));
  placeFurniture(site, stretch, furniture);
  placeFences(site, stretch);
  return stretch;
}

void StreetBuilder::layCell(const Site& site, const GroundCell& cell, double reach,
                            bool earlier_only, Mesh& mesh) const {
  const int steps = site.groundSteps();
  const double s0 = site.begin + site.length * cell.step / steps;
  const double s1 = site.begin + site.length * (cell.step + 1) / steps;
  const double s = 0.5 * (s0 + s1);
  const auto [l0, up0, l1, up1] = cell.edges;
  if (!site.drawn(s) || network_.nearOther(site.world(s, 0.5 * (l0 + l1)).head<2>(), reach,
                                           site.key.road, s, earlier_only)) {
    return;
  }
  // A kerb's face has no width seen from above: it shows a strip of the kerb stones.
  const double painted1 = l0 == l1 ? l1 + (l1 > 0 ? 0.14 : -0.14) : l1;
  const float v0 = groundTextureV(l0), v1 = groundTextureV(painted1);
  mesh.addQuad(site.local(s0, l0, up0), site.local(s1, l0, up0), site.local(s1, l1, up1),
               site.local(s0, l1, up1),
               UvRect{static_cast<float>(cell.step) / static_cast<float>(steps), v0,
                      static_cast<float>(cell.step + 1) / static_cast<float>(steps), v1});
}

void StreetBuilder::layGround(const Site& site, StreetStretch& stretch, Random& random) const {
  GroundMarks marks;
  marks.length_m = site.length;
  marks.crossing = random.chance(0.25);
  marks.crossing_at = random.uniform(0.3, 0.7);
  Surface surface{drawGround(marks, grain_, random), {}, {}};
  constexpr double kLaneCells[] = {6.4, 3.2, 0.0, -3.2, -6.4};
  // At a junction the cells of two carriageways overlap. Those of the later one lie a hair lower:
  // at the same height both would show through each other in patches.
  const double lane = site.key.road == 0 ? 0.0 : -0.005;
  for (int i = 0; i < site.groundSteps(); ++i) {
    for (int c = 0; c < 4; ++c) {
      layCell(site, {i, {kLaneCells[c], lane, kLaneCells[c + 1], lane}}, kStreet.carriageway, true,
              surface.mesh);
    }
    for (const double side : {1.0, -1.0}) {
      const double kerb = side * kStreet.carriageway, edge = side * kStreet.edge;
      layCell(site, {i, {kerb, lane, kerb, kStreet.kerb_height}}, kStreet.carriageway + 0.2, false,
              surface.mesh);
      layCell(site, {i, {kerb, kStreet.kerb_height, edge, kStreet.kerb_height}},
              kStreet.carriageway + 0.4, false, surface.mesh);
    }
  }
  if (!surface.mesh.triangles.empty()) stretch.surfaces.push_back(std::move(surface));
}

void StreetBuilder::layVerges(const Site& site, StreetStretch& stretch) const {
  constexpr double kWidth = 5.0;  // of a row of tiles, about 4 m long [m]
  const int steps = std::max(1, static_cast<int>(std::lround(site.length / 4.0)));
  for (int i = 0; i < steps; ++i) {
    const double s0 = site.begin + site.length * i / steps;
    const double s1 = site.begin + site.length * (i + 1) / steps;
    for (const double side : {1.0, -1.0}) {
      for (int row = 0; row < 4; ++row) {
        const double l0 = side * (kStreet.edge + row * kWidth);
        const double l1 = side * (kStreet.edge + (row + 1) * kWidth);
        const double s = 0.5 * (s0 + s1);
        const Eigen::Vector2d xy = site.world(s, 0.5 * (l0 + l1)).head<2>();
        if (!site.drawn(s) || network_.nearOther(xy, kStreet.edge + 3.2, site.key.road, s, false)) {
          continue;
        }
        // Pictured by place, so that neighbours fit together.
        const auto vertex = [&](double at, double left) {
          const Eigen::Vector3d world = site.world(at, left);
          return MeshVertex{site.local(at, left, kStreet.kerb_height - 0.02),
                            {static_cast<float>(std::fmod(world.x() / kMeadowCell, 64.0)),
                             static_cast<float>(std::fmod(world.y() / kMeadowCell, 64.0))}};
        };
        stretch.verges.addTriangle(vertex(s0, l0), vertex(s1, l0), vertex(s1, l1));
        stretch.verges.addTriangle(vertex(s0, l0), vertex(s1, l1), vertex(s0, l1));
      }
    }
  }
}

void StreetBuilder::buildHouses(const Site& site, double side, StreetStretch& stretch,
                                Random& random) const {
  const int count = random.chance(0.5) ? 2 : 3;
  const double setback = random.chance(0.5) ? 0.0 : random.uniform(0.5, 3.0);
  for (int i = 0; i < count; ++i) {
    HousePlan plan;
    plan.facade.width_m =
        site.length / count - (random.chance(0.2) ? random.uniform(0.8, 2.0) : 0.02);
    plan.facade.side_m = random.uniform(7.0, 10.0);
    plan.facade.height_m = random.uniform(params_.house_height_min_m, params_.house_height_max_m);
    plan.facade.shop = random.chance(0.35);
    plan.ridge_m = random.chance(0.5) ? random.uniform(1.5, 3.0) : 0.0;
    const bool wanted = random.chance(params_.house_ratio);
    const double s = site.begin + (i + 0.5) * site.length / count;
    const double front = side * (kStreet.edge + setback);
    bool free = wanted && site.drawn(s);
    for (const double ds : {-0.5, 0.0, 0.5}) {
      for (const double depth : {0.0, 0.5, 1.0}) {
        const double at = s + ds * plan.facade.width_m;
        free = free && isFree(site, at, front + side * depth * plan.facade.side_m, 0.3);
      }
    }
    Random own(random.bits());
    if (!free) {
      const auto a = site.local(s - 0.45 * site.length / count, front, kStreet.kerb_height);
      const auto b = site.local(s + 0.45 * site.length / count, front, kStreet.kerb_height);
      if (site.drawn(s) && isFree(site, s - 0.45 * site.length / count, front, 0.3) &&
          isFree(site, s + 0.45 * site.length / count, front, 0.3)) {
        addHedge(stretch.furniture.emplace_back(), a, b, own);
      }
      continue;
    }
    Surface house{drawFacade(plan.facade, grain_, own), {}, {}};
    const double yaw = site.yaw(s) + (side > 0 ? 0.0 : M_PI);
    const Eigen::Vector3f foot = site.local(s, front, -0.3);
    house.mesh = houseMesh(plan, foot, static_cast<float>(yaw));
    house.block = houseBlock(plan, foot, static_cast<float>(yaw));
    stretch.surfaces.push_back(std::move(house));
  }
}

void StreetBuilder::placeFurniture(const Site& site, StreetStretch& stretch, Random& random) const {
  for (const double side : {1.0, -1.0}) {
    const auto spot = [&](double s, double beyond_kerb) {
      return site.local(s, side * (kStreet.carriageway + beyond_kerb), kStreet.kerb_height - 0.02);
    };
    const auto free = [&](double s) {
      return site.drawn(s) && isFree(site, s, side * kStreet.carriageway, 0.5);
    };
    const int trees = params_.tree_every_m > 0.0
                          ? static_cast<int>(std::lround(site.length / params_.tree_every_m *
                                                         random.uniform(0.6, 1.4)))
                          : 0;
    for (int i = 0; i < trees; ++i) {
      const double s = site.begin + (i + random.uniform(0.15, 0.85)) * site.length / trees;
      Random own(random.bits());
      if (free(s)) addTree(stretch.furniture.emplace_back(), spot(s, own.uniform(0.5, 0.8)), own);
    }
    const double towards_street = site.yaw(site.begin) - side * M_PI / 2;
    const double lamp = site.begin + random.uniform(0.1, 0.9) * site.length;
    if (random.chance(0.7) && free(lamp)) {
      addLamp(stretch.furniture.emplace_back(), spot(lamp, 0.4), static_cast<float>(towards_street),
              random);
    }
    const double sign = site.begin + random.uniform(0.1, 0.9) * site.length;
    if (random.chance(0.5) && free(sign)) {
      const double yaw = site.yaw(sign) + (side > 0 ? M_PI : 0.0);
      addSign(stretch.furniture.emplace_back(), spot(sign, 0.5), static_cast<float>(yaw), random);
    }
    for (int i = 0; i < 3; ++i) {
      const double s = site.begin + random.uniform(0.0, 1.0) * site.length;
      const bool at_wall = random.chance(0.4);
      Random own(random.bits());
      if (random.chance(0.6) && free(s)) {
        addSmallThing(stretch.furniture.emplace_back(), spot(s, at_wall ? 2.3 : 0.5), site.yaw(s),
                      own);
      }
    }
  }
}

std::vector<Actor> StreetBuilder::parked(const StretchKey& key) const {
  const Road& road = network_.roads()[key.road];
  Site site{key, road};
  site.begin = key.number * kStretch;
  Random random(stretchSeed(params_, key, kParkedSeed));
  std::vector<Actor> vehicles;
  int bay_number = 0;
  for (const double side : {1.0, -1.0}) {
    for (int bay = 0; bay < 4; ++bay, ++bay_number) {
      Random own(random.bits());
      const double s = site.begin + (bay + 0.6) * 5.5 + own.uniform(-0.3, 0.3);
      if (!own.chance(params_.parked_ratio) || !site.drawn(s) || s > road.axis.length() - 3.0 ||
          !isFree(site, s, side * kStreet.parking, 4.0)) {
        continue;
      }
      Actor vehicle;
      vehicle.kind = own.chance(0.12) ? ActorKind::kVan : ActorKind::kCar;
      // Above the ids of all who move; the same whenever the stretch is built again.
      vehicle.id =
          100000 + static_cast<std::int64_t>(key.road) * 16384 + key.number * 8 + bay_number;
      vehicle.look = own.below(1000);
      vehicle.size = drawSize(vehicle.kind, own);
      vehicle.position = site.world(s, side * (kStreet.parking + own.uniform(-0.15, 0.1)));
      vehicle.yaw = site.yaw(s) + (side > 0 ? M_PI : 0.0) + 0.02 * own.normal();
      vehicle.parked = true;
      vehicles.push_back(vehicle);
    }
  }
  return vehicles;
}

void StreetBuilder::placeFences(const Site& site, StreetStretch& stretch) const {
  if (params_.fence_ratio <= 0.0) return;  // worlds without fences draw no random numbers for them
  const int lots = std::max(1, static_cast<int>(std::lround(site.length / 6.0)));
  for (const double side : {1.0, -1.0}) {
    Random random(stretchSeed(params_, site.key, kFenceSeed, side > 0));
    const double left = side * (kStreet.edge - 0.1);
    for (int i = 0; i < lots; ++i) {
      Random own(random.bits());
      const double s0 = site.begin + site.length * i / lots;
      const double s1 = site.begin + site.length * (i + 0.95) / lots;
      const bool is_free = site.drawn(s0) && site.drawn(s1) && isFree(site, s0, left, 0.3) &&
                           isFree(site, s1, left, 0.3);
      if (!own.chance(params_.fence_ratio) || !is_free) continue;
      addFence(stretch.furniture.emplace_back(), site.local(s0, left, kStreet.kerb_height),
               site.local(s1, left, kStreet.kerb_height), own);
    }
  }
}

Mesh plainMesh(const RoadNetwork& network, const Eigen::Vector2i& corner,
               const Eigen::Vector3d& anchor) {
  constexpr int kCells = 16;  // to each side
  const int side = 2 * kCells + 1;
  std::vector<Eigen::Vector3f> points;
  for (int x = -kCells; x <= kCells; ++x) {
    for (int y = -kCells; y <= kCells; ++y) {
      const Eigen::Vector2d xy = (corner + Eigen::Vector2i(x, y)).cast<double>() * kMeadowCell;
      const double street = network.lowestNear(xy, 26.0).value_or(anchor.z() - 1.0);
      points.push_back(
          Eigen::Vector3d(xy.x() - anchor.x(), xy.y() - anchor.y(), street - 0.35 - anchor.z())
              .cast<float>());
    }
  }
  Mesh mesh;
  for (int x = 0; x + 1 < side; ++x) {
    for (int y = 0; y + 1 < side; ++y) {
      const auto at = [&](int i, int k) { return points[static_cast<std::size_t>(i * side + k)]; };
      mesh.addQuad(at(x, y + 1), at(x + 1, y + 1), at(x + 1, y), at(x, y), UvRect{});
    }
  }
  return mesh;
}

namespace {

enum WorldPurpose : std::uint64_t { kWorldGrainSeed = 101, kCrossStreetSeed };

constexpr double kLookupCell = 64.0;  // [m]

}  // namespace

World::World(const WorldParams& params, const Route& route)
    : params_(params),
      grain_(seedOf({static_cast<std::uint64_t>(params.seed), kWorldGrainSeed})),
      network_(route, params.cross_street_every_m,
               seedOf({static_cast<std::uint64_t>(params.seed), kCrossStreetSeed})),
      builder_(network_, params_, grain_) {
  for (std::size_t road = 0; road < network_.roads().size(); ++road) {
    const double length = network_.roads()[road].axis.length();
    for (int number = 0; number * kStretch < length - 1.0; ++number) {
      const StretchKey key{road, number};
      if (!builder_.exists(key)) continue;
      const Eigen::Vector3d middle = builder_.middle(key);
      spots_[cellOf(middle.head<2>())].push_back({middle, key});
    }
  }
}

World::Cell World::cellOf(const Eigen::Vector2d& xy) {
  return {static_cast<int>(std::floor(xy.x() / kLookupCell)),
          static_cast<int>(std::floor(xy.y() / kLookupCell))};
}

std::vector<World::Spot> World::spotsNear(const Eigen::Vector3d& place, double reach) const {
  std::vector<Spot> near;
  const Eigen::Vector2d corner = Eigen::Vector2d::Constant(reach);
  const Cell first = cellOf(place.head<2>() - corner), last = cellOf(place.head<2>() + corner);
  for (int x = first.first; x <= last.first; ++x) {
    for (int y = first.second; y <= last.second; ++y) {
      const auto cell = spots_.find({x, y});
      if (cell == spots_.end()) continue;
      for (const Spot& spot : cell->second) {
        if ((spot.middle - place).head<2>().squaredNorm() < reach * reach) near.push_back(spot);
      }
    }
  }
  std::sort(near.begin(), near.end(), [](const Spot& a, const Spot& b) { return a.key < b.key; });
  return near;
}

std::vector<StretchKey> World::inView(const Eigen::Vector3d& viewpoint, const ViewCone& view) {
  std::vector<std::pair<double, StretchKey>> by_distance;
  for (const Spot& spot : spotsNear(viewpoint, params_.view_distance_m)) {
    if (!view.touches(spot.middle.head<2>(), 0.75 * kStretch)) continue;  // with its houses
    by_distance.emplace_back((spot.middle - viewpoint).norm(), spot.key);
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<StretchKey> visible;
  for (const auto& [distance, key] : by_distance) {
    visible.push_back(key);
    if (built_.count(key) == 0) built_.emplace(key, builder_.build(key));
  }
  const double keep_within = params_.view_distance_m + 60.0;
  for (auto it = built_.begin(); it != built_.end();) {
    const double distance = (it->second.anchor - viewpoint).head<2>().norm();
    it = distance > keep_within ? built_.erase(it) : std::next(it);
  }
  return visible;
}

const StreetStretch& World::stretch(const StretchKey& key) const { return built_.at(key); }

std::vector<Actor> World::parkedNear(const Eigen::Vector3d& place, double reach) {
  std::vector<Actor> vehicles;
  std::map<StretchKey, std::vector<Actor>> near;
  for (const Spot& spot : spotsNear(place, reach + kStretch)) {
    auto known = parked_.extract(spot.key);
    if (known.empty()) {
      near.emplace(spot.key, builder_.parked(spot.key));
    } else {
      near.insert(std::move(known));
    }
    for (const Actor& vehicle : near.at(spot.key)) {
      if ((vehicle.position - place).head<2>().norm() < reach) vehicles.push_back(vehicle);
    }
  }
  parked_ = std::move(near);  // what is out of reach is removed
  return vehicles;
}

}  // namespace headway::sim
