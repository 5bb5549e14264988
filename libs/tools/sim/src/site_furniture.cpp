// SPDX-License-Identifier: BSD-3-Clause
// Furniture of halls, campuses and warehouses.
#include "site_furniture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "furniture.h"
#include "navigation_grid.h"

namespace headway::sim {
namespace {

Eigen::Vector2d placed(const Spot& at, double along, double left) {
  const Eigen::Vector2d ex(std::cos(at.yaw), std::sin(at.yaw));
  return at.position + along * ex + left * Eigen::Vector2d(-ex.y(), ex.x());
}

Spot spotAt(const Spot& at, double along, double left, double turn, bool seat) {
  return {placed(at, along, left), at.yaw + turn, seat};
}

void addLegs(SiteBuilder& builder, const Spot& at, const Eigen::Vector2d& size, double height,
             Material material) {
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.5, 0.5}) {
      const Eigen::Vector2d place = Eigen::Vector2d(x, y).cwiseProduct(size);
      builder.ornament({placed(at, place.x(), place.y()), at.yaw, {0.05, 0.05, height}, 0.0},
                       material);
    }
  }
}

}  // namespace

void addChair(SiteBuilder& builder, const Spot& planned, Random& random) {
  const Spot at = builder.placed(planned);
  const Material seat = random.chance(0.6) ? Material::kFabric : Material::kBlackPlastic;
  builder.ornament({at.position, at.yaw, {0.06, 0.06, 0.4}, 0.06}, Material::kSteel);
  builder.ornament({at.position, at.yaw, {0.55, 0.07, 0.06}, 0.03}, Material::kBlackPlastic);
  builder.ornament({at.position, at.yaw, {0.07, 0.55, 0.06}, 0.03}, Material::kBlackPlastic);
  builder.part(at, {0, 0}, {0.46, 0.46, 0.07}, 0.42, seat);
  builder.part(at, {-0.22, 0}, {0.05, 0.42, 0.5}, 0.5, seat);
  builder.site().spots.push_back(spotAt(at, 0.2, 0.0, 0.0, true));
}

void addDesk(SiteBuilder& builder, const Spot& planned, Random& random) {
  const Spot at = builder.placed(planned);
  const Material top = random.chance(0.5) ? Material::kWood : Material::kWhitePaint;
  builder.part(at, {0, 0}, {0.8, 1.6, 0.04}, 0.7, top);
  addLegs(builder, at, {0.7, 1.5}, 0.7, Material::kSteel);
  builder.part(at, {0.1, 0.5}, {0.6, 0.4, 0.6}, 0.04, Material::kSteel);
  for (int i = 0; i < 1 + random.below(2); ++i) {
    const double left = -0.35 + 0.6 * i;
    builder.ornament({placed(at, 0.2, left), at.yaw, {0.16, 0.2, 0.12}, 0.74},
                     Material::kBlackPlastic);
    builder.ornament({placed(at, 0.2, left), at.yaw, {0.03, 0.54, 0.34}, 0.84}, Material::kScreen);
    builder.ornament({placed(at, 0.217, left), at.yaw, {0.01, 0.54, 0.34}, 0.84},
                     Material::kBlackPlastic);
  }
  builder.ornament({placed(at, -0.12, -0.2), at.yaw, {0.15, 0.42, 0.02}, 0.74},
                   Material::kBlackPlastic);
  if (random.chance(0.7)) {
    builder.ornament({placed(at, 0.0, 0.55), at.yaw + 0.2, {0.3, 0.21, 0.06}, 0.74},
                     Material::kBooks);
  }
  addChair(builder, spotAt(at, -0.72, random.uniform(-0.2, 0.2), 0.0, true), random);
}

void addMeetingTable(SiteBuilder& builder, const Spot& planned, int chairs_a_side, Random& random) {
  const Spot at = builder.placed(planned);
  const double length = 0.8 * chairs_a_side + 0.2;
  builder.part(at, {0, 0}, {length, 1.1, 0.05}, 0.7, Material::kWood);
  addLegs(builder, at, {length - 0.2, 0.9}, 0.7, Material::kBlackPlastic);
  for (int i = 0; i < chairs_a_side; ++i) {
    const double along = (i + 0.5) * 0.8 - 0.4 * chairs_a_side;
    for (const double side : {1.0, -1.0}) {
      if (random.chance(0.1)) continue;
      addChair(builder, spotAt(at, along, side * random.uniform(0.72, 0.9), -side * M_PI / 2, true),
               random);
    }
  }
}

