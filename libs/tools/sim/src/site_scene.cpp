// SPDX-License-Identifier: BSD-3-Clause
#include "site_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "furniture.h"
#include "ground_texture.h"
#include "mesh_projection.h"
#include "shadow.h"
#include "sky.h"

namespace headway::sim {
namespace {

enum SiteScenePurpose : std::uint64_t {
  kSiteSkySeed = 401,
  kSiteMaterialSeed,
  kSiteMeadowSeed,
  kSiteAtlasSeed,
  kSiteActorSeed
};

/// Which of three brightnesses a triangle has by the way it faces: floors, walls along y, the rest.
std::size_t shadeOf(const std::array<MeshVertex, 3>& triangle) {
  const Eigen::Vector3f normal = (triangle[1].position - triangle[0].position)
                                     .cross(triangle[2].position - triangle[0].position)
                                     .cwiseAbs();
  if (normal.z() > std::max(normal.x(), normal.y())) return 0;
  return normal.x() > normal.y() ? 1 : 2;
}

constexpr std::array<double, 3> kShades = {1.0, 0.92, 0.8};

/// The upright rectangle around a drop's outline.
Eigen::AlignedBox2d boundsOf(const Drop& drop) {
  Eigen::AlignedBox2d bounds;
  for (const Eigen::Vector2d& corner : drop.outline) bounds.extend(corner);
  return bounds;
}

/// A wide plain a little below the ground, with holes for what is deeper.
Mesh plain(const Site& site) {
  constexpr double kHeight = -0.25, kReach = 150.0, kTile = 30.0, kPicture = 16.0;  // [m]
  std::set<double> xs, ys;
  for (double d = -kReach; d <= kReach; d += kTile) {
    xs.insert(d);
    ys.insert(d);
  }
  for (const Drop& drop : site.drops) {
    const auto bounds = boundsOf(drop);
    xs.insert({bounds.min().x(), bounds.max().x()});
    ys.insert({bounds.min().y(), bounds.max().y()});
  }
  Mesh mesh;
  const auto vertex = [&](double x, double y) {
    return MeshVertex{Eigen::Vector3d(x, y, kHeight).cast<float>(),
                      Eigen::Vector2d(x / kPicture, y / kPicture).cast<float>()};
  };
  for (auto x = xs.begin(); std::next(x) != xs.end(); ++x) {
    for (auto y = ys.begin(); std::next(y) != ys.end(); ++y) {
      const double x1 = *std::next(x), y1 = *std::next(y);
      const Eigen::Vector2d middle(0.5 * (*x + x1), 0.5 * (*y + y1));
      if (std::any_of(site.drops.begin(), site.drops.end(),
                      [&](const Drop& drop) { return boundsOf(drop).contains(middle); })) {
        continue;
      }
      mesh.addTriangle(vertex(*x, y1), vertex(x1, y1), vertex(x1, *y));
      mesh.addTriangle(vertex(*x, y1), vertex(x1, *y), vertex(*x, *y));
    }
  }
  return mesh;
}

}  // namespace

SiteScene::SiteScene(const Site& site, const Grain& grain, std::uint64_t seed) {
  const auto random = [&](std::uint64_t purpose, std::uint64_t item = 0) {
    return Random(seedOf({seed, purpose, item}));
  };
  for (const auto& [material, mesh] : site.surfaces) {
    Random own = random(kSiteMaterialSeed, static_cast<std::uint64_t>(material));
    addShaded(drawMaterial(material, grain, own), mesh);
  }
  for (const PicturedMesh& facade : site.facades)
    objects_.push_back(add(facade.picture, facade.mesh));
  Random atlas = random(kSiteAtlasSeed), meadow = random(kSiteMeadowSeed),
         sky = random(kSiteSkySeed), people = random(kSiteActorSeed);
  if (!site.furniture.triangles.empty()) {
    objects_.push_back(add(drawFurnitureAtlas(grain, atlas), site.furniture));
  }
  objects_.push_back(add(drawMeadow(grain, meadow), plain(site)));
  sky_ = add(drawSky(sky), skyMesh(kSkyRadius));
  shadows_ = add(drawShadow(), contactShadows(site));
  actors_.emplace(scene_, grain, people);
  actors_->stackShadows();
  scene_.getViewport()->setViewportClipDistances(kNearPlane, kFarPlane);
}

TexturedObject::Ptr SiteScene::add(const cv::Mat& picture, const Mesh& mesh) {
  auto object = std::make_shared<TexturedObject>(picture);
  object->setMesh(mesh);
  scene_.insert(object);
  return object;
}

void SiteScene::addShaded(const cv::Mat& picture, const Mesh& mesh) {
  std::array<Mesh, kShades.size()> parts;
  for (const auto& triangle : mesh.triangles)
    parts[shadeOf(triangle)].triangles.push_back(triangle);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].triangles.empty()) continue;
    cv::Mat shaded;
    picture.convertTo(shaded, -1, kShades[i]);
    objects_.push_back(add(shaded, parts[i]));
  }
}

Mesh SiteScene::contactShadows(const Site& site) {
  // Each a hair above the one before: at the same height they would show through each other.
  constexpr float kLowest = 0.004F, kStep = 1e-5F;
  float height = kLowest;
  constexpr double kSpread = 0.16;  // [m]
  Mesh mesh;
  for (const Footprint& footprint : site.obstacles) {
    const Eigen::Vector2d along(std::cos(footprint.yaw), std::sin(footprint.yaw));
    const Eigen::Vector2f ex = ((0.5 * footprint.size.x() + kSpread) * along).cast<float>();
    const Eigen::Vector2f ey =
        ((0.5 * footprint.size.y() + kSpread) * Eigen::Vector2d(-along.y(), along.x()))
            .cast<float>();
    const Eigen::Vector2f middle = footprint.centre.cast<float>();
    const auto at = [&](float x, float y) {
      const Eigen::Vector2f corner = middle + x * ex + y * ey;
      return Eigen::Vector3f(corner.x(), corner.y(), height);
    };
    mesh.addQuad(at(1, 1), at(-1, 1), at(-1, -1), at(1, -1), UvRect{});
    height += kStep;
  }
  return mesh;
}

void SiteScene::arrange(const Pose& T_world_robot, const Pose& /*T_left_right*/,
                        const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) {
  const Eigen::Vector3d origin = T_world_robot.translation();
  T_origin_robot_ = T_world_robot;
  T_origin_robot_.translation().setZero();
  const Eigen::Vector3d forward = T_origin_robot_.linear().col(0);
  actors_->show(actors, meshes, origin, [](const Mesh&) { return true; });
  double order = 5000.0;
  for (const auto& object : objects_) object->placeAt(-origin, forward, order -= 1.0);
  sky_->placeAt(Eigen::Vector3d::Zero(), forward, 3800.0);
  shadows_->placeAt(-origin, forward, 1.0);
  actors_->place(forward);
}

}  // namespace headway::sim
