// SPDX-License-Identifier: BSD-3-Clause
// What is written and outlined over a picture: boxes, labels, legend, caption.
#pragma once

#include <headway/core/track.h>
#include <headway/render/pinhole_view.h>
#include <headway/scene/snapshot.h>

#include <array>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "canvas.h"

// Drawing on the finished picture: outlines and text, antialiased and in sizes of the picture.

namespace headway::scene {

/// The confirmed and coasting tracks.
[[nodiscard]] std::vector<const Track*> shownTracks(const std::vector<Track>& tracks);

/// Draws boxes, past paths and predictions over a camera image.
///
/// @param canvas  of the image, with the aspect ratio of `view`
/// @param scale   of the scene, see sceneScale()
void drawTracksOver(Canvas& canvas, const render::PinholeView& view,
                    const std::vector<Track>& tracks, double scale);

/// Draws landmarks as dots, as a substitute for a missing camera image.
void drawLandmarksOver(Canvas& canvas, const render::PinholeView& view,
                       const slam::MapView& static_map);

/// Whether the map hides a place [m, map frame].
using Hides = std::function<bool(const Eigen::Vector3d&)>;

/// Draws the edges of the shown tracks' boxes in class colours; thin while coasting and where the
/// map hides them.
///
/// @param hides  empty: nothing is hidden
void drawBoxes(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks,
               const Hides& hides = {});

/// Draws the edges of the true boxes.
void drawTrueBoxes(Canvas& canvas, const render::PinholeView& view,
                   const std::vector<Track>& objects);

/// Draws the camera's viewing frustum.
void drawFrustum(Canvas& canvas, const render::PinholeView& view, const StereoCamera& camera,
                 const Pose& T_map_robot, double scale);

/// Writes frame, elapsed time, speed and number of tracks in the top left corner; this and the
/// following return the place that they take [px].
cv::Rect drawCaption(Canvas& canvas, const SnapshotInput& input);

/// Draws a scale bar in the bottom right corner, for the `top` view.
///
/// @param metres_per_pixel  on the ground
cv::Rect drawScaleBar(Canvas& canvas, double metres_per_pixel);

/// Writes the grid spacing in the bottom right corner, for perspective views.
cv::Rect drawGridNote(Canvas& canvas, double spacing_m);

/// Draws the camera image with the tracks in the top right corner; no effect without an image.
cv::Rect drawInset(Canvas& canvas, const SnapshotInput& input);

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

/// Legend of colours and line styles. Classes remain in it once they occur, so that the legend of a
/// video does not change size from frame to frame.
class Legend {
 public:
  enum class Layout {
    kColumn,  ///< vertically in the bottom left corner
    kRow,     ///< horizontally at the bottom
  };
  /// @return the place that it takes [px]; empty without entries
  cv::Rect draw(Canvas& canvas, const SnapshotInput& input, Layout layout);

 private:
  struct Entry {
    std::string text;
    Colour colour;
    bool dashed = false;
  };
  [[nodiscard]] std::vector<Entry> entries(const SnapshotInput& input, Layout layout,
                                           const Palette& palette);
  static void drawEntry(Canvas& canvas, const Entry& entry, cv::Point left_middle);

  std::array<bool, kObjectClassCount> seen_{};
};

}  // namespace headway::scene
