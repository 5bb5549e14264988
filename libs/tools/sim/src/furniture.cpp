// SPDX-License-Identifier: BSD-3-Clause
// Trees, lamps, signs and the like along streets and paths.
#include "furniture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "grain.h"

namespace headway::sim {
namespace {

using Eigen::Vector3f;

constexpr int kFurnitureAtlas = 1024;  // [px] square
constexpr auto kFullTurn = static_cast<float>(2.0 * M_PI);
const cv::Rect kLeaves{0, 0, 1024, 512};  // four greens side by side
const cv::Rect kBark{0, 512, 128, 256};
const cv::Rect kMetal{128, 512, 128, 256};
const cv::Rect kHedge{256, 512, 512, 128};
const cv::Rect kStone{256, 640, 512, 128};
const cv::Rect kSigns{0, 768, 1024, 128};   // eight signs
const cv::Rect kThings{0, 896, 1024, 128};  // eight surfaces of small things

UvRect inAtlas(const cv::Rect& rect) {
  const auto ratio = [](int pixels) { return static_cast<float>(pixels) / kFurnitureAtlas; };
  return {ratio(rect.x + 2), ratio(rect.y + 2), ratio(rect.x + rect.width - 2),
          ratio(rect.y + rect.height - 2)};
}

UvRect eighth(const cv::Rect& strip, int which) {
  return inAtlas({strip.x + which * 128, strip.y, 128, 128});
}

void drawLeaves(cv::Mat part, const cv::Scalar& green, Random& random) {
  part.setTo(green * 0.45);
  for (int i = 0; i < 2600; ++i) {
    const cv::Point at = drawPoint(part.cols, part.rows, random);
    const double level = random.uniform(0.5, 1.35) * (1.15 - 0.5 * at.y / part.rows);
    const double angle = random.uniform(0, 180);
    cv::ellipse(part, at, {2 + random.below(5), 1 + random.below(4)}, angle, 0, 360, green * level,
                cv::FILLED, cv::LINE_AA);
  }
}

void drawSigns(cv::Mat strip, Random& random) {
  for (int i = 0; i < 8; ++i) {
    cv::Mat sign = strip(cv::Rect(i * 128, 0, 128, 128));
    const cv::Scalar border = i % 2 == 0 ? cv::Scalar(40, 40, 200) : cv::Scalar(180, 90, 30);
    sign.setTo(border);
    cv::rectangle(sign, {16, 16}, {111, 111}, i % 2 == 0 ? cv::Scalar::all(235) : border,
                  cv::FILLED);
    const std::string text = std::to_string(10 + random.below(90));
    cv::putText(sign, text, {24, 82}, cv::FONT_HERSHEY_DUPLEX, 1.8,
                i % 2 == 0 ? cv::Scalar::all(20) : cv::Scalar::all(235), 4, cv::LINE_AA);
  }
}

void drawThings(cv::Mat strip, Random& random) {
  for (int i = 0; i < 8; ++i) {
    cv::Mat thing = strip(cv::Rect(i * 128, 0, 128, 128));
    thing.setTo(drawColour(20, 190, random));
    for (int k = 0; k < 14; ++k) {
      const cv::Point a = drawPoint(128, 128, random);
      const int thickness = random.chance(0.5) ? cv::FILLED : 2;
      const cv::Scalar colour = drawColour(20, 220, random);
      const cv::Point size = cv::Point(6, 6) + drawPoint(50, 40, random);
      cv::rectangle(thing, a, a + size, colour, thickness);
    }
  }
}

/// A closed tube with `corners` sides, from radius to radius.
void addTube(Mesh& mesh, const Vector3f& from, const Vector3f& to, float radius_from,
             float radius_to, const UvRect& uv, int corners) {
  const Vector3f axis = (to - from).normalized();
  const Vector3f helper = std::abs(axis.z()) > 0.9F ? Vector3f::UnitX() : Vector3f::UnitZ();
  const Vector3f e1 = axis.cross(helper).normalized(), e2 = axis.cross(e1);
  const auto at = [&](const Vector3f& end, float radius, int i) {
    const float a = kFullTurn * static_cast<float>(i) / static_cast<float>(corners);
    return Vector3f(end + radius * (std::cos(a) * e1 + std::sin(a) * e2));
  };
  for (int i = 0; i < corners; ++i) {
    const float u0 = static_cast<float>(i) / static_cast<float>(corners);
    const float u1 = static_cast<float>(i + 1) / static_cast<float>(corners);
    mesh.addQuad(at(to, radius_to, i), at(to, radius_to, i + 1), at(from, radius_from, i + 1),
                 at(from, radius_from, i), uv.part(u0, 0, u1, 1));
  }
  for (int i = 1; i + 1 < corners; ++i) {  // its ends
    const Eigen::Vector2f top = uv.at(0.5F, 0.02F), foot = uv.at(0.5F, 0.98F);
    mesh.addTriangle({at(to, radius_to, 0), top}, {at(to, radius_to, i + 1), top},
                     {at(to, radius_to, i), top});
    mesh.addTriangle({at(from, radius_from, 0), foot}, {at(from, radius_from, i), foot},
                     {at(from, radius_from, i + 1), foot});
  }
}

/// One mass of leaves: a rough ball.
void addLeafBall(Mesh& mesh, const Vector3f& centre, const Vector3f& radii, int green,
                 Random& random) {
  constexpr int kSpans = 9, kRings = 6;
  std::array<std::array<Vector3f, kSpans + 1>, kRings + 1> points;
  for (int r = 0; r <= kRings; ++r) {
    for (int s = 0; s < kSpans; ++s) {
      const float polar = 0.5F * kFullTurn * static_cast<float>(r) / kRings;
      const float around = kFullTurn * static_cast<float>(s) / kSpans;
      const auto rough = static_cast<float>(random.uniform(0.78, 1.12));
      const Vector3f unit(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                          std::cos(polar));
      points[static_cast<std::size_t>(r)][static_cast<std::size_t>(s)] =
          centre + rough * unit.cwiseProduct(radii);
    }
    auto& ring = points[static_cast<std::size_t>(r)];
    if (r == 0 || r == kRings) ring.fill(ring[0]);
    ring[kSpans] = ring[0];
  }
  const UvRect uv = inAtlas({green * 256, 0, 256, 512});
  for (std::size_t r = 0; r < kRings; ++r) {
    for (std::size_t s = 0; s < kSpans; ++s) {
      mesh.addQuad(
          points[r][s], points[r][s + 1], points[r + 1][s + 1], points[r + 1][s],
          uv.part(static_cast<float>(s % 3) / 3.0F, static_cast<float>(r) / kRings,
                  static_cast<float>(s % 3 + 1) / 3.0F, static_cast<float>(r + 1) / kRings));
    }
  }
}

/// `up` above a place that scatters by `sigma` in x and y.
Vector3f drawOffset(double sigma, float up, Random& random) {
  const auto y = static_cast<float>(sigma * random.normal());
  const auto x = static_cast<float>(sigma * random.normal());
  return {x, y, up};
}

/// Upright box, turned by yaw.
void addBox(Mesh& mesh, const Vector3f& foot, float yaw, const Vector3f& size, const UvRect& uv) {
  const Vector3f ex = 0.5F * size.x() * Vector3f(std::cos(yaw), std::sin(yaw), 0);
  const Vector3f ey = 0.5F * size.y() * Vector3f(-std::sin(yaw), std::cos(yaw), 0);
  const Vector3f up(0, 0, size.z());
  const std::array<Vector3f, 4> corners = {foot + ex + ey, foot - ex + ey, foot - ex - ey,
                                           foot + ex - ey};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3f &a = corners[i], &b = corners[(i + 1) % 4];
    mesh.addQuad(a + up, b + up, b, a, uv);
  }
  Mesh lid;
  lid.addQuad(corners[0] + up, corners[1] + up, corners[2] + up, corners[3] + up, uv);
  mesh.append(turnedOver(lid));
  mesh.addQuad(corners[0], corners[1], corners[2], corners[3], uv);
}

}  // namespace

