// SPDX-License-Identifier: BSD-3-Clause
// Annotated pictures of a map.
#include <headway/map/map_export.h>
#include <headway/plot/colours.h>
#include <headway/scene/snapshot.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "canvas.h"
#include "map_picture.h"
#include "overlay.h"
#include "view.h"
#include "world_scene.h"

namespace headway::scene {
namespace {

/// The camera image with its overlays, fitted into the picture.
cv::Mat drawThroughCamera(const SnapshotOptions& options, const SnapshotInput& input,
                          Legend& legend) {
  const Palette& palette = paletteOf(options.theme);
  cv::Mat picture(options.height, options.width, CV_8UC3, plot::bgr(palette.backdrop.ground));
  Canvas canvas(picture, palette);
  if (input.camera == nullptr) {
    canvas.text("no camera: the poses were recorded", {canvas.px(18), canvas.size().height / 2},
                14.0, palette.text);
    return picture;
  }
  const StereoCamera& camera = *input.camera;
  const cv::Rect rect = fittedInto({camera.width, camera.height}, picture.size());
  const auto view = cameraView(camera, input.T_map_robot, rect.size());
  cv::Mat part = picture(rect);
  Canvas image(part, canvas);
  if (input.image.empty()) {
    drawLandmarksOver(image, view, *input.map.staticMap());
  } else {
    canvas.image(input.image, rect);
  }
  const auto& tracks = input.map.movingObjects().tracks();
  drawTracksOver(image, view, tracks, sceneScale(input));
  drawTrueBoxes(image, view, input.true_objects);
  const cv::Rect caption = drawCaption(canvas, input);
  const cv::Rect colours = legend.draw(canvas, input, Legend::Layout::kRow);
  drawLabels(image, view, tracks, sceneScale(input), {caption - rect.tl(), colours - rect.tl()});
  return picture;
}

}  // namespace

std::optional<View> viewFrom(std::string_view name) {
  if (name == "follow") return View::kFollow;
  if (name == "top") return View::kTop;
  if (name == "orbit") return View::kOrbit;
  if (name == "camera") return View::kCamera;
  return std::nullopt;
}

std::optional<Theme> themeFrom(std::string_view name) {
  if (name == "dark") return Theme::kDark;
  if (name == "light") return Theme::kLight;
  return std::nullopt;
}

class SnapshotRenderer::Implementation {
 public:
  explicit Implementation(const SnapshotOptions& options) : options_(options), map_(options) {}

  cv::Mat draw(const SnapshotInput& input) {
    if (options_.view == View::kCamera) return drawThroughCamera(options_, input, legend_);
    const double ground_z = groundHeight(input);
    const double scale = sceneScale(input);
    const auto view = externalView(options_, input, ground_z);
    const auto& tracks = input.map.movingObjects().tracks();
    cv::Mat picture = map_.draw(input, view, ground_z);
    Canvas canvas(picture, paletteOf(options_.theme));
    drawBoxes(canvas, view, tracks,
              [&](const Eigen::Vector3d& place) { return map_.hides(place); });
    drawTrueBoxes(canvas, view, input.true_objects);
    if (input.camera != nullptr) drawFrustum(canvas, view, *input.camera, input.T_map_robot, scale);
    std::vector<cv::Rect> panels{drawInset(canvas, input), drawCaption(canvas, input),
                                 legend_.draw(canvas, input, Legend::Layout::kColumn)};
    if (options_.view == View::kTop) {
      const double height = view.T_map_camera.translation().z() - ground_z;
      panels.push_back(drawScaleBar(canvas, height / view.fx));
    } else {
      panels.push_back(drawGridNote(canvas, gridSpacing(scale)));
    }
    drawLabels(canvas, view, tracks, scale, panels);
    return picture;
  }

 private:
  SnapshotOptions options_;
  MapPicture map_;
  Legend legend_;
};

SnapshotRenderer::SnapshotRenderer(const SnapshotOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}
SnapshotRenderer::~SnapshotRenderer() = default;
SnapshotRenderer::SnapshotRenderer(SnapshotRenderer&&) noexcept = default;
SnapshotRenderer& SnapshotRenderer::operator=(SnapshotRenderer&&) noexcept = default;

cv::Mat SnapshotRenderer::draw(const SnapshotInput& input) { return implementation_->draw(input); }

void saveScene(const std::string& path, const SnapshotInput& input,
               const SnapshotOptions& options) {
  auto scene = buildScene(input, options, groundHeight(input));
  map::writeObject(path, scene);
}

}  // namespace headway::scene
