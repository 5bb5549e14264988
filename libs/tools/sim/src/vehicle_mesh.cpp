// SPDX-License-Identifier: BSD-3-Clause
// Meshes of vehicles and machines.
#include <algorithm>
#include <array>
#include <cmath>

#include "actor_atlas.h"
#include "actor_mesh.h"

namespace headway::sim {
namespace {

const std::array<VehicleShape, 3> kCars = {{
    {{{0.0, 0.38},
      {0.01, 0.6},
      {0.14, 0.66},
      {0.27, 0.94},
      {0.36, 1.0},
      {0.55, 0.99},
      {0.7, 0.67},
      {0.95, 0.55},
      {1.0, 0.36}}},
    {{{0.0, 0.35},
      {0.01, 0.62},
      {0.05, 0.72},
      {0.13, 0.95},
      {0.25, 1.0},
      {0.54, 0.98},
      {0.72, 0.67},
      {0.95, 0.56},
      {1.0, 0.36}}},
    {{{0.0, 0.35},
      {0.01, 0.64},
      {0.07, 0.94},
      {0.12, 0.99},
      {0.3, 1.0},
      {0.56, 0.98},
      {0.71, 0.67},
      {0.96, 0.54},
      {1.0, 0.36}}},
}};
const VehicleShape kVan{{{0.0, 0.3},
                         {0.005, 0.9},
                         {0.03, 0.98},
                         {0.1, 1.0},
                         {0.66, 1.0},
                         {0.72, 0.97},
                         {0.85, 0.6},
                         {0.98, 0.48},
                         {1.0, 0.3}},
                        0.13,
                        0.55,
                        0.9};
const VehicleShape kTruck{{{0.0, 0.25},
                           {0.0, 0.99},
                           {0.01, 1.0},
                           {0.73, 1.0},
                           {0.735, 0.84},
                           {0.76, 0.86},
                           {0.93, 0.85},
                           {0.985, 0.5},
                           {1.0, 0.2}},
                          0.14,
                          0.5,
                          0.98,
                          0.2,
                          0.86,
                          0.46};
const VehicleShape kBus{{{0.0, 0.2},
                         {0.0, 0.95},
                         {0.02, 1.0},
                         {0.5, 1.0},
                         {0.975, 1.0},
                         {0.99, 0.95},
                         {1.0, 0.45},
                         {1.0, 0.2}},
                        0.1,
                        0.45,
                        0.97,
                        0.25,
                        0.78,
                        0.48};

}  // namespace

const VehicleShape& shapeOf(ActorKind kind, int look) {
  switch (kind) {
    case ActorKind::kVan:
      return kVan;
    case ActorKind::kTruck:
      return kTruck;
    case ActorKind::kBus:
      return kBus;
    default:
      return kCars[static_cast<std::size_t>(look % 3)];
  }
}

namespace {

using Eigen::Vector3f;

/// Turns ratios of length, width and height into metres.
struct Body {
  const VehicleShape& shape;
  float length, width, height;