cv::Mat drawFurnitureAtlas(const Grain& grain, Random& random) {
  cv::Mat atlas(kFurnitureAtlas, kFurnitureAtlas, CV_8UC3, cv::Scalar::all(80));
  const std::array<cv::Scalar, 4> greens = {cv::Scalar(45, 110, 80), cv::Scalar(40, 130, 95),
                                            cv::Scalar(60, 115, 70), cv::Scalar(35, 120, 130)};
  for (int i = 0; i < 4; ++i) {
    drawLeaves(atlas(cv::Rect(i * 256, 0, 256, 512)), greens[static_cast<std::size_t>(i)], random);
  }
  cv::Mat bark = atlas(kBark);
  bark.setTo(cv::Scalar(55, 70, 85));
  for (int i = 0; i < 160; ++i) {
    const cv::Point at = drawPoint(128, 256, random);
    const double level = random.uniform(0.5, 1.4);
    const cv::Point along = cv::Point(-2, 8) + drawPoint(5, 30, random);
    cv::line(bark, at, at + along, cv::Scalar(55, 70, 85) * level, 2);
  }
  cv::Mat metal = atlas(kMetal);
  for (int x = 0; x < 128; ++x) {
    metal.col(x).setTo(cv::Scalar::all(80 + 45 * std::sin(x * 2.0 * M_PI / 128.0)));
  }
  cv::rectangle(metal, {20, 150}, {100, 200}, cv::Scalar(90, 190, 220), cv::FILLED);  // a notice
  drawLeaves(atlas(kHedge), cv::Scalar(40, 95, 60), random);
  cv::Mat stone = atlas(kStone);
  for (int y = 0; y < 128; y += 16) {
    for (int x = -((y / 16) % 2) * 16; x < 512; x += 32) {
      cv::rectangle(stone, {x, y}, {x + 30, y + 14},
                    cv::Scalar(120, 130, 145) * random.uniform(0.7, 1.2), cv::FILLED);
    }
  }
  drawSigns(atlas(kSigns), random);
  drawThings(atlas(kThings), random);
  grain.roughen(atlas, 8.0, 5.0, random);
  return atlas;
}

