// SPDX-License-Identifier: BSD-3-Clause
// The warehouse: racks, aisles and loading docks.
#include <cmath>

#include "site_furniture.h"

namespace headway::sim {
namespace {

/// Lengths of the warehouse [m].
struct WarehouseLayout {
  double roof_height = 6.5;  ///< under the roof
  double length = 38.0;      ///< along the racks
  double aisle = 2.9;        ///< between racks
  double dock_depth = 1.1;   ///< below the floor
  double staging = 8.5;      ///< width of the free floor before the docks
};

/// Racks along x, a cross aisle at either end, and a staging area with loading docks.
class WarehousePlan : private WarehouseLayout {
 public:
  WarehousePlan(Site& site, const WorldParams& params, std::uint64_t seed)
      : builder_(site, params, seed),
        site_(site),
        random_(seed),
        identical_racks_(params.identical_racks) {}

  void build() {
    rack_rows_ = 3 + random_.below(2);
    racks_from_ = random_.uniform(4.0, 5.5);
    bays_ = 9 + random_.below(2);
    layRacks();
    const double staging_y = rows_end_ + staging;
    width_ = staging_y + 3.2;
    site_.area = rectangle(0.0, 0.0, length, width_);
    layDocks(staging_y);
    buildShell();
    layStaging();
    addPlaces();
  }

 private:
  void layRacks();
  void layDocks(double edge_y);
  void buildShell();
  void layStaging();
  void addPlaces();
  void paintLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to);