void addSofa(SiteBuilder& builder, const Spot& planned) {
  const Spot at = builder.placed(planned);
  builder.part(at, {0, 0}, {0.8, 1.9, 0.38}, 0.06, Material::kFabric);
  builder.part(at, {-0.32, 0}, {0.18, 1.9, 0.4}, 0.44, Material::kFabric);
  for (const double side : {1.0, -1.0}) {
    builder.part(at, {0.0, side * 0.88}, {0.8, 0.16, 0.2}, 0.44, Material::kFabric);
    builder.site().spots.push_back(spotAt(at, 0.35, side * 0.42, 0.0, true));
  }
}

void addCupboard(SiteBuilder& builder, const Spot& planned, Random& random) {
  const Spot at = builder.placed(planned);
  const double height = random.uniform(1.6, 2.1);
  if (random.chance(0.6)) {
    builder.part(at, {-0.02, 0}, {0.34, 1.0, height}, 0.0, Material::kDarkWood);
    builder.ornament({placed(at, 0.16, 0.0), at.yaw, {0.02, 0.94, height - 0.1}, 0.06},
                     Material::kBooks);
  } else {
    builder.part(at, {0, 0}, {0.42, 1.0, height}, 0.0, Material::kSteel);
    builder.ornament({at.position, at.yaw, {0.44, 0.012, height - 0.1}, 0.05},
                     Material::kBlackPlastic);
    builder.ornament({placed(at, 0.215, 0.12), at.yaw, {0.03, 0.03, 0.16}, 0.9},
                     Material::kBlackPlastic);
  }
}

void addPlant(SiteBuilder& builder, const Eigen::Vector2d& planned, Random& random) {
  const Eigen::Vector2d at = builder.placed({planned, 0.0}).position;
  builder.box({at, random.uniform(0.0, 1.5), {0.36, 0.36, 0.36}, 0.0}, Material::kWhitePaint);
  builder.ornament({at, 0.0, {0.3, 0.3, 0.01}, 0.36}, Material::kSoil);
  const auto height = static_cast<float>(random.uniform(0.5, 1.1));
  addShrub(builder.site().furniture,
           {static_cast<float>(at.x()), static_cast<float>(at.y()), 0.36F}, height, random);
}

void addNotice(SiteBuilder& builder, const Spot& at, Random& random) {
  const double width = random.uniform(0.3, 0.9), height = random.uniform(0.4, 0.9);
  builder.ornament({at.position, at.yaw, {0.02, width, height}, random.uniform(1.1, 1.4)},
                   Material::kNotices);
}

void addSocket(SiteBuilder& builder, const Spot& at) {
  for (const double up : {0.28, 1.02}) {
    builder.ornament({at.position, at.yaw, {0.024, 0.16, 0.085}, up}, Material::kSteel);
    for (const double y : {-0.04, 0.04}) {
      builder.ornament({placed(at, 0.003, y), at.yaw, {0.024, 0.035, 0.035}, up + 0.025},
                       Material::kBlackPlastic);
    }
  }
}

void addRadiator(SiteBuilder& builder, const Spot& at) {
  builder.part(at, {0, 0}, {0.1, 1.2, 0.55}, 0.14, Material::kWhitePaint);
  for (double y = -0.55; y < 0.6; y += 0.1) {
    builder.ornament({placed(at, 0.055, y), at.yaw, {0.02, 0.05, 0.5}, 0.16}, Material::kSteel);
  }
}

void addBench(SiteBuilder& builder, const Spot& planned) {
  const Spot at = builder.placed(planned);
  for (const double x : {-0.15, 0.0, 0.15}) {
    builder.part(at, {x, 0}, {0.12, 1.8, 0.04}, 0.42, Material::kPallet);
  }
  builder.part(at, {-0.26, 0}, {0.04, 1.8, 0.14}, 0.62, Material::kPallet);
  for (const double y : {-0.75, 0.75}) {
    builder.part(at, {-0.02, y}, {0.45, 0.08, 0.42}, 0.0, Material::kSteel);
    builder.part(at, {-0.26, y}, {0.04, 0.06, 0.36}, 0.42, Material::kSteel);
  }
  for (const double y : {-0.4, 0.4}) {
    builder.site().spots.push_back(spotAt(at, 0.25, y, 0.0, true));
  }
}