void addTree(Mesh& mesh, const Vector3f& foot, Random& random) {
  const auto trunk = static_cast<float>(random.uniform(2.2, 3.2));
  const auto radius = static_cast<float>(random.uniform(0.12, 0.22));
  const Vector3f fork = foot + drawOffset(0.2, trunk, random);
  addTube(mesh, foot, fork, radius * 1.3F, radius, inAtlas(kBark), 7);
  const int green = random.below(4), masses = 4 + random.below(3);
  for (int i = 0; i < masses; ++i) {
    const auto r = static_cast<float>(random.uniform(0.9, 1.7));
    const auto up = 0.5F + static_cast<float>(random.uniform(0.0, 2.4));
    const Vector3f offset = drawOffset(0.8, up, random);
    const Vector3f centre =
        fork + offset.cwiseMax(Vector3f(-1.3F, -1.3F, 0)).cwiseMin(Vector3f(1.3F, 1.3F, 3));
    addTube(mesh, fork, centre, radius * 0.6F, radius * 0.2F, inAtlas(kBark), 4);
    addLeafBall(mesh, centre, {r, r, r * 0.85F}, green, random);
  }
}

void addShrub(Mesh& mesh, const Vector3f& foot, float height, Random& random) {
  const int green = random.below(4);
  for (int i = 0; i < 4; ++i) {
    const auto ratio = static_cast<float>(random.uniform(0.25, 0.75));
    const Vector3f centre = foot + drawOffset(0.08, ratio * height, random);
    addTube(mesh, foot, centre, 0.012F, 0.01F, inAtlas(kBark), 4);
    addLeafBall(mesh, centre, {0.3F * height, 0.3F * height, 0.32F * height}, green, random);
  }
}

void addLamp(Mesh& mesh, const Vector3f& foot, float yaw, Random& random) {
  const auto height = static_cast<float>(random.uniform(5.5, 6.5));
  const Vector3f top = foot + Vector3f(0, 0, height);
  const Vector3f reach = top + Vector3f(1.4F * std::cos(yaw), 1.4F * std::sin(yaw), 0.25F);
  addTube(mesh, foot, foot + Vector3f(0, 0, 1.0F), 0.11F, 0.09F, inAtlas(kMetal), 6);
  addTube(mesh, foot + Vector3f(0, 0, 1.0F), top, 0.075F, 0.05F, inAtlas(kMetal), 6);
  addTube(mesh, top, reach, 0.045F, 0.04F, inAtlas(kMetal), 4);
  addBox(mesh, reach - Vector3f(0, 0, 0.12F), yaw, {0.6F, 0.25F, 0.14F}, inAtlas(kMetal));
}

