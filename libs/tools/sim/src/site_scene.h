// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "actor_layer.h"
#include "scene.h"
#include "site.h"

namespace headway::sim {

/// MRPT's scene of a site: one object for each material and orientation, built once.
class SiteScene : public Scene {
 public:
  /// The site must outlive the scene.
  SiteScene(const Site& site, const Grain& grain, std::uint64_t seed);

  void arrange(const Pose& T_world_robot, const Pose& T_left_right,
               const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) override;

 private:
  TexturedObject::Ptr add(const cv::Mat& picture, const Mesh& mesh);
  void addShaded(const cv::Mat& picture, const Mesh& mesh);
  /// Soft dark strips on the floor where something stands.
  [[nodiscard]] static Mesh contactShadows(const Site& site);

  std::vector<TexturedObject::Ptr> objects_;
  TexturedObject::Ptr sky_, shadows_;
  std::optional<ActorLayer> actors_;
};

}  // namespace headway::sim