void addBicycleStand(SiteBuilder& builder, const Spot& at, int bicycles, Random& random) {
  for (int i = 0; i < bicycles; ++i) {
    const double along = 0.75 * (i - 0.5 * (bicycles - 1));
    for (const double y : {-0.35, 0.35}) {
      builder.ornament({placed(at, along + 0.18, y), at.yaw, {0.05, 0.05, 0.8}, 0.0},
                       Material::kSteel);
    }
    builder.ornament({placed(at, along + 0.18, 0), at.yaw, {0.05, 0.75, 0.05}, 0.78},
                     Material::kSteel);
    if (random.chance(0.75)) {
      const double yaw = M_PI / 2 + 0.06 * random.normal();
      builder.site().bicycles.push_back(spotAt(at, along, random.uniform(-0.15, 0.15), yaw, false));
    }
  }
  builder.block({at.position, {0.75 * bicycles, 1.9}, at.yaw});
}

namespace {

/// What is on a pallet.
struct PalletLoad {
  bool is_empty = false;
  double height = 0.0;            ///< [m]
  std::optional<Material> drums;  ///< of them, if it is no cartons
};

PalletLoad drawLoad(Random& random) {
  PalletLoad load;
  load.is_empty = random.chance(0.12);
  if (load.is_empty) return load;
  load.height = random.uniform(0.45, 1.15);
  if (random.chance(0.7)) return load;
  load.drums = random.chance(0.5) ? Material::kBlueSteel : Material::kBlackPlastic;
  return load;
}

}  // namespace

void addPallet(SiteBuilder& builder, const Spot& at, double base_m, Random& random) {
  for (const double y : {-0.36, 0.0, 0.36}) {
    builder.part(at, {0, y}, {1.2, 0.1, 0.1}, base_m, Material::kPallet);
  }
  builder.part(at, {0, 0}, {1.2, 0.82, 0.03}, base_m + 0.1, Material::kPallet);
  PalletLoad load = drawLoad(random);
  if (builder.isMoved()) load = drawLoad(builder.moves());
  if (load.is_empty) return;
  if (!load.drums) {
    builder.part(at, {0, 0}, {1.12, 0.76, load.height}, base_m + 0.13, Material::kCardboard);
    return;
  }
  for (const double x : {-0.29, 0.29}) {
    builder.part(at, {x, 0}, {0.54, 0.7, 0.8 * load.height}, base_m + 0.13, *load.drums);
  }
}

void addRackBay(SiteBuilder& builder, const Spot& at, Random& random) {
  const auto [length, depth, height] = kRackBay;
  for (const double x : {-0.5 * length, 0.5 * length}) {
    for (const double y : {-0.5, 0.5}) {
      builder.part(at, {x, y * depth}, {0.09, 0.09, height}, 0.0, Material::kBlueSteel);
    }
    for (double z = 0.4; z < height; z += 0.8) {
      builder.ornament({placed(at, x, 0), at.yaw, {0.04, depth, 0.05}, z}, Material::kBlueSteel);
    }
  }
  for (const double level : {0.0, 1.5, 3.0}) {
    const double up = level > 0.0 ? level + 0.12 : 0.0;
    for (const double y : {-0.5, 0.5}) {
      if (level == 0.0) break;
      builder.ornament({placed(at, 0, y * depth), at.yaw, {length, 0.05, 0.12}, level},
                       Material::kOrangeSteel);
    }
    for (const double x : {-0.66, 0.66}) {
      if (random.chance(0.12)) continue;
      const double yaw = 0.02 * random.normal();
      addPallet(builder, spotAt(at, x, random.uniform(-0.05, 0.05), yaw, false), up, random);
    }
  }
  builder.block({at.position, {length, depth}, at.yaw});
}

