// SPDX-License-Identifier: BSD-3-Clause
// The campus: a promenade between lawns, houses and a road.
#include <algorithm>
#include <cmath>
#include <vector>

#include "furniture.h"
#include "house.h"
#include "site.h"
#include "site_furniture.h"

namespace headway::sim {
namespace {

/// Where the parts of the campus lie, x to the east, y to the north [m].
struct CampusLayout {
  double west = -6.0, east = 46.0;      ///< ends of the promenade
  double promenade = 3.0;               ///< half its width
  double cycle_way = 5.4;               ///< its outer edge
  double lawn = 17.0;                   ///< northern edge of the lawns
  double pavement = -5.2, road = -9.4;  ///< edges of the roadway
  double south = -12.6;                 ///< front of the southern houses
  double kerb_height = 0.1;             ///< height of the kerbs
  double ramp_room = 4.2;               ///< of a bicycle stand beside a ramp
};

/// A promenade with a cycle way between lawns and a road, with houses around.
class CampusPlan : private CampusLayout {
 public:
  CampusPlan(Site& site, const WorldParams& params, const Grain& grain, std::uint64_t seed)
      : builder_(site, params, seed), site_(site), grain_(grain), random_(seed) {}

  void build() {
    site_.outdoors = true;
    site_.area = rectangle(west, south, east, lawn);
    layGround();
    layRoad();
    buildStairs();
    plantLawns();
    furnishPromenade();
    buildHouses();
    addPlaces();
  }