void addSign(Mesh& mesh, const Vector3f& foot, float yaw, Random& random) {
  const auto height = static_cast<float>(random.uniform(2.3, 2.9));
  addTube(mesh, foot, foot + Vector3f(0, 0, height), 0.035F, 0.035F, inAtlas(kMetal), 5);
  const Vector3f left(-std::sin(yaw) * 0.35F, std::cos(yaw) * 0.35F, 0);
  const Vector3f top = foot + Vector3f(-0.04F * std::cos(yaw), -0.04F * std::sin(yaw), height);
  const Vector3f down(0, 0, -0.7F);
  mesh.addQuad(top + left, top - left, top - left + down, top + left + down,
               eighth(kSigns, random.below(8)));
  const Vector3f behind(0.02F * std::cos(yaw), 0.02F * std::sin(yaw), 0);
  Mesh back;
  back.addQuad(top + left + behind, top - left + behind, top - left + down + behind,
               top + left + down + behind, inAtlas(kMetal).part(0, 0, 1, 0.4F));
  mesh.append(turnedOver(back));
}

void addSmallThing(Mesh& mesh, const Vector3f& foot, float yaw, Random& random) {
  const UvRect uv = eighth(kThings, random.below(8));
  switch (random.below(4)) {
    case 0:
      addBox(mesh, foot, yaw, {0.55F, 0.6F, 1.05F}, uv);
      break;  // bin
    case 1:
      addTube(mesh, foot, foot + Vector3f(0, 0, 0.95F), 0.1F, 0.08F, uv, 7);
      break;
    case 2:
      addBox(mesh, foot, yaw, {1.1F, 0.4F, 1.3F}, uv);
      break;  // cabinet
    default:  // bench
      addBox(mesh, foot, yaw, {1.7F, 0.5F, 0.45F}, inAtlas(kBark));
      addBox(mesh, foot + 0.2F * Vector3f(-std::sin(yaw), std::cos(yaw), 0), yaw,
             {1.7F, 0.08F, 0.9F}, inAtlas(kBark));
  }
}

void addHedge(Mesh& mesh, const Vector3f& from, const Vector3f& to, Random& random) {
  const float length = (to - from).norm();
  if (length < 0.5F) return;
  const Vector3f middle = 0.5F * (from + to);
  const float yaw = std::atan2(to.y() - from.y(), to.x() - from.x());
  const bool stone = random.chance(0.4);
  const float part = std::min(1.0F, length / 8.0F);
  const auto start = static_cast<float>(random.uniform(0.0, 1.0 - part));
  addBox(mesh, middle, yaw,
         {length, stone ? 0.3F : 0.7F,
          static_cast<float>(stone ? random.uniform(0.9, 1.8) : random.uniform(1.0, 1.9))},
         inAtlas(stone ? kStone : kHedge).part(start, 0, start + part, 1));
}

void addFence(Mesh& mesh, const Vector3f& from, const Vector3f& to, Random& random) {
  const float length = (to - from).norm();
  const Vector3f along = (to - from) / length;
  const float yaw = std::atan2(along.y(), along.x());
  const bool pickets = random.chance(0.5);
  const auto height = static_cast<float>(random.uniform(0.9, 1.3));
  const float spacing = pickets ? 0.17F : 0.13F;
  const Vector3f bar = pickets ? Vector3f(0.09F, 0.02F, height) : Vector3f(0.025F, 0.025F, height);
  const UvRect uv = inAtlas(pickets ? kBark : kMetal);
  for (float s = 0.5F * spacing; s < length; s += spacing) {
    addBox(mesh, from + s * along, yaw, bar, uv.part(0, 0, 0.2F, 1));
  }
  for (const float up : {0.2F, 0.85F}) {
    addBox(mesh, 0.5F * (from + to) + Vector3f(0, 0, up * height), yaw, {length, 0.03F, 0.06F}, uv);
  }
}

}  // namespace headway::sim