  [[nodiscard]] float x(double ratio) const { return (static_cast<float>(ratio) - 0.5F) * length; }
  [[nodiscard]] float z(double ratio) const { return static_cast<float>(ratio) * height; }
  /// Half width at a height ratio: full up to the belt, leaning in above it.
  [[nodiscard]] float halfWidth(double ratio) const {
    const double above = std::max(0.0, (ratio - shape.belt) / (1.0 - shape.belt));
    return 0.5F * width * static_cast<float>(1.0 - (1.0 - shape.lean) * above);
  }
  [[nodiscard]] Vector3f at(double x_share, double z_share, float side) const {
    return {x(x_share), side * halfWidth(z_share), z(z_share)};
  }
};

/// Looks to the left on both sides.
Mesh sideMesh(const Body& body, const UvRect& uv, float side) {
  Mesh mesh;
  const auto vertex = [&](double x, double z) {
    return MeshVertex{body.at(x, z, side),
                      uv.at(static_cast<float>(x), 1.0F - static_cast<float>(z))};
  };
  const auto quad = [&](double x0, double x1, double low0, double low1, double high0,
                        double high1) {
    if (high0 - low0 < 1e-6 && high1 - low1 < 1e-6) return;
    mesh.addTriangle(vertex(x0, low0), vertex(x1, low1), vertex(x1, high1));
    mesh.addTriangle(vertex(x0, low0), vertex(x1, high1), vertex(x0, high0));
  };
  const auto& outline = body.shape.outline;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const OutlinePoint &a = outline[i], &b = outline[i + 1];
    const double mid_a = std::min(a.z, body.shape.belt), mid_b = std::min(b.z, body.shape.belt);
    quad(a.x, b.x, body.shape.floor, body.shape.floor, mid_a, mid_b);
    quad(a.x, b.x, mid_a, mid_b, a.z, b.z);
  }
  return mesh;
}

void addSkinOver(Mesh& mesh, const Body& body, const VehicleSkin& skin) {
  const auto& outline = body.shape.outline;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const OutlinePoint &a = outline[i], &b = outline[i + 1];
    // Steep stretches at the ends show the front and rear pictures, the others the top's.
    UvRect uv = skin.top.part(static_cast<float>(a.x), 0, static_cast<float>(b.x), 1);
    const bool rear = b.x <= 0.05, front = a.x >= 0.93;
    if (rear || front) {
      const UvRect& face = rear ? skin.rear : skin.front;
      const auto v = [](double z) { return 1.0F - static_cast<float>(z); };
      const MeshVertex al{body.at(a.x, a.z, 1), face.at(rear ? 0.0F : 1.0F, v(a.z))};
      const MeshVertex ar{body.at(a.x, a.z, -1), face.at(rear ? 1.0F : 0.0F, v(a.z))};
      const MeshVertex bl{body.at(b.x, b.z, 1), face.at(rear ? 0.0F : 1.0F, v(b.z))};
      const MeshVertex br{body.at(b.x, b.z, -1), face.at(rear ? 1.0F : 0.0F, v(b.z))};
      mesh.addTriangle(al, bl, br);
      mesh.addTriangle(al, br, ar);
      continue;
    }
    mesh.addQuad(body.at(a.x, a.z, 1), body.at(b.x, b.z, 1), body.at(b.x, b.z, -1),
                 body.at(a.x, a.z, -1), uv);
  }
}

/// The lower ends: from the floor up to where the outline begins.
void addEnd(Mesh& mesh, const Body& body, const UvRect& uv, bool rear) {
  const double x = rear ? 0.0 : 1.0;
  const double top = rear ? body.shape.outline.front().z : body.shape.outline.back().z;
  const float left = rear ? 1.0F : -1.0F;  // whose left side is the picture's left
  mesh.addQuad(
      body.at(x, top, left), body.at(x, top, -left), body.at(x, body.shape.floor, -left),
      body.at(x, body.shape.floor, left),
      uv.part(0, 1.0F - static_cast<float>(top), 1, 1.0F - static_cast<float>(body.shape.floor)));
}

void addWheel(Mesh& mesh, const Body& body, const VehicleSkin& skin, double x_share, float side) {
  constexpr int kCorners = 10;
  const float r = static_cast<float>(body.shape.wheel_radius_m);
  const float y = side * (0.5F * body.width - 0.01F), inner = side * (0.5F * body.width - 0.24F);
  const auto rim = [&](int i, float at_y) {
    const float a = 2.0F * static_cast<float>(M_PI * i / kCorners);
    return Vector3f(body.x(x_share) + r * std::cos(a), at_y, r + r * std::sin(a));
  };
  const auto on_side = [&](const Vector3f& p) {
    return MeshVertex{p, skin.side.at(p.x() / body.length + 0.5F, 1.0F - p.z() / body.height)};
  };
  const MeshVertex hub = on_side({body.x(x_share), y, r});
  const Vector3f inner_hub(body.x(x_share), inner, r);
  const Eigen::Vector2f dark = skin.dark.at(0.5F, 0.5F);
  Mesh wheel;  // as a left one
  for (int i = 0; i < kCorners; ++i) {
    wheel.addTriangle(hub, on_side(rim(i, y)), on_side(rim(i + 1, y)));
    wheel.addQuad(rim(i, inner), rim(i + 1, inner), rim(i + 1, y), rim(i, y), skin.dark);
    wheel.addTriangle({inner_hub, dark}, {rim(i + 1, inner), dark}, {rim(i, inner), dark});
  }
  mesh.append(side > 0 ? wheel : turnedOver(wheel));
}

}  // namespace

