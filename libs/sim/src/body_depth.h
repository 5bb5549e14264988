#pragma once

#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "body_projection.h"

namespace headway::sim {

/// What bodies look like each alone, as depth pictures.
///
/// One buffer serves one body after another, so that nothing is allocated for each.
class BodyDepth {
 public:
  static constexpr float kNothing = std::numeric_limits<float>::max();

  /// @param image  size of the pictures that the bodies are projected into
  explicit BodyDepth(const cv::Size& image) : buffer_(image, CV_32F) {}

  /// @param area  part of the image to draw, inside of it
  /// @return      32-bit, the area's size: depth of the body's front [m], kNothing beside the body;
  ///              valid until the next drawing
  [[nodiscard]] const cv::Mat& draw(const std::vector<ImageTriangle>& body, const cv::Rect& area);

 private:
  void drawTriangle(const ImageTriangle& corners, const cv::Rect& area);

  cv::Mat buffer_;
  cv::Mat picture_;  ///< the buffer's part for the body that is drawn
};

}  // namespace headway::sim
