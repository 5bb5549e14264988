#pragma once

#include <headway/render/pinhole_view.h>
#include <headway/slam/map_view.h>

#include <array>
#include <map>
#include <memory>
#include <utility>

namespace mrpt::opengl {
class CPointCloudColoured;
class CSetOfObjects;
}  // namespace mrpt::opengl

namespace headway::scene {

/// The landmarks as coloured points, cut into square cells so that a picture draws only those that
/// can be seen, and no more of them than it has room for: drawing costs about 0.4 us a point.
class LandmarkClouds {
 public:
  /// Builds the points of a still world, unless they are those of it already.
  void update(const std::shared_ptr<const slam::MapView>& still_world, double ground_z,
              float point_size);

  /// All points.
  void insertAll(mrpt::opengl::CSetOfObjects& out) const;

  /// The points of the cells that a view can see, thinned out where they would lie upon each other.
  void insertVisible(const render::PinholeView& view, mrpt::opengl::CSetOfObjects& out) const;

 private:
  struct Cell {
    Eigen::AlignedBox3d bounds;
    /// All points, one in three, one in nine, ...
    std::array<std::shared_ptr<mrpt::opengl::CPointCloudColoured>, 4> thinned;
  };

  std::shared_ptr<const slam::MapView> shown_world_;
  std::map<std::pair<int, int>, Cell> cells_;
};

}  // namespace headway::scene
