// SPDX-License-Identifier: BSD-3-Clause
#include "house_mesh.h"

#include <cmath>

namespace headway::sim {
namespace {

using Eigen::Vector3f;

/// Half the front, the depth and the height of the walls, as ways.
struct HouseAxes {
  HouseAxes(const FacadePlan& facade, float yaw)
      : half(0.5F * static_cast<float>(facade.width_m) * Vector3f(std::cos(yaw), std::sin(yaw), 0)),
        deep(static_cast<float>(facade.side_m) * Vector3f(-std::sin(yaw), std::cos(yaw), 0)),
        up(0, 0, static_cast<float>(facade.height_m) + 0.3F) {}

  Vector3f half, deep, up;
};

}  // namespace

Block houseBlock(const HousePlan& plan, const Vector3f& foot, float yaw) {
  const HouseAxes to(plan.facade, yaw);
  // Seen from the street the front's left end is where `half` points away from.
  const Vector3f fl = foot - to.half, fr = foot + to.half, bl = fl + to.deep, br = fr + to.deep;
  return {fl, fr, br, bl, fl + to.up, fr + to.up, br + to.up, bl + to.up};
}

Mesh houseMesh(const HousePlan& plan, const Vector3f& foot, float yaw) {
  const HouseAxes to(plan.facade, yaw);
  const auto [fl, fr, br, bl, top_fl, top_fr, top_br, top_bl] = houseBlock(plan, foot, yaw);
  Mesh mesh;
  mesh.addQuad(top_fl, top_fr, fr, fl, facadeFront());
  mesh.addQuad(top_fr, top_br, br, fr, facadeGable());
  mesh.addQuad(top_bl, top_fl, fl, bl, facadeGable());
  mesh.addQuad(top_br, top_bl, bl, br, facadeFront());
  const UvRect roof = facadeRoof();
  if (plan.ridge_m <= 0.0) {
    mesh.addQuad(top_bl, top_br, top_fr, top_fl, roof);
    return mesh;
  }
  const Vector3f ridge = to.up + Vector3f(0, 0, static_cast<float>(plan.ridge_m)) + 0.5F * to.deep;
  mesh.addQuad(fl + ridge, fr + ridge, top_fr, top_fl, roof);
  mesh.addQuad(fr + ridge, fl + ridge, top_bl, top_br, roof);
  const UvRect wall = facadeGable().part(0.1F, 0.02F, 0.9F, 0.2F);
  mesh.addTriangle({top_fl, wall.at(0, 1)}, {top_bl, wall.at(1, 1)},
                   {fl + ridge, wall.at(0.5F, 0)});
  mesh.addTriangle({top_fr, wall.at(0, 1)}, {fr + ridge, wall.at(0.5F, 0)},
                   {top_br, wall.at(1, 1)});
  return mesh;
}

}  // namespace headway::sim
