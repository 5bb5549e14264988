// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>
#include <headway/render/pinhole_view.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "canvas.h"

namespace headway::scene {

/// Places of labels in a picture that overlap neither each other nor anything else that was
/// declared occupied.
///
///     LabelLayout layout(picture.size());
///     for (...) layout.occupy(outline);
///     const auto rect = layout.place(size, box, gap);
class LabelLayout {
 public:
  explicit LabelLayout(const cv::Size& picture) : occupied_(picture, CV_8U, cv::Scalar(0)) {}

  void occupy(const cv::Rect& rect);
  /// @param outline  convex hull of an object [px]
  void occupy(const std::vector<cv::Point>& outline);

  /// Occupies and returns the free place nearest to the middle of a box's upper edge: above it, or
  /// else beside or below; nullopt if all places near it are occupied.
  ///
  /// @param gap  to the box and between labels [px]
  [[nodiscard]] std::optional<cv::Rect> place(const cv::Size& label, const cv::Rect& box, int gap);

 private:
  [[nodiscard]] bool isFree(const cv::Rect& rect) const;

  cv::Mat occupied_;
};

/// Writes class, id and speed beside each box, nearest first. Labels never overlap each other, a
/// box or `panels`; those without a free place are omitted. Labels that are not directly above
/// their box are joined to it by a line.
///
/// @param scale   of the scene, see sceneScale()
/// @param panels  other text of the picture [px]
/// @return        places of the labels [px]
std::vector<cv::Rect> drawLabels(Canvas& canvas, const render::PinholeView& view,
                                 const std::vector<Track>& tracks, double scale,
                                 const std::vector<cv::Rect>& panels = {});

}  // namespace headway::scene
