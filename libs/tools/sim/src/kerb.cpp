// SPDX-License-Identifier: BSD-3-Clause
#include "kerb.h"

#include <algorithm>
#include <cmath>

namespace headway::sim {
namespace {

constexpr double kStoneWidth = 0.14;  // of the stones [m]

/// Stones of about a metre.
void layStones(SiteBuilder& builder, const Kerb& kerb, double from, double to) {
  const int count = static_cast<int>(std::ceil(to - from - 1e-6));
  const double length = (to - from) / count, y = kerb.y - 0.5 * kerb.pavement * kStoneWidth;
  for (int i = 0; i < count; ++i) {
    builder.ornament({{from + (i + 0.5) * length, y},
                      0.0,
                      {length - 0.015, kStoneWidth, kerb.height_m + 0.01},
                      -kerb.height_m},
                     Material::kSteel);
  }
}

void bar(SiteBuilder& builder, const Kerb& kerb, double from, double to) {
  const double y = kerb.y - 0.5 * kerb.pavement * kStoneWidth;
  builder.barEdge({{0.5 * (from + to), y}, {to - from, kStoneWidth}, 0.0});
}

/// The upright face between a flare and the roadway, of the stones' material.
void closeFace(SiteBuilder& builder, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
               const Eigen::Vector3d& c) {
  const double size = pictureSize(Material::kSteel);
  const auto vertex = [&](const Eigen::Vector3d& at) {
    return MeshVertex{at.cast<float>(),
                      Eigen::Vector2d(at.x() / size, -at.z() / size).cast<float>()};
  };
  builder.site().surfaces[Material::kSteel].addTriangle(vertex(a), vertex(b), vertex(c));
}

/// A ramp up to the pavement, and on either side a flare whose far half is level.
void layRamp(SiteBuilder& builder, const Kerb& kerb, double x) {
  const auto lay = [&](std::vector<Eigen::Vector3d> outline) {
    if (kerb.pavement < 0.0) std::reverse(outline.begin(), outline.end());
    builder.slope(outline, Material::kConcrete);
  };
  const double foot = kerb.y, top = kerb.y + kerb.pavement * Kerb::kRun, low = -kerb.height_m;
  const double left = x - Kerb::kHalfRamp, right = x + Kerb::kHalfRamp;
  lay({{left, top, 0.0}, {right, top, 0.0}, {right, foot, low}, {left, foot, low}});
  for (const double side : {1.0, -1.0}) {
    const double inner = x + side * Kerb::kHalfRamp, outer = inner + side * Kerb::kFlare;
    std::vector<Eigen::Vector3d> low_half = {
        {inner, top, 0.0}, {outer, foot, 0.0}, {inner, foot, low}};
    std::vector<Eigen::Vector3d> level = {{inner, top, 0.0}, {outer, top, 0.0}, {outer, foot, 0.0}};
    for (auto* half : {&low_half, &level}) {
      if (side < 0.0) std::reverse(half->begin(), half->end());
      lay(*half);
    }
    closeFace(builder, {inner, foot, low}, {outer, foot, 0.0}, {outer, foot, low});
  }
}

}  // namespace

std::vector<Eigen::AlignedBox2d> Kerb::rampAreas() const {
  std::vector<Eigen::AlignedBox2d> areas;
  for (const double x : ramps) {
    areas.push_back(
        rectangle(x - kHalfRamp - kFlare, y, x + kHalfRamp + kFlare, y + pavement * kRun));
  }
  return areas;
}

void addKerb(SiteBuilder& builder, const Kerb& kerb) {
  double stones_from = kerb.from_x, barred_from = kerb.from_x;
  for (const double x : kerb.ramps) {
    layStones(builder, kerb, stones_from, x - Kerb::kHalfRamp - Kerb::kFlare);
    bar(builder, kerb, barred_from, x - Kerb::kHalfRamp);
    layRamp(builder, kerb, x);
    stones_from = x + Kerb::kHalfRamp + Kerb::kFlare;
    barred_from = x + Kerb::kHalfRamp;
  }
  layStones(builder, kerb, stones_from, kerb.to_x);
  bar(builder, kerb, barred_from, kerb.to_x);
}

}  // namespace headway::sim