Mesh vehicleMesh(const Actor& actor) {
  const VehicleShape& shape = shapeOf(actor.kind, actor.look);
  const VehicleSkin skin = vehicleSkin(actor.kind, actor.look);
  const Body body{shape, static_cast<float>(actor.size.x()), static_cast<float>(actor.size.y()),
                  static_cast<float>(actor.size.z())};
  Mesh mesh;
  for (const float side : {1.0F, -1.0F}) {
    const Mesh flank = sideMesh(body, skin.side, side);
    mesh.append(side > 0 ? flank : turnedOver(flank));
    addWheel(mesh, body, skin, shape.rear_wheel, side);
    addWheel(mesh, body, skin, shape.front_wheel, side);
  }
  addSkinOver(mesh, body, skin);
  addEnd(mesh, body, skin.rear, true);
  addEnd(mesh, body, skin.front, false);
  mesh.addQuad(body.at(0, shape.floor, -1), body.at(1, shape.floor, -1), body.at(1, shape.floor, 1),
               body.at(0, shape.floor, 1), skin.dark);
  return mesh;
}

namespace {

using Eigen::Vector3f;

/// A closed box between two corners; its sides face outwards.
void addBox(Mesh& mesh, const Vector3f& low, const Vector3f& high, const UvRect& uv) {
  const Vector3f a(low.x(), high.y(), 0), b(low.x(), low.y(), 0), c(high.x(), low.y(), 0),
      d(high.x(), high.y(), 0);
  const Vector3f up(0, 0, high.z()), down(0, 0, low.z());
  const std::array<Vector3f, 4> around = {a, b, c, d};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3f &from = around[i], &to = around[(i + 1) % 4];
    mesh.addQuad(from + up, to + up, to + down, from + down, uv);
  }
  mesh.addQuad(a + up, d + up, c + up, b + up, uv);
  mesh.addQuad(a + down, b + down, c + down, d + down, uv);
}

/// A wheel across the vehicle, eight-cornered.
void addWheel(Mesh& mesh, const Vector3f& middle, float radius, float width, const UvRect& uv) {
  constexpr int kCorners = 8;
  const auto rim = [&](int i, float side) {
    const float angle = 2.0F * static_cast<float>(M_PI) * static_cast<float>(i) / kCorners;
    return Vector3f(
        middle + Vector3f(radius * std::cos(angle), side * 0.5F * width, radius * std::sin(angle)));
  };
  const Eigen::Vector2f dark = uv.at(0.5F, 0.5F);
  for (int i = 0; i < kCorners; ++i) {
    mesh.addQuad(rim(i, -1), rim(i + 1, -1), rim(i + 1, 1), rim(i, 1), uv);
    for (const float side : {1.0F, -1.0F}) {
      const Vector3f hub = middle + Vector3f(0, side * 0.5F * width, 0);
      const Vector3f &p = rim(i, side), &q = rim(i + 1, side);
      mesh.addTriangle({hub, dark}, {side > 0 ? p : q, dark}, {side > 0 ? q : p, dark});
    }
  }
}

}  // namespace

