// SPDX-License-Identifier: BSD-3-Clause
// A place that robots work in, and the builder of its surfaces and obstacles.
#include "site.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace headway::sim {
namespace {

/// Height of a triangle at a place; nullopt beside it.
std::optional<double> heightIn(const std::array<Eigen::Vector3d, 3>& triangle,
                               const Eigen::Vector2d& at) {
  const Eigen::Vector2d a = triangle[0].head<2>();
  Eigen::Matrix2d edges;
  edges << triangle[1].head<2>() - a, triangle[2].head<2>() - a;
  const Eigen::Vector2d weights = edges.inverse() * (at - a);
  constexpr double kTolerance = 1e-9;  // of rounding, so that no gap is between two triangles
  if (!(weights.minCoeff() >= -kTolerance && weights.sum() <= 1.0 + kTolerance)) {
    return std::nullopt;
  }
  return triangle[0].z() + weights.x() * (triangle[1].z() - triangle[0].z()) +
         weights.y() * (triangle[2].z() - triangle[0].z());
}

}  // namespace

double groundHeight(const Site& site, const Eigen::Vector2d& at) {
  for (const auto& triangle : site.ground) {
    if (const auto height = heightIn(triangle, at)) return *height;
  }
  return 0.0;
}

double wheelHeight(const Site& site, const Eigen::Vector2d& at) {
  constexpr double kRamp = 0.06;  // of a wheel that climbs a step [m]
  double height = 0.0;
  for (const Threshold& threshold : site.thresholds) {
    const Footprint& strip = threshold.strip;
    const Eigen::Vector2d ex(std::cos(strip.yaw), std::sin(strip.yaw));
    const Eigen::Vector2d to = at - strip.centre;
    const double across = std::abs(ex.x() * to.y() - ex.y() * to.x());
    const double beyond = std::abs(to.dot(ex)) - 0.5 * strip.size.x();
    if (across > 0.5 * strip.size.y() || beyond > kRamp) continue;
    const double ratio = std::clamp(1.0 - beyond / kRamp, 0.0, 1.0);
    height = std::max(height, threshold.height_m * 0.5 * (1.0 - std::cos(M_PI * ratio)));
  }
  return groundHeight(site, at) + height;
}

namespace {

constexpr double kBlocksFrom = 0.03, kBlocksTo = 2.0;  // heights that people and robots take [m]
constexpr double kWallThickness = 0.14;                // [m]

Eigen::Vector2d direction(double yaw) { return {std::cos(yaw), std::sin(yaw)}; }
Eigen::Vector2d leftOf(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

Eigen::Vector3d raised(const Eigen::Vector2d& xy, double z) { return {xy.x(), xy.y(), z}; }

}  // namespace

Eigen::AlignedBox2d rectangle(double x0, double y0, double x1, double y1) {
  return {Eigen::Vector2d(std::min(x0, x1), std::min(y0, y1)),
          Eigen::Vector2d(std::max(x0, x1), std::max(y0, y1))};
}

Spot SiteBuilder::placed(const Spot& planned) {
  if (!isMoved()) return planned;
  Spot at = planned;
  const double way_m = moves_.uniform(0.15, 0.5) * (moves_.chance(0.5) ? 1.0 : -1.0);
  at.position += way_m * leftOf(direction(planned.yaw));
  at.yaw += 0.15 * moves_.normal();
  return at;
}

void SiteBuilder::quad(const std::array<Eigen::Vector3d, 4>& corners, const Eigen::Vector3d& right,
                       const Eigen::Vector3d& down, Material material) {
  const double size = pictureSize(material);
  // Pictured by place, so that neighbours fit together.
  const auto vertex = [&](const Eigen::Vector3d& at) {
    return MeshVertex{
        at.cast<float>(),
        {static_cast<float>(at.dot(right) / size), static_cast<float>(at.dot(down) / size)}};
  };
  Mesh& mesh = site_.surfaces[material];
  mesh.addTriangle(vertex(corners[0]), vertex(corners[1]), vertex(corners[2]));
  mesh.addTriangle(vertex(corners[0]), vertex(corners[2]), vertex(corners[3]));
}

void SiteBuilder::ornament(const BoxShape& shape, Material material) {
  const Eigen::Vector2d ex = 0.5 * shape.size.x() * direction(shape.yaw);
  const Eigen::Vector2d ey = 0.5 * shape.size.y() * leftOf(direction(shape.yaw));
  const std::array<Eigen::Vector2d, 4> corners = {shape.centre + ex + ey, shape.centre - ex + ey,
                                                  shape.centre - ex - ey, shape.centre + ex - ey};
  const double low = shape.base_m, high = shape.base_m + shape.size.z();
  const Eigen::Vector3d down(0, 0, -1);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
    quad({raised(a, high), raised(b, high), raised(b, low), raised(a, low)},
         raised((b - a).normalized(), 0.0), down, material);
  }
  const Eigen::Vector3d east(1, 0, 0), south(0, -1, 0);
  quad({raised(corners[0], high), raised(corners[3], high), raised(corners[2], high),
        raised(corners[1], high)},
       east, south, material);
  if (low > 0.05) {
    quad({raised(corners[0], low), raised(corners[1], low), raised(corners[2], low),
          raised(corners[3], low)},
         east, south, material);
  }
}

