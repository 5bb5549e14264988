// SPDX-License-Identifier: BSD-3-Clause
#include "actor_layer.h"

#include <algorithm>

#include "actor_atlas.h"
#include "shadow.h"

namespace headway::sim {

ActorLayer::ActorLayer(mrpt::opengl::COpenGLScene& scene, const Grain& grain, Random& random) {
  const cv::Mat atlas = drawActorAtlas(grain, random);
  vehicles_ = std::make_shared<TexturedObject>(atlas);
  vehicles_->hideBacks();
  people_ = std::make_shared<TexturedObject>(atlas);
  shadows_ = std::make_shared<TexturedObject>(drawShadow());
  for (const auto& object : {vehicles_, people_, shadows_}) scene.insert(object);
}

void ActorLayer::show(const std::vector<Actor>& actors, const std::vector<Mesh>& meshes,
                      const Eigen::Vector3d& origin,
                      const std::function<bool(const Mesh&)>& shows) {
  std::vector<std::pair<double, std::size_t>> near_first;
  for (std::size_t k = 0; k < actors.size(); ++k) {
    near_first.emplace_back((actors[k].position - origin).norm(), k);
  }
  std::sort(near_first.begin(), near_first.end());
  std::vector<const Mesh*> vehicles, people;
  for (const auto& [distance, k] : near_first) {
    if (!shows(meshes[k])) continue;
    (isClosed(actors[k].kind) ? vehicles : people).push_back(&meshes[k]);
  }
  Mesh shadows;
  Eigen::Vector3d below = origin;
  for (const Actor& actor : actors) {
    shadows.append(shadowMesh(actor, below));
    below.z() -= shadow_step_m_;
  }
  vehicles_->setMeshes(vehicles);
  people_->setMeshes(people);
  shadows_->setMesh(shadows);
}

void ActorLayer::place(const Eigen::Vector3d& forward) {
  vehicles_->placeAt(Eigen::Vector3d::Zero(), forward, 6000.0);
  people_->placeAt(Eigen::Vector3d::Zero(), forward, 5900.0);
  shadows_->placeAt(Eigen::Vector3d::Zero(), forward, 0.0);
}

}  // namespace headway::sim
