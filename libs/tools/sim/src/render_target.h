// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/mrpt_compat.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <opencv2/core/mat.hpp>
#include HEADWAY_MRPT_FRAMEBUFFER

namespace headway::sim {

/// The image of one camera, drawn off-screen.
///
/// Drawing and reading are apart, so that a second image can be set up while the first is drawn, and
/// pixels are read in the driver's own format. Needs an OpenGL context that is current, in one
/// thread, for as long as it lives.
class RenderTarget {
 public:
  /// @param width  a multiple of four
  RenderTarget(int width, int height);

  /// Begins to draw the scene as its main camera sees it; returns before that is done.
  void draw(const mrpt::opengl::COpenGLScene& scene);

  /// @return 8-bit BGR, the upper left part of what was drawn
  [[nodiscard]] cv::Mat picture(const cv::Size& kept);
  /// @param farthest  less than what is drawn at most [m]
  /// @return 32-bit, distance from the camera's plane [m]; 0 where nothing so near was drawn
  [[nodiscard]] cv::Mat depth(const cv::Size& kept, float farthest);

 private:
  cv::Mat read(unsigned format, unsigned type, int depth, const cv::Size& kept);

  MrptFramebuffer buffer_;
  cv::Mat pixels_, codes_;  ///< as read: colours, depths
  int width_;
  int height_;
  float near_ = 0.0F, far_ = 0.0F;  ///< what the depths drawn range over [m]
};

}  // namespace headway::sim