Mesh forkliftMesh(const Actor& actor) {
  const VehicleSkin skin = vehicleSkin(ActorKind::kVan, actor.look);
  const UvRect paint = skin.side.part(0.3F, 0.55F, 0.7F, 0.8F), dark = skin.dark;
  const Vector3f size = actor.size.cast<float>();
  const float rear = -0.5F * size.x(), half = 0.5F * size.y();
  const auto mast = rear + static_cast<float>(kForklift.mast_ratio) * size.x();
  const auto fork = static_cast<float>(kForklift.fork_m);
  const auto half_fork = 0.5F * static_cast<float>(kForklift.fork_width_m);
  const auto carriage = mast + static_cast<float>(kForklift.carriage_m);
  Mesh mesh;
  addBox(mesh, {rear, -half, 0.25F}, {rear + 0.5F, half, 1.05F}, paint);  // counterweight
  addBox(mesh, {rear + 0.5F, -half, 0.25F}, {mast - 0.15F, half, 0.62F}, paint);
  addBox(mesh, {rear + 0.55F, -0.28F, 0.62F}, {rear + 1.0F, 0.28F, 0.8F}, dark);  // seat
  addBox(mesh, {rear + 0.5F, -0.28F, 0.8F}, {rear + 0.6F, 0.28F, 1.3F}, dark);
  addBox(mesh, {mast - 0.35F, -0.3F, 0.62F}, {mast - 0.25F, 0.3F, 1.1F}, dark);  // dashboard
  for (const float side : {1.0F, -1.0F}) {
    const float y = side * (half - 0.06F);
    for (const float x : {rear + 0.45F, mast - 0.25F}) {  // cage
      addBox(mesh, {x - 0.04F, y - 0.04F, 0.6F}, {x + 0.04F, y + 0.04F, size.z() - 0.06F}, dark);
    }
    addBox(mesh, {mast, side * 0.35F - 0.06F, 0.08F}, {mast + 0.12F, side * 0.35F + 0.06F, 2.05F},
           dark);
    addBox(mesh, {mast + 0.12F, side * fork - half_fork, 0.08F},
           {0.5F * size.x(), side * fork + half_fork, 0.14F}, dark);
    addWheel(mesh, {mast - 0.3F, side * (half - 0.12F), 0.33F}, 0.33F, 0.22F, dark);
    addWheel(mesh, {rear + 0.35F, side * (half - 0.12F), 0.26F}, 0.26F, 0.2F, dark);
  }
  addBox(mesh, {rear + 0.4F, -half, size.z() - 0.06F}, {mast - 0.2F, half, size.z()}, dark);
  addBox(mesh, {mast + 0.1F, -0.45F, 0.3F}, {carriage, 0.45F, 0.75F}, dark);
  return mesh;
}

Mesh deliveryRobotMesh(const Actor& actor) {
  const VehicleSkin skin = vehicleSkin(ActorKind::kCar, actor.look);
  const UvRect paint = skin.top.part(0.4F, 0.05F, 0.7F, 0.95F), dark = skin.dark;
  const Vector3f size = actor.size.cast<float>();
  const float front = 0.5F * size.x(), half = 0.5F * size.y();
  const float lid = 0.85F * size.z();
  Mesh mesh;
  addBox(mesh, {-front, -half, 0.14F}, {front, half, 0.3F}, dark);
  addBox(mesh, {-front + 0.03F, -half + 0.02F, 0.3F}, {front - 0.03F, half - 0.02F, lid}, paint);
  addBox(mesh, {-front + 0.06F, -half + 0.05F, lid}, {front - 0.06F, half - 0.05F, size.z()},
         skin.top);
  for (const float x : {-0.72F, 0.0F, 0.72F}) {
    for (const float side : {1.0F, -1.0F}) {
      addWheel(mesh, {x * front, side * (half - 0.04F), 0.11F}, 0.11F, 0.08F, dark);
    }
  }
  addBox(mesh, {-front + 0.05F, half - 0.08F, lid}, {-front + 0.07F, half - 0.06F, 1.15F}, dark);
  addBox(mesh, {-front - 0.13F, half - 0.08F, 1.0F}, {-front + 0.05F, half - 0.06F, 1.15F}, paint);
  return mesh;
}

}  // namespace headway::sim