 private:
  void layGround();
  void layRoad();
  /// The place itself, or the nearest one that leaves a bicycle stand's room beside the ramps.
  [[nodiscard]] double besideRamp(double x) const;
  void buildStairs();
  void plantLawns();
  void plantHedge(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
  void furnishPromenade();
  void buildHouses();
  void addHouse(const Eigen::Vector2d& foot, double yaw, double width);
  void addPlaces();
  /// Middle of the crossing path that leads through the lawns to the nth house.
  [[nodiscard]] double crossing(int n) const { return west + 9.0 + 14.0 * n; }
  /// The kerb on one side of the road; its ramps are in the gaps between railings.
  [[nodiscard]] Kerb kerb(bool north) const {
    return {north ? pavement : road,
            north ? 1.0 : -1.0,
            kerb_height,
            west - 30.0,
            east + 30.0,
            {west + 8.75, west + 26.75, west + 44.75}};
  }

  SiteBuilder builder_;
  Site& site_;
  const Grain& grain_;
  Random random_;
  Eigen::AlignedBox2d stairs_;
};

void CampusPlan::layGround() {
  const double at = crossing(1) + random_.uniform(3.0, 5.0);
  stairs_ = rectangle(at, 7.2, at + 3.4, 9.2);
  builder_.floor(rectangle(west, -promenade, east, promenade), 0.0, Material::kPaving);
  builder_.floor(rectangle(west, promenade, east, cycle_way), 0.0, Material::kAsphalt);
  for (const double y : {promenade + 0.08, cycle_way - 0.08}) {
    builder_.ornament({{0.5 * (west + east), y}, 0.0, {east - west, 0.1, 0.004}, 0.0},
                      Material::kWhitePaint);
  }
  builder_.floor(rectangle(west, pavement, east, -promenade), 0.0, Material::kConcrete,
                 kerb(true).rampAreas());
  std::vector<Eigen::AlignedBox2d> holes = {stairs_.intersection(site_.area)};
  const auto apron = rectangle(stairs_.min().x() - 2.2, cycle_way, stairs_.max().x() + 0.6, 10.0);
  holes.push_back(apron);
  for (int n = 0; n < 4; ++n) {
    const auto path = rectangle(crossing(n) - 1.2, cycle_way, crossing(n) + 1.2, lawn);
    builder_.floor(path, 0.0, Material::kPaving, {apron});
    holes.push_back(path);
  }
  builder_.floor(apron, 0.0, Material::kPaving, {stairs_});
  builder_.floor(rectangle(west, cycle_way, east, lawn), 0.0, Material::kGrass, holes);
}

void CampusPlan::layRoad() {
  const double from = west - 30.0, to = east + 30.0;
  builder_.slope({{from, pavement, -kerb_height},
                  {to, pavement, -kerb_height},
                  {to, road, -kerb_height},
                  {from, road, -kerb_height}},
                 Material::kAsphalt);
  builder_.floor(rectangle(from, south - 4.0, to, road), 0.0, Material::kPaving,
                 kerb(false).rampAreas());
  for (const bool north : {true, false}) addKerb(builder_, kerb(north));
  for (double x = west - 28.0; x < east + 28.0; x += 6.0) {
    builder_.ornament({{x, 0.5 * (road + pavement)}, 0.0, {3.0, 0.12, 0.004}, -kerb_height},
                      Material::kWhitePaint);
  }
  // Railings keep people off the road, but for gaps.
  for (double x = west + 1.0; x < east - 7.0; x += 9.0) {
    if (random_.chance(0.6)) {
      builder_.railing({x, pavement + 0.35}, {x + 6.5, pavement + 0.35}, Material::kSteel);
    }
  }
}

void CampusPlan::buildStairs() {
  builder_.pit(stairs_, 2.0, Material::kConcrete);
  builder_.stairsDown(stairs_, 2.0, true, Material::kConcrete);
  const Eigen::Vector2d low = stairs_.min(), high = stairs_.max();
  builder_.railing(low, {high.x(), low.y()}, Material::kBlueSteel);
  builder_.railing({low.x(), high.y()}, high, Material::kBlueSteel);
  builder_.railing({high.x(), low.y()}, high, Material::kBlueSteel);
}

void CampusPlan::plantHedge(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2f a = from.cast<float>(), b = to.cast<float>();
  Random own(random_.bits());
  addHedge(site_.furniture, {a.x(), a.y(), 0.0F}, {b.x(), b.y(), 0.0F}, own);
  const Eigen::Vector2d along = to - from;
  builder_.block({0.5 * (from + to), {along.norm(), 0.75}, std::atan2(along.y(), along.x())});
}

void CampusPlan::plantLawns() {
  for (int n = -1; n < 4; ++n) {
    const double x0 = n < 0 ? west : crossing(n) + 1.2;
    const double x1 = n == 3 ? east : crossing(n + 1) - 1.2;
    const bool has_stairs = x0 < stairs_.center().x() && stairs_.center().x() < x1;
    for (double x = x0 + 0.6; x + 2.4 < x1 && !has_stairs; x += 3.0) {
      if (random_.chance(0.65)) plantHedge({x, cycle_way + 0.6}, {x + 2.4, cycle_way + 0.6});
    }
    for (int i = 0; i < 3; ++i) {
      const double y = random_.uniform(11.0, lawn - 1.5);
      const Eigen::Vector2d at(random_.uniform(x0 + 0.8, x1 - 0.8), y);
      addTree(site_.furniture, {static_cast<float>(at.x()), static_cast<float>(at.y()), 0.0F},
              random_);
      builder_.block({at, {0.5, 0.5}, 0.0});
    }
  }
}

double CampusPlan::besideRamp(double x) const {
  for (const double ramp : kerb(true).ramps) {
    if (std::abs(x - ramp) < ramp_room) return x < ramp ? ramp - ramp_room : ramp + ramp_room;
  }
  return x;
}

void CampusPlan::furnishPromenade() {
  for (double x = west + 4.0; x < east - 4.0; x += random_.uniform(6.0, 9.0)) {
    const double y = random_.chance(0.5) ? -promenade + 0.1 : promenade - 0.6;
    switch (random_.below(4)) {
      case 0:
        addBench(builder_, {{x, y}, y < 0.0 ? M_PI / 2 : -M_PI / 2});
        break;
      case 1:
        addBicycleStand(builder_, {{besideRamp(x), -4.0}, 0.0}, 3 + random_.below(4), random_);
        break;
      case 2:
        addPlant(builder_, {x, y}, random_);
        addPlant(builder_, {x + 0.8, y}, random_);
        break;
      default:
        addLamp(site_.furniture, {static_cast<float>(x), static_cast<float>(y), 0.0F},
                y < 0.0 ? 1.57F : -1.57F, random_);
        builder_.block({{x, y}, {0.3, 0.3}, 0.0});
        site_.spots.push_back({{x + 0.8, y}, y < 0.0 ? M_PI / 2 : -M_PI / 2});
    }
  }
  for (double y = -promenade + 0.5; y < promenade; y += 1.5) {  // bollards at the ends
    for (const double x : {west + 0.6, east - 0.6}) {
      builder_.box({{x, y}, 0.0, {0.14, 0.14, 0.9}, 0.0}, Material::kOrangeSteel);
    }
  }
}

void CampusPlan::addHouse(const Eigen::Vector2d& foot, double yaw, double width) {
  HousePlan plan;
  plan.facade.width_m = width;
  plan.facade.side_m = random_.uniform(8.0, 12.0);
  plan.facade.height_m = random_.uniform(7.0, 14.0);
  plan.facade.shop = random_.chance(0.3);
  plan.ridge_m = random_.chance(0.4) ? random_.uniform(1.5, 3.0) : 0.0;
  Random own(random_.bits());
  const Eigen::Vector3f at(static_cast<float>(foot.x()), static_cast<float>(foot.y()), -0.3F);
  site_.facades.push_back(
      {drawFacade(plan.facade, grain_, own), houseMesh(plan, at, static_cast<float>(yaw))});
}

void CampusPlan::buildHouses() {
  for (double x = west - 12.0; x < east + 12.0;) {
    const double north = random_.uniform(9.0, 13.0);
    addHouse({x + 0.5 * north, lawn + 0.3}, 0.0, north - 0.02);
    addHouse({x + 0.5 * north, south}, M_PI, north - 0.02);
    x += north;
  }
  for (const auto& [x, yaw] : {std::pair{west - 10.0, M_PI / 2}, {east + 10.0, -M_PI / 2}}) {
    addHouse({x, 0.4 * lawn}, yaw, 14.0);
  }
}

void CampusPlan::addPlaces() {
  // The robot starts beside the road and crosses it before long.
  const double across = road - Kerb::kRun - 0.55;
  for (const double x : kerb(false).ramps) {
    site_.robot_stops.push_back({x - 1.5, across});
    site_.robot_stops.push_back({x + 1.5, across});
    site_.robot_stops.push_back({x, pavement + Kerb::kRun + 0.25});
    site_.destinations.push_back({x + 0.4, across});
  }
  const double middle = west + random_.uniform(10.0, 16.0);
  site_.robot_stops.push_back({middle, 0.0});
  for (double x = west + 3.0; x < east - 2.0; x += 5.0) {
    site_.robot_stops.push_back({x, random_.uniform(-1.2, 1.2)});
    site_.destinations.push_back({x, random_.uniform(-1.8, 1.8)});
  }
  for (int n = 0; n < 4; ++n) {
    site_.robot_stops.push_back({crossing(n), 8.0});
    site_.destinations.push_back({crossing(n), lawn - 1.0});
  }
  site_.robot_stops.push_back({stairs_.min().x() - 1.2, 8.2});
  // Who sits on a bench or stands by a lamp holds up neither cyclists nor delivery robots.
  const double near = promenade + 0.8, far = cycle_way - 0.65, delivery_lane = 0.6;
  VehicleLoop cycle{ActorKind::kCyclist, {}, 4.0};
  for (double x = west + 2.0; x <= east - 2.0; x += 2.0) cycle.points.push_back({x, near, 0.0});
  for (double x = east - 2.0; x >= west + 2.0; x -= 2.0) cycle.points.push_back({x, far, 0.0});
  site_.loops.push_back(cycle);
  VehicleLoop delivery{ActorKind::kDeliveryRobot, {}, 1.5};
  for (double x = west + 3.0; x <= east - 3.0; x += 2.0) {
    delivery.points.push_back({x, -delivery_lane, 0.0});
  }
  for (double x = east - 3.0; x >= west + 3.0; x -= 2.0) {
    delivery.points.push_back({x, delivery_lane, 0.0});
  }
  site_.loops.push_back(delivery);
}

}  // namespace

Site makeCampus(const WorldParams& params, const Grain& grain, std::uint64_t seed) {
  Site site;
  CampusPlan(site, params, grain, seed).build();
  return site;
}

}  // namespace headway::sim