namespace {

Material drawMachineMaterial(Random& random) {
  constexpr std::array kMaterials = {
      Material::kSteel,    Material::kBlueSteel, Material::kFabric,  Material::kCardboard,
      Material::kDarkWood, Material::kBooks,     Material::kNotices, Material::kBlackPlastic};
  return kMaterials[static_cast<std::size_t>(random.below(kMaterials.size()))];
}

/// A part of a machine in the middle of its spot, of a material of its own.
void addMachinePart(SiteBuilder& builder, const Spot& at, const Eigen::Vector3d& size, double base,
                    Random& random) {
  builder.part(at, {0, 0}, size, base, drawMachineMaterial(random));
}

void addStack(SiteBuilder& builder, const Spot& at, double height, Random& random) {
  const int boxes = 1 + random.below(4);
  double base = 0.0;
  for (int i = 0; i < boxes; ++i) {
    const double top = i + 1 == boxes ? height : base + random.uniform(0.2, 0.8) * (height - base);
    const double turn = random.uniform(-0.4, 0.4);
    const double depth = random.uniform(0.15, 0.6);
    const double width = random.uniform(0.15, 0.9);
    addMachinePart(builder, spotAt(at, 0.0, 0.0, turn, false), {depth, width, top - base}, base,
                   random);
    base = top;
  }
}

void addPost(SiteBuilder& builder, const Spot& at, double height, Random& random) {
  const double foot = random.uniform(0.2, 0.6);
  const double post = random.uniform(0.03, 0.25);
  const double head = random.uniform(0.1, 0.5);
  const double width = random.uniform(0.15, 0.7);
  addMachinePart(builder, at, {foot, foot, 0.1}, 0.0, random);
  addMachinePart(builder, at, {post, post, height}, 0.0, random);
  addMachinePart(builder, at, {0.5 * width, width, head}, height - head, random);
}

void addFrame(SiteBuilder& builder, const Spot& at, double height, Random& random) {
  const double depth = random.uniform(0.4, 0.7);
  const double width = random.uniform(0.5, 1.1);
  addLegs(builder, at, {depth, width}, height, Material::kSteel);
  for (double level = 0.15; level < height; level += random.uniform(0.3, 0.8)) {
    builder.part(at, {0, 0}, {depth, width, 0.03}, level, Material::kSteel);
    if (random.chance(0.5)) continue;
    const double load = random.uniform(0.3, 0.7) * width;
    addMachinePart(builder, at, {0.8 * depth, load, 0.2}, level + 0.03, random);
  }
}

void addClothes(SiteBuilder& builder, const Spot& at, double height, Random& random) {
  builder.part(at, {0, 0}, {0.05, 0.05, height}, 0.0, Material::kDarkWood);
  builder.part(at, {0, 0}, {0.4, 0.4, 0.04}, 0.0, Material::kDarkWood);
  const int coats = 1 + random.below(3);
  for (int i = 0; i < coats; ++i) {
    const double length = random.uniform(0.5, 1.0);
    const double width = random.uniform(0.3, 0.5);
    const double turn = random.uniform(-M_PI, M_PI);
    builder.part(spotAt(at, 0.0, 0.0, turn, false), {0.12, 0.0}, {0.18, width, length},
                 std::max(0.05, height - 0.15 - length), Material::kFabric);
  }
}

}  // namespace

void addMachine(SiteBuilder& builder, const Spot& at, Random& random) {
  const double height = random.uniform(0.7, 2.1);
  switch (random.below(4)) {
    case 0:
      return addStack(builder, at, height, random);
    case 1:
      return addPost(builder, at, height, random);
    case 2:
      return addFrame(builder, at, height, random);
    default:
      return addClothes(builder, at, height, random);
  }
}

void addMachines(SiteBuilder& builder, int count, Random& random) {
  const Site& site = builder.site();
  const NavigationGrid grid(site);
  const auto isFree = [&](const Eigen::Vector2d& at) {
    const auto isNear = [&](const Eigen::Vector2d& place) { return (place - at).norm() < 1.0; };
    const double clearance = grid.clearance(at);
    return clearance > 0.25 && clearance < 0.5 &&
           std::none_of(site.destinations.begin(), site.destinations.end(), isNear) &&
           std::none_of(site.robot_stops.begin(), site.robot_stops.end(), isNear) &&
           std::none_of(site.spots.begin(), site.spots.end(),
                        [&](const Spot& spot) { return isNear(spot.position); });
  };
  for (int i = 0; i < count; ++i) {
    for (int tries = 0; tries < 100; ++tries) {
      const double x = random.uniform(), y = random.uniform();
      const Eigen::Vector2d at =
          site.area.min() + site.area.sizes().cwiseProduct(Eigen::Vector2d(x, y));
      if (!isFree(at)) continue;
      const double yaw = random.uniform(-M_PI, M_PI);
      addMachine(builder, {at, yaw}, random);
      break;
    }
  }
}

}  // namespace headway::sim