  SiteBuilder builder_;
  Site& site_;
  Random random_;
  bool identical_racks_;
  int rack_rows_ = 3, bays_ = 9;
  double racks_from_ = 5.0, rows_end_ = 0.0, width_ = 20.0;
  std::vector<double> aisles_;  ///< their middles, y
  std::vector<Eigen::AlignedBox2d> docks_;
};

void WarehousePlan::paintLine(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  builder_.ornament(
      {0.5 * (from + to), std::atan2(along.y(), along.x()), {along.norm(), 0.1, 0.003}, 0.0},
      Material::kYellowPaint);
}

void WarehousePlan::layRacks() {
  double y = 0.35;
  const Random first = random_;
  const double to = racks_from_ + kRackBay.length * bays_;
  for (int row = 0; row < rack_rows_; ++row) {
    const int deep = row == 0 ? 1 : 2;  // back to back, but at the wall
    for (int k = 0; k < deep; ++k, y += kRackBay.depth) {
      for (int bay = 0; bay < bays_; ++bay) {
        Random same = first;
        addRackBay(builder_,
                   {{racks_from_ + kRackBay.length * (bay + 0.5), y + 0.5 * kRackBay.depth}, 0.0},
                   identical_racks_ ? same : random_);
      }
      for (const double x : {racks_from_ - 0.25, to + 0.25}) {  // protects the uprights
        builder_.box({{x, y + 0.5 * kRackBay.depth}, 0.0, {0.12, kRackBay.depth, 0.4}, 0.0},
                     Material::kHazardStripes);
      }
    }
    if (row + 1 < rack_rows_) {
      aisles_.push_back(y + 0.5 * aisle);
      for (const double off : {0.12, aisle - 0.12})
        paintLine({racks_from_, y + off}, {to, y + off});
      y += aisle;
    }
  }
  rows_end_ = y;
}

void WarehousePlan::layDocks(double edge_y) {
  const double first = random_.uniform(6.0, 9.0);
  for (const double x : {first, first + 11.0}) {
    docks_.push_back(rectangle(x, edge_y, x + 3.6, width_));
    builder_.pit(docks_.back(), dock_depth, Material::kAsphalt);
    builder_.ornament({{x + 1.8, edge_y - 0.15}, 0.0, {3.6, 0.3, 0.003}, 0.0},
                      Material::kHazardStripes);
    for (const double post : {x - 0.15, x + 3.75}) {
      builder_.box({{post, edge_y - 0.1}, 0.0, {0.16, 0.16, 1.0}, 0.0}, Material::kYellowPaint);
    }
  }
}

void WarehousePlan::buildShell() {
  builder_.floor(site_.area, 0.0, Material::kConcrete, docks_);
  builder_.ceiling(site_.area, roof_height, Material::kSheetMetal);
  std::vector<Opening> gates;
  for (const auto& dock : docks_) gates.push_back({dock.center().x(), 3.4, -dock_depth, 2.9});
  builder_.wall({0.0, 0.0}, {length, 0.0}, roof_height, Material::kSheetMetal);
  builder_.wall({0.0, width_}, {length, width_}, roof_height, Material::kSheetMetal, gates);
  const std::vector<Opening> windows = {{0.3 * width_, 3.0, 3.2, 4.6},
                                        {0.75 * width_, 3.0, 3.2, 4.6}};
  builder_.wall({0.0, 0.0}, {0.0, width_}, roof_height, Material::kSheetMetal, windows);
  builder_.wall({length, 0.0}, {length, width_}, roof_height, Material::kBrick, windows);
  for (double x = 3.0; x < length; x += 6.0) {  // girders, with lamps between
    builder_.ornament({{x, 0.5 * width_}, M_PI / 2, {width_, 0.2, 0.45}, roof_height - 0.45},
                      Material::kSteel);
    for (double y = 2.0; y < width_; y += 4.5) {
      builder_.ornament({{x + 3.0, y}, 0.0, {1.4, 0.25, 0.08}, roof_height - 0.5}, Material::kLamp);
    }
  }
}

void WarehousePlan::layStaging() {
  for (int i = 0; i < 12; ++i) {
    const Spot at{
        {random_.uniform(3.0, length - 3.0), rows_end_ + random_.uniform(2.6, staging - 2.2)},
        random_.chance(0.5) ? 0.0 : M_PI / 2};
    const bool free =
        std::none_of(site_.obstacles.begin(), site_.obstacles.end(), [&](const Footprint& other) {
          return (other.centre - at.position).norm() < 0.5 * other.size.maxCoeff() + 1.7;
        });
    if (free) addPallet(builder_, at, 0.0, random_);
  }
  const double y = rows_end_ + 1.9;
  paintLine({racks_from_ - 1.5, y}, {length - 2.0, y});
  builder_.box({{1.2, width_ - 2.0}, 0.0, {1.2, 0.7, 1.0}, 0.0}, Material::kDarkWood);  // desk
  builder_.ornament({{1.2, width_ - 1.9}, 0.3, {0.5, 0.04, 0.35}, 1.05}, Material::kScreen);
  site_.spots.push_back({{1.2, width_ - 2.8}, M_PI / 2});
  builder_.threshold({racks_from_ - 1.4, 0.5 * rows_end_}, 0.0, rows_end_ - 1.0, 0.012);
  builder_.threshold({0.5 * length, rows_end_ + 0.7}, M_PI / 2, 20.0, 0.01);
  for (const double x : {0.28 * length, 0.72 * length}) {
    // Beside the forklifts' way, which would else wait behind them.
    Eigen::Vector2d at(x, rows_end_ + 3.4);
    const auto taken = [&](const Footprint& pallet) {
      return (pallet.centre - at).norm() < 1.4 && pallet.size.maxCoeff() < 1.5;
    };
    while (std::any_of(site_.obstacles.begin(), site_.obstacles.end(), taken)) at.x() += 0.4;
    site_.spots.push_back({at, random_.uniform(-M_PI, M_PI)});
    addNotice(builder_, {{0.07, 2.0 + 0.2 * x}, 0.0}, random_);
  }
}

void WarehousePlan::addPlaces() {
  const double west = 0.5 * racks_from_,
               east = 0.5 * (racks_from_ + kRackBay.length * bays_ + length);
  site_.robot_stops.push_back({0.5 * length, rows_end_ + 1.2});
  for (const double y : aisles_) {
    for (const double x : {west, 0.35 * length, 0.65 * length, east}) {
      site_.robot_stops.push_back({x, y});
      site_.destinations.push_back({x, y + random_.uniform(-0.6, 0.6)});
    }
  }
  for (double x = 4.0; x < length - 2.0; x += 6.0) {
    site_.robot_stops.push_back({x, rows_end_ + 1.3});
    site_.robot_stops.push_back({x, rows_end_ + staging - 1.4});
    site_.destinations.push_back({x + 1.0, rows_end_ + random_.uniform(0.8, staging - 1.2)});
  }
  VehicleLoop loop{ActorKind::kForklift, {}, 2.2};
  const double low = aisles_.front(), high = rows_end_ + 1.6;
  const auto line = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const int steps = static_cast<int>((to - from).norm());
    for (int i = 0; i < steps; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / steps;
      loop.points.emplace_back(at.x(), at.y(), 0.0);
    }
  };
  line({west + 1.5, low}, {east - 1.5, low});
  line({east - 0.2, low + 1.3}, {east - 0.2, high - 1.3});
  line({east - 1.5, high}, {west + 1.5, high});
  line({west + 0.2, high - 1.3}, {west + 0.2, low + 1.3});
  site_.loops.push_back(loop);
}

}  // namespace

Site makeWarehouse(const WorldParams& params, const Grain& /*grain*/, std::uint64_t seed) {
  Site site;
  WarehousePlan(site, params, seed).build();
  return site;
}

}  // namespace headway::sim
