#include "house_mesh.h"

#include <cmath>

namespace headway::sim {

Mesh houseMesh(const HousePlan& plan, const Eigen::Vector3f& foot, float yaw) {
  using Eigen::Vector3f;
  const Vector3f along(std::cos(yaw), std::sin(yaw), 0), back(-std::sin(yaw), std::cos(yaw), 0);
  const Vector3f half = 0.5F * static_cast<float>(plan.facade.width_m) * along;
  const Vector3f deep = static_cast<float>(plan.facade.side_m) * back;
  const Vector3f up(0, 0, static_cast<float>(plan.facade.height_m) + 0.3F);
  // Seen from the street the front's left end is where `along` points away from.
  const Vector3f fl = foot - half, fr = foot + half, bl = fl + deep, br = fr + deep;
  Mesh mesh;
  mesh.addQuad(fl + up, fr + up, fr, fl, facadeFront());
  mesh.addQuad(fr + up, br + up, br, fr, facadeGable());
  mesh.addQuad(bl + up, fl + up, fl, bl, facadeGable());
  mesh.addQuad(br + up, bl + up, bl, br, facadeFront());
  const UvRect roof = facadeRoof();
  if (plan.ridge_m <= 0.0) {
    mesh.addQuad(bl + up, br + up, fr + up, fl + up, roof);
    return mesh;
  }
  const Vector3f ridge = up + Vector3f(0, 0, static_cast<float>(plan.ridge_m)) + 0.5F * deep;
  mesh.addQuad(fl + ridge, fr + ridge, fr + up, fl + up, roof);
  mesh.addQuad(fr + ridge, fl + ridge, bl + up, br + up, roof);
  const UvRect wall = facadeGable().part(0.1F, 0.02F, 0.9F, 0.2F);
  const auto gable = [&](Mesh& side, const Vector3f& front, const Vector3f& rear) {
    side.addTriangle({front + up, wall.at(0, 1)}, {rear + up, wall.at(1, 1)},
                     {front + ridge, wall.at(0.5F, 0)});
  };
  gable(mesh, fl, bl);
  Mesh right;
  gable(right, fr, br);
  mesh.append(turnedOver(right));
  return mesh;
}

}  // namespace headway::sim
