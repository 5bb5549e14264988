// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/object_file.h>
#include <headway/plot/colours.h>
#include <headway/scene/snapshot.h>

#include <cmath>

#include "canvas.h"
#include "legend.h"
#include "overlay.h"
#include "view.h"
#include "world_scene.h"

namespace headway::scene {
namespace {

cv::Mat emptyPicture(const SnapshotOptions& options) {
  return cv::Mat(options.height, options.width, CV_8UC3, plot::bgr(kBackgroundColour));
}

/// The camera image with its overlays, fitted into the picture.
cv::Mat drawThroughCamera(const SnapshotOptions& options, const SnapshotInput& input,
                          Legend& legend) {
  cv::Mat picture = emptyPicture(options);
  Canvas canvas(picture);
  if (input.camera == nullptr) {
    canvas.text("no camera: the poses were recorded", {canvas.px(18), canvas.size().height / 2},
                14.0, kTextColour);
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
  drawTracksOver(image, view, input.map.movingObjects().tracks(), sceneScale(input));
  drawTrueBoxes(image, view, input.true_objects);
  drawLabels(image, view, input.map.movingObjects().tracks(), sceneScale(input));
  drawCaption(canvas, input);
  legend.draw(canvas, input, Legend::Layout::kRow);
  return picture;
}

/// Width of a landmark's dot in the rendered picture, before it is reduced [px].
float renderedDot(const SnapshotOptions& options) {
  return static_cast<float>(landmarkWidth({options.width, options.height}) * options.supersampling);
}

}  // namespace

std::optional<View> viewFrom(std::string_view name) {
  if (name == "follow") return View::kFollow;
  if (name == "top") return View::kTop;
  if (name == "orbit") return View::kOrbit;
  if (name == "camera") return View::kCamera;
  return std::nullopt;
}

class SnapshotRenderer::Implementation {
 public:
  explicit Implementation(const SnapshotOptions& options)
      : options_(options), world_(SceneUse::kPicture, renderedDot(options)) {
    if (options.view == View::kCamera) return;
    renderer_.emplace(options.width, options.height, options.supersampling);
  }

  cv::Mat draw(const SnapshotInput& input) {
    if (options_.view == View::kCamera) return drawThroughCamera(options_, input, legend_);
    const double ground_z = groundHeight(input);
    const double scale = sceneScale(input);
    const auto view = externalView(options_, input, ground_z);
    cv::Mat picture = renderer_->draw(world_.build(input, ground_z, &view), view);
    Canvas canvas(picture);
    drawBoxes(canvas, view, input.map.movingObjects().tracks());
    drawTrueBoxes(canvas, view, input.true_objects);
    if (input.camera != nullptr) drawFrustum(canvas, view, *input.camera, input.T_map_robot, scale);
    drawLabels(canvas, view, input.map.movingObjects().tracks(), scale);
    drawInset(canvas, input);
    drawCaption(canvas, input);
    legend_.draw(canvas, input, Legend::Layout::kColumn);
    if (options_.view == View::kTop) {
      const double height = view.T_map_camera.translation().z() - ground_z;
      drawScaleBar(canvas, height / view.fx);
    } else {
      drawGridNote(canvas, gridSpacing(scale));
    }
    return picture;
  }

 private:
  SnapshotOptions options_;
  WorldScene world_;
  Legend legend_;
  std::optional<render::OffscreenRenderer> renderer_;
};

SnapshotRenderer::SnapshotRenderer(const SnapshotOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}
SnapshotRenderer::~SnapshotRenderer() = default;
SnapshotRenderer::SnapshotRenderer(SnapshotRenderer&&) noexcept = default;
SnapshotRenderer& SnapshotRenderer::operator=(SnapshotRenderer&&) noexcept = default;

cv::Mat SnapshotRenderer::draw(const SnapshotInput& input) { return implementation_->draw(input); }

void saveScene(const std::string& path, const SnapshotInput& input) {
  WorldScene world(SceneUse::kFile, 2.f);
  auto scene = world.build(input, groundHeight(input));
  map::writeObject(path, scene);
}

}  // namespace headway::scene
