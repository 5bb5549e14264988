// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "actor_atlas.h"
#include "actor_mesh.h"
#include "vehicle_shape.h"

namespace headway::sim {
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

}  // namespace headway::sim
