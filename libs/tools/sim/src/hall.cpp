// SPDX-License-Identifier: BSD-3-Clause
// The hall: an office floor.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "site_furniture.h"

namespace headway::sim {
namespace {

constexpr double kCeiling = 2.8;  // [m]
constexpr double kWallFace = 0.07;

/// A room beside the corridor: its rectangle and the door in its corridor wall.
struct Room {
  Eigen::AlignedBox2d area;
  double door_x = 0.0;
  double door_width = 1.1;
  bool north = true;

  /// A place `in` metres from the corridor wall, `along` it.
  [[nodiscard]] Eigen::Vector2d place(double along, double in) const {
    return {along, north ? area.min().y() + in : area.max().y() - in};
  }
  [[nodiscard]] double depth() const { return area.sizes().y(); }
  /// Away from the corridor.
  [[nodiscard]] double outwards() const { return north ? M_PI / 2 : -M_PI / 2; }
};

/// An office floor: rooms on both sides of a corridor, and a lobby at its western end.
class HallPlan {
 public:
  HallPlan(Site& site, const WorldParams& params, std::uint64_t seed)
      : builder_(site, params, seed), site_(site), random_(seed) {}

  void build() {
    length_ = random_.uniform(23.0, 28.0);
    width_ = random_.uniform(2.4, 3.0);
    for (const bool north : {true, false}) buildWing(north);
    buildCorridor();
    buildLobby();
    site_.area = rectangle(lobby_.min().x(), -7.0, length_, width_ + 7.0);
  }

 private:
  void buildWing(bool north);
  void buildRoom(const Room& room);
  void furnishOffice(const Room& room);
  void furnishMeetingRoom(const Room& room);
  void furnishLounge(const Room& room);
  void furnishStore(const Room& room);
  void buildCorridor();
  void buildLobby();
  void addLamps(const Eigen::AlignedBox2d& area);
  /// Windows along an outer wall of that length.
  std::vector<Opening> windows(double length);

  /// Whether the corridor has a wall there, with half a metre beside.
  [[nodiscard]] bool isWall(double x, bool north) const;

