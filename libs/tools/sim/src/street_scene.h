// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <set>
#include <vector>

#include "actor_layer.h"
#include "occlusion.h"
#include "scene.h"
#include "sky.h"
#include "textured_object.h"
#include "world.h"

namespace headway::sim {

/// MRPT's scene of a world and its actors: surfaces by stretch, and one object each for what
/// has a common picture.
class StreetScene : public Scene {
 public:
  /// @param camera  left camera without distortion; the right one sees as far
  StreetScene(const StereoCamera& camera, World& world);

  void arrange(const Pose& T_world_robot, const Pose& T_left_right,
               const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) override;

 private:
  using ObjectPtr = TexturedObject::Ptr;

  /// A surface with a picture of its own.
  struct Piece {
    ObjectPtr object;
    std::vector<Eigen::Vector3f> around;  ///< points whose hull it is in, from its anchor
    std::optional<Block> block;
  };

  /// A tree or the like.
  struct Item {
    Mesh mesh;  ///< from the shared anchor
    std::vector<Eigen::Vector3f> around;
  };

  ObjectPtr add(const cv::Mat& picture);
  /// Hides all surfaces, and gives up those out of view where textures grow scarce.
  void removeHidden(const std::vector<StretchKey>& visible);
  /// Removes what houses hide in both images.
  void hideBehindHouses(const std::vector<StretchKey>& visible, const Eigen::Vector3d& origin,
                        const Pose& T_left_right);
  [[nodiscard]] bool shows(const std::vector<Eigen::Vector3f>& around,
                           const Eigen::Vector3d& offset) const;
  /// The triangles that show.
  [[nodiscard]] Mesh shown(const Mesh& mesh, const Eigen::Vector3d& offset) const;
  void showStretches(const std::vector<StretchKey>& visible);
  void placeStill(const Eigen::Vector3d& origin);
  void rebuildShared(const std::vector<StretchKey>& visible);
  void placeAll(const Eigen::Vector3d& origin);

  StereoCamera camera_;
  World& world_;
  std::map<StretchKey, std::vector<Piece>> surfaces_;
  std::vector<Occlusion> occlusions_;  ///< by houses, in the left and in the right image
  std::set<StretchKey> shown_;
  ObjectPtr sky_, plain_, verges_, furniture_;
  std::optional<ActorLayer> actors_;
  Eigen::Vector3d shared_anchor_ = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector2i> plain_cell_;
  Eigen::Vector3d plain_anchor_ = Eigen::Vector3d::Zero();
  std::vector<Item> items_;                       ///< furniture of the stretches in view
  std::optional<std::vector<bool>> items_shown_;  ///< which of them are in furniture_
  Mesh verges_mesh_, plain_mesh_;                 ///< whole
  const Mesh sky_mesh_ = skyMesh(kSkyRadius);
};

}  // namespace headway::sim