void SiteBuilder::box(const BoxShape& shape, Material material) {
  ornament(shape, material);
  if (shape.base_m < kBlocksTo && shape.base_m + shape.size.z() > kBlocksFrom) {
    block({shape.centre, shape.size.head<2>(), shape.yaw});
  }
}

void SiteBuilder::part(const Spot& origin, const Eigen::Vector2d& at, const Eigen::Vector3d& size,
                       double base_m, Material material) {
  const Eigen::Vector2d ex = direction(origin.yaw);
  box({origin.position + at.x() * ex + at.y() * leftOf(ex), origin.yaw, size, base_m}, material);
}

void SiteBuilder::floor(const Eigen::AlignedBox2d& area, double height_m, Material material,
                        const std::vector<Eigen::AlignedBox2d>& holes) {
  std::set<double> xs{area.min().x(), area.max().x()}, ys{area.min().y(), area.max().y()};
  for (const auto& hole : holes) {
    const Eigen::AlignedBox2d cut = hole.intersection(area);
    if (cut.isEmpty()) continue;
    xs.insert({cut.min().x(), cut.max().x()});
    ys.insert({cut.min().y(), cut.max().y()});
  }
  for (auto x = xs.begin(); std::next(x) != xs.end(); ++x) {
    for (auto y = ys.begin(); std::next(y) != ys.end(); ++y) {
      const double x0 = *x, x1 = *std::next(x), y0 = *y, y1 = *std::next(y);
      const Eigen::Vector2d middle(0.5 * (x0 + x1), 0.5 * (y0 + y1));
      if (std::any_of(holes.begin(), holes.end(),
                      [&](const auto& hole) { return hole.contains(middle); })) {
        continue;
      }
      quad({Eigen::Vector3d(x0, y1, height_m),
            {x1, y1, height_m},
            {x1, y0, height_m},
            {x0, y0, height_m}},
           {1, 0, 0}, {0, -1, 0}, material);
    }
  }
}

void SiteBuilder::slope(const std::vector<Eigen::Vector3d>& outline, Material material) {
  const double size = pictureSize(material);
  const auto vertex = [&](const Eigen::Vector3d& at) {
    return MeshVertex{at.cast<float>(),
                      Eigen::Vector2d(at.x(), -at.y()).cast<float>() / static_cast<float>(size)};
  };
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    site_.ground.push_back({outline[0], outline[i], outline[i + 1]});
    site_.surfaces[material].addTriangle(vertex(outline[0]), vertex(outline[i]),
                                         vertex(outline[i + 1]));
  }
}

void SiteBuilder::ceiling(const Eigen::AlignedBox2d& area, double height_m, Material material) {
  floor(area, height_m, material);
}

void SiteBuilder::wallPart(const Eigen::Vector2d& from, const Eigen::Vector2d& along, double begin,
                           double end, double bottom, double top, Material material) {
  if (end - begin < 0.01 || top - bottom < 0.01) return;
  const double yaw = std::atan2(along.y(), along.x());
  const Eigen::Vector2d centre = from + 0.5 * (begin + end) * along;
  box({centre, yaw, {end - begin, kWallThickness, top - bottom}, bottom}, material);
  if (bottom == 0.0 && material != Material::kSheetMetal) {
    ornament({centre, yaw, {end - begin, kWallThickness + 0.024, 0.07}, 0.0}, Material::kDarkWood);
  }
}