  SiteBuilder builder_;
  Site& site_;
  Random random_;
  std::map<bool, std::vector<Opening>> doors_;  ///< of the northern and the southern wing
  double length_ = 25.0, width_ = 2.6;
  Eigen::AlignedBox2d lobby_;
};

std::vector<Opening> HallPlan::windows(double length) {
  std::vector<Opening> openings;
  for (double at = 1.3; at < length - 1.1; at += 2.2) {
    if (random_.chance(0.85)) openings.push_back({at, 1.6, 0.9, 2.3});
  }
  return openings;
}

bool HallPlan::isWall(double x, bool north) const {
  const auto& doors = doors_.at(north);
  return x > 0.5 && x < length_ - 0.5 &&
         std::none_of(doors.begin(), doors.end(), [&](const Opening& door) {
           return std::abs(x - door.at_m) < 0.5 * door.width_m + 0.5;
         });
}

void HallPlan::addLamps(const Eigen::AlignedBox2d& area) {
  for (double x = area.min().x() + 1.2; x < area.max().x() - 0.6; x += 2.6) {
    for (double y = area.min().y() + 1.2; y < area.max().y() - 0.4; y += 2.8) {
      builder_.ornament({{x, y}, 0.0, {1.2, 0.3, 0.05}, kCeiling - 0.05}, Material::kLamp);
    }
  }
}

void HallPlan::buildWing(bool north) {
  const double depth = random_.uniform(5.0, 6.5);
  const double wall_y = north ? width_ : 0.0, outer_y = north ? width_ + depth : -depth;
  const Material paint = random_.chance(0.5) ? Material::kPlaster : Material::kColouredPlaster;
  std::vector<Opening> doors;
  double x = 0.0;
  while (x < length_ - 0.1) {
    double next = x + random_.uniform(4.6, 7.5);
    if (length_ - next < 4.2) next = length_;
    Room room;
    room.area = rectangle(x, wall_y, next, outer_y);
    room.north = north;
    room.door_width = random_.uniform(1.05, 1.3);
    room.door_x = random_.uniform(x + 1.2, next - 1.2);
    doors.push_back({room.door_x, room.door_width, 0.0, 2.1});
    buildRoom(room);
    builder_.wall({next, wall_y}, {next, outer_y}, kCeiling, paint);
    x = next;
  }
  builder_.wall({0.0, wall_y}, {length_, wall_y}, kCeiling, paint, doors);
  doors_[north] = doors;
  builder_.wall({0.0, wall_y}, {0.0, outer_y}, kCeiling, paint);
  builder_.wall({0.0, outer_y}, {length_, outer_y}, kCeiling, Material::kPlaster, windows(length_));
}

void HallPlan::buildRoom(const Room& room) {
  builder_.floor(room.area, 0.0, random_.chance(0.5) ? Material::kCarpet : Material::kLinoleum);
  builder_.ceiling(room.area, kCeiling, Material::kCeiling);
  addLamps(room.area);
  if (random_.chance(0.7)) {
    builder_.threshold(room.place(room.door_x, 0.0), M_PI / 2, room.door_width - 0.1,
                       random_.uniform(0.006, 0.014));
  }
  // The door stands open, inside.
  const double hinge = room.door_x + 0.5 * room.door_width + 0.02;
  builder_.box({room.place(hinge, 0.07 + 0.48), M_PI / 2, {0.96, 0.045, 2.05}, 0.01},
               Material::kWood);
  const Eigen::Vector2d inside = room.place(room.door_x, 1.1);
  site_.robot_stops.push_back(inside);
  site_.destinations.push_back(inside);
  const int kind = random_.below(5);
  if (kind <= 1) furnishOffice(room);
  if (kind == 2) furnishMeetingRoom(room);
  if (kind == 3) furnishLounge(room);
  if (kind == 4) furnishStore(room);
}

void HallPlan::furnishOffice(const Room& room) {
  const double back = room.depth() - 0.9;
  for (double x = room.area.min().x() + 1.3; x < room.area.max().x() - 1.2; x += 2.0) {
    addDesk(builder_, {room.place(x, back), room.outwards()}, random_);
    addRadiator(builder_, {room.place(x, room.depth() - 0.14), room.outwards() + M_PI});
  }
  const double left = room.area.min().x() + 0.3;
  addCupboard(builder_, {room.place(left, 1.9), 0.0}, random_);
  addCupboard(builder_, {room.place(left, 2.95), 0.0}, random_);
  addPlant(builder_, room.place(room.area.max().x() - 0.4, 2.0), random_);
  addNotice(builder_, {room.place(room.area.max().x() - kWallFace, 1.4), M_PI}, random_);
  addSocket(builder_, {room.place(room.area.max().x() - kWallFace, 3.4), M_PI});
  site_.destinations.push_back(room.place(room.area.center().x(), 2.6));
  site_.spots.push_back({room.place(room.area.max().x() - 0.6, 2.9), -room.outwards()});
}

void HallPlan::furnishMeetingRoom(const Room& room) {
  const double width = room.area.sizes().x();
  addMeetingTable(builder_, {room.place(room.area.center().x(), 0.62 * room.depth()), 0.0},
                  std::max(2, static_cast<int>((width - 2.4) / 0.8)), random_);
  const double right = room.area.max().x() - kWallFace - 0.02;
  builder_.ornament({room.place(right, 0.6 * room.depth()), 0.0, {0.04, 2.2, 1.2}, 0.9},
                    Material::kWhiteboard);
  addPlant(builder_, room.place(room.area.min().x() + 0.4, room.depth() - 0.4), random_);
  site_.destinations.push_back(room.place(room.area.min().x() + 0.6, 1.4));
}

void HallPlan::furnishLounge(const Room& room) {
  const double x0 = room.area.min().x(), x1 = room.area.max().x();
  addSofa(builder_, {room.place(x0 + 0.6, 0.6 * room.depth()), 0.0});
  addSofa(builder_, {room.place(0.5 * (x0 + x1), room.depth() - 0.6), -room.outwards()});
  builder_.box({room.place(0.5 * (x0 + x1) - 0.2, 0.6 * room.depth()), 0.1, {0.9, 0.6, 0.42}, 0.0},
               Material::kWood);
  addPlant(builder_, room.place(x1 - 0.45, room.depth() - 0.45), random_);
  addCupboard(builder_, {room.place(x1 - 0.32, 2.2), M_PI}, random_);
  site_.destinations.push_back(room.place(0.5 * (x0 + x1), 1.8));
  site_.spots.push_back({room.place(x1 - 0.9, 0.55 * room.depth()), M_PI});
}

void HallPlan::furnishStore(const Room& room) {
  for (double x = room.area.min().x() + 0.7; x < room.area.max().x() - 0.5; x += 1.05) {
    addCupboard(builder_, {room.place(x, room.depth() - 0.35), -room.outwards()}, random_);
  }
  for (int i = 0; i < 3; ++i) {
    const double size = random_.uniform(0.3, 0.55);
    builder_.box({room.place(room.area.max().x() - 0.5, 1.8 + 0.7 * i),
                  random_.uniform(-0.3, 0.3),
                  {size, size, size},
                  0.0},
                 Material::kCardboard);
  }
  site_.destinations.push_back(room.place(room.area.center().x(), 0.55 * room.depth()));
}

void HallPlan::buildCorridor() {
  const auto area = rectangle(0.0, 0.0, length_, width_);
  builder_.floor(area, 0.0, Material::kLinoleum);
  builder_.ceiling(area, kCeiling, Material::kCeiling);
  addLamps(area);
  builder_.wall({length_, 0.0}, {length_, width_}, kCeiling, Material::kPlaster,
                {{0.5 * width_, 1.4, 0.9, 2.3}});
  for (double x = 2.0; x < length_ - 1.0; x += 4.0) {
    site_.robot_stops.push_back({x, 0.5 * width_});
    site_.destinations.push_back({x + 1.0, random_.uniform(0.6, width_ - 0.6)});
    for (const bool north : {true, false}) {
      const double face = north ? width_ - kWallFace : kWallFace,
                   yaw = north ? -M_PI / 2 : M_PI / 2;
      const double middle = x + random_.uniform(-1.2, 1.2), beside = random_.uniform(0.7, 1.9);
      if (random_.chance(0.7) && isWall(middle, north)) {
        addNotice(builder_, {{middle, face}, yaw}, random_);
      }
      for (const double at : {middle - beside, middle + beside}) {
        if (isWall(at, north)) addSocket(builder_, {{at, face}, yaw});
      }
    }
  }
  // A copier that stands in the way a little, and a fire extinguisher.
  builder_.box({{length_ - 0.45, 0.42}, 0.0, {0.7, 0.6, 1.05}, 0.0}, Material::kWhitePaint);
  builder_.ornament({{length_ - 0.45, 0.42}, 0.0, {0.6, 0.5, 0.1}, 1.05}, Material::kBlackPlastic);
  // The robot starts in the middle of the corridor.
  site_.robot_stops.insert(site_.robot_stops.begin(), {0.4 * length_, 0.5 * width_});
}

void HallPlan::buildLobby() {
  const double reach = random_.uniform(8.5, 10.5), y0 = -4.2, y1 = width_ + 3.6;
  lobby_ = rectangle(-reach, y0, 0.0, y1);
  const auto stairs = rectangle(-reach + 0.6, y0 + 0.5, -reach + 3.2, y0 + 2.1);
  builder_.floor(lobby_, 0.0, Material::kPaving, {stairs});
  builder_.ceiling(lobby_, kCeiling, Material::kCeiling);
  addLamps(lobby_);
  builder_.wall({-reach, y0}, {0.0, y0}, kCeiling, Material::kColouredPlaster, windows(reach));
  builder_.wall({-reach, y1}, {0.0, y1}, kCeiling, Material::kColouredPlaster);
  builder_.wall({-reach, y0}, {-reach, y1}, kCeiling, Material::kBrick, windows(y1 - y0));
  builder_.wall({0.0, y0}, {0.0, 0.0}, kCeiling, Material::kColouredPlaster);
  builder_.wall({0.0, width_}, {0.0, y1}, kCeiling, Material::kColouredPlaster);
  builder_.pit(stairs, 1.7, Material::kConcrete);
  builder_.stairsDown(stairs, 1.7, false, Material::kConcrete);
  const Eigen::Vector2d low = stairs.min(), high = stairs.max();
  builder_.railing({low.x(), high.y()}, high, Material::kSteel);
  builder_.railing(low, {low.x(), high.y()}, Material::kSteel);
  builder_.railing(low, {high.x(), low.y()}, Material::kSteel);
  // Reception, waiting area, columns.
  builder_.box({{-0.5 * reach, y1 - 1.3}, 0.0, {2.6, 0.7, 1.1}, 0.0}, Material::kDarkWood);
  builder_.ornament({{-0.5 * reach, y1 - 1.3}, 0.0, {2.7, 0.8, 0.05}, 1.1}, Material::kWood);
  addSofa(builder_, {{-1.0, y0 + 1.6}, M_PI});
  addSofa(builder_, {{-2.4, y0 + 0.6}, M_PI / 2});
  addPlant(builder_, {-0.5, y1 - 0.5}, random_);
  addPlant(builder_, {-reach + 0.5, y1 - 0.5}, random_);
  for (const double x : {-0.35 * reach, -0.7 * reach}) {
    builder_.box({{x, 0.5 * width_ + 1.9}, 0.0, {0.4, 0.4, kCeiling}, 0.0}, Material::kWhitePaint);
  }
  for (const double x : {-1.4, -0.5 * reach, -reach + 1.2}) {
    site_.robot_stops.push_back({x, 0.5 * width_});
    site_.destinations.push_back({x, 0.5 * width_ + random_.uniform(-1.2, 1.2)});
  }
  site_.robot_stops.push_back({-0.5 * reach, -1.4});
  site_.spots.push_back({{-0.5 * reach + 0.6, y1 - 2.1}, M_PI / 2});
  site_.spots.push_back({{-0.5 * reach - 0.5, y1 - 2.2}, 1.2});
}

}  // namespace

Site makeHall(const WorldParams& params, const Grain& /*grain*/, std::uint64_t seed) {
  Site site;
  HallPlan(site, params, seed).build();
  return site;
}

}  // namespace headway::sim
