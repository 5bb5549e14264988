#pragma once

#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mesh_projection.h"

namespace headway::sim {

/// What meshes look like each alone, as depth pictures.
///
/// One buffer serves one mesh after another, so that nothing is allocated for each.
class MeshDepth {
 public:
  static constexpr float kNothing = std::numeric_limits<float>::max();

  /// @param image  size of the pictures that the meshes are projected into
  explicit MeshDepth(const cv::Size& image) : buffer_(image, CV_32F) {}

  /// @param area  part of the image to draw, inside of it
  /// @return      32-bit, the area's size: depth of the mesh's front [m], kNothing beside the mesh;
  ///              valid until the next drawing
  [[nodiscard]] const cv::Mat& draw(const std::vector<ImageTriangle>& mesh, const cv::Rect& area);

 private:
  void drawTriangle(const ImageTriangle& corners, const cv::Rect& area);

  cv::Mat buffer_;
  cv::Mat picture_;  ///< the buffer's part for the mesh that is drawn
};

}  // namespace headway::sim
