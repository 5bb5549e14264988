// SPDX-License-Identifier: BSD-3-Clause
#include "actor_mesh.h"

#include "actor_atlas.h"

namespace headway::sim {
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
  const float mast = rear + 0.62F * size.x();  // forks reach from here to the front
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
    addBox(mesh, {mast + 0.12F, side * 0.25F - 0.06F, 0.08F},
           {0.5F * size.x(), side * 0.25F + 0.06F, 0.14F}, dark);  // fork
    addWheel(mesh, {mast - 0.3F, side * (half - 0.12F), 0.33F}, 0.33F, 0.22F, dark);
    addWheel(mesh, {rear + 0.35F, side * (half - 0.12F), 0.26F}, 0.26F, 0.2F, dark);
  }
  addBox(mesh, {rear + 0.4F, -half, size.z() - 0.06F}, {mast - 0.2F, half, size.z()}, dark);
  addBox(mesh, {mast + 0.1F, -0.45F, 0.3F}, {mast + 0.14F, 0.45F, 0.75F}, dark);  // carriage
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