void SiteBuilder::wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double height_m,
                       Material material, const std::vector<Opening>& openings) {
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  const double yaw = std::atan2(along.y(), along.x());
  double done = -0.5 * kWallThickness;  // walls overlap at corners
  for (const Opening& opening : openings) {
    const double begin = opening.at_m - 0.5 * opening.width_m;
    const double end = opening.at_m + 0.5 * opening.width_m;
    wallPart(from, along, done, begin, 0.0, height_m, material);
    wallPart(from, along, begin, end, 0.0, opening.bottom_m, material);
    wallPart(from, along, begin, end, opening.top_m, height_m, material);
    const bool window = opening.bottom_m > 0.0;
    const Material frame = window ? Material::kWhitePaint : Material::kDarkWood;
    const double up = opening.top_m - opening.bottom_m;
    std::vector<double> posts = {begin + 0.03, end - 0.03};
    for (double s = begin + 1.0; window && s < end - 0.5; s += 1.0) posts.push_back(s);
    for (const double s : posts) {
      ornament({from + s * along, yaw, {0.06, kWallThickness + 0.04, up}, opening.bottom_m}, frame);
    }
    const Eigen::Vector2d middle = from + opening.at_m * along;
    ornament({middle, yaw, {opening.width_m, kWallThickness + 0.04, 0.06}, opening.top_m - 0.06},
             frame);
    if (window) {
      ornament({middle, yaw, {opening.width_m, kWallThickness + 0.16, 0.04}, opening.bottom_m},
               frame);
    }
    done = end;
  }
  wallPart(from, along, done, length + 0.5 * kWallThickness, 0.0, height_m, material);
}

void SiteBuilder::pit(const Eigen::AlignedBox2d& area, double depth_m, Material material) {
  const Eigen::Vector2d middle = area.center(), size = area.sizes();
  floor(area, -depth_m, material);
  const Eigen::Vector3d down(0, 0, -1);
  const std::array<Eigen::Vector2d, 4> corners = {
      area.min(), Eigen::Vector2d(area.max().x(), area.min().y()), area.max(),
      Eigen::Vector2d(area.min().x(), area.max().y())};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
    quad({raised(a, 0.0), raised(b, 0.0), raised(b, -depth_m), raised(a, -depth_m)},
         raised((b - a).normalized(), 0.0), down, material);
  }
  barEdge({middle, size, 0.0});
  site_.drops.push_back({{corners.begin(), corners.end()}, depth_m});
}

void SiteBuilder::stairsDown(const Eigen::AlignedBox2d& area, double depth_m,
                             bool towards_positive_x, Material material) {
  const int steps = std::max(2, static_cast<int>(std::lround(depth_m / 0.17)));
  const double tread = area.sizes().x() / steps, rise = depth_m / steps;
  for (int i = 1; i < steps; ++i) {
    const double x = towards_positive_x ? area.min().x() + (i - 0.5) * tread
                                        : area.max().x() - (i - 0.5) * tread;
    ornament({{x, area.center().y()}, 0.0, {tread, area.sizes().y(), depth_m - i * rise}, -depth_m},
             material);
    const double edge = towards_positive_x ? x + 0.5 * tread - 0.02 : x - 0.5 * tread + 0.02;
    ornament({{edge, area.center().y()}, 0.0, {0.04, area.sizes().y(), 0.005}, -i * rise},
             Material::kYellowPaint);
  }
}

void SiteBuilder::railing(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                          Material material) {
  const double length = (to - from).norm();
  const Eigen::Vector2d along = (to - from) / length;
  const double yaw = std::atan2(along.y(), along.x());
  const int posts = std::max(1, static_cast<int>(std::lround(length / 1.4)));
  for (int i = 0; i <= posts; ++i) {
    ornament({from + along * (length * i / posts), yaw, {0.05, 0.05, 1.0}, 0.0}, material);
  }
  for (const double height : {0.3, 0.62, 0.98}) {
    ornament({0.5 * (from + to), yaw, {length, 0.045, 0.05}, height}, material);
  }
  block({0.5 * (from + to), {length, 0.08}, yaw});
}

void SiteBuilder::threshold(const Eigen::Vector2d& centre, double yaw, double length_m,
                            double height_m) {
  constexpr double kWidth = 0.08;  // [m]
  ornament({centre, yaw, {kWidth, length_m, height_m}, 0.0}, Material::kSteel);
  site_.thresholds.push_back({{centre, {kWidth, length_m}, yaw}, height_m});
}

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
