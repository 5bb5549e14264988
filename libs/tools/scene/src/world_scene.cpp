// SPDX-License-Identifier: BSD-3-Clause
// A map as a 3D scene of MRPT.
#include "world_scene.h"

#include <headway/core/mrpt_pose.h>
#include <headway/core/object_class.h>
#include <headway/map/track_geometry.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTriangles.h>
#include <mrpt/opengl/CTexturedPlane.h>

#include <algorithm>
#include <cmath>

#include "canvas.h"
#include "map_picture.h"
#include "view.h"

namespace headway::scene {
namespace {

using mrpt::opengl::CSetOfLines;
using mrpt::opengl::CSetOfTriangles;

/// The camera of a scene's file, at scale 1.
struct SceneCamera {
  double ahead_m = 6.0;      ///< of the robot, what it looks at
  double distance_m = 45.0;  ///< from that
  double aside_deg = 25.0;
  float elevation_deg = 30.F;
};
constexpr SceneCamera kCamera{};

std::shared_ptr<mrpt::opengl::CGridPlaneXY> makeGrid(const Eigen::Vector3d& centre, double ground_z,
                                                     double spacing, const Palette& palette) {
  const double extent = kGridExtentLines * spacing;
  const double x = spacing * std::round(centre.x() / spacing);
  const double y = spacing * std::round(centre.y() / spacing);
  auto grid = mrpt::opengl::CGridPlaneXY::Create(
      static_cast<float>(x - extent), static_cast<float>(x + extent),
      static_cast<float>(y - extent), static_cast<float>(y + extent), static_cast<float>(ground_z),
      static_cast<float>(spacing));
  grid->setName("ground_grid");
  grid->setColor_u8(palette.grid.red, palette.grid.green, palette.grid.blue);
  setDrawOrder(DrawOrder::kGrid, *grid);
  return grid;
}

/// The path projected to the ground, without points closer than `spacing`.
std::vector<Eigen::Vector3d> pathOnGround(const std::vector<Stamped<Pose>>& path, double drop,
                                          double spacing) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& pose : path) {
    const Eigen::Vector3d point = pose.value.translation() - Eigen::Vector3d(0.0, 0.0, drop);
    if (points.empty() || (point - points.back()).norm() >= spacing) points.push_back(point);
  }
  return points;
}

std::shared_ptr<CSetOfTriangles> makePath(const std::string& name,
                                          const std::vector<Stamped<Pose>>& path, double drop,
                                          double width, double spacing, Colour colour,
                                          DrawOrder order) {
  auto ribbon = CSetOfTriangles::Create();
  ribbon->setName(name);
  ribbon->enableLight(false);
  map::appendRibbon(pathOnGround(path, drop, spacing), width, colour, 255.0, *ribbon);
  setDrawOrder(order, *ribbon);
  return ribbon;
}

/// A wedge on the ground under the robot, pointing forward.
std::shared_ptr<CSetOfTriangles> makeRobot(const Pose& T_map_robot, double ground_z, double scale,
                                           const Palette& palette) {
  Eigen::Vector3d foot = T_map_robot.translation();
  foot.z() = ground_z + 0.04;
  const double yaw = yawOf(T_map_robot);
  const Eigen::Vector3d forward(std::cos(yaw), std::sin(yaw), 0.0);
  auto wedge = CSetOfTriangles::Create();
  wedge->setName("robot");
  wedge->enableLight(false);
  map::appendRibbon(
      {foot - 0.6 * scale * forward, foot + 0.9 * scale * forward},
      map::HalfWidths{0.5 * scale, 0.0}, palette.path, [](double) { return 255.0; }, *wedge);
  setDrawOrder(DrawOrder::kRobot, *wedge);
  return wedge;
}

/// Free and occupied cells as a picture on the ground; null without cells in the area.
std::shared_ptr<mrpt::opengl::CTexturedPlane> makeOccupancy(
    const mrpt::maps::COccupancyGridMap2D& grid, const Eigen::Vector3d& centre, double ground_z,
    const Palette& palette) {
  const auto cells = occupancyAround(grid, centre, 400.0, palette);
  if (cells.colours.empty()) return nullptr;
  const auto edge = [&](double from, int count) {
    return static_cast<float>(from + cells.cell_m * count);
  };
  auto plane = mrpt::opengl::CTexturedPlane::Create(
      edge(cells.x_min, 0), edge(cells.x_min, cells.colours.cols), edge(cells.y_min, 0),
      edge(cells.y_min, cells.colours.rows));
  plane->assignImage(mrpt::img::CImage(cells.colours, mrpt::img::DEEP_COPY),
                     mrpt::img::CImage(cells.opacity, mrpt::img::DEEP_COPY));
  plane->setName("occupancy");
  plane->setLocation(0.0, 0.0, ground_z);
  plane->mrpt::opengl::CRenderizableShaderTexturedTriangles::enableLight(false);
  setDrawOrder(DrawOrder::kOccupancy, *plane);
  return plane;
}

void appendLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, CSetOfLines& lines) {
  lines.appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
}

std::shared_ptr<CSetOfLines> makeFrustum(const StereoCamera& camera, const Pose& T_map_robot,
                                         double scale, Colour colour) {
  auto lines = CSetOfLines::Create();
  for (const auto& [from, to] : frustumEdges(camera, T_map_robot, scale))
    appendLine(from, to, *lines);
  lines->setName("camera");
  lines->setColor_u8(colour.red, colour.green, colour.blue);
  lines->setLineWidth(2.f);
  return lines;
}

std::shared_ptr<CSetOfLines> makeTrueObjects(const std::vector<Track>& objects, Colour colour) {
  auto lines = CSetOfLines::Create();
  for (const auto& object : objects) {
    const auto corners = map::boxCorners(object);
    for (const auto& [a, b] : map::kBoxEdges) {
      appendLine(corners[static_cast<std::size_t>(a)], corners[static_cast<std::size_t>(b)],
                 *lines);
    }
  }
  lines->setName("true_objects");
  lines->setColor_u8(colour.red, colour.green, colour.blue);
  return lines;
}

mrpt::opengl::CSetOfObjects visualOf(const CMovingObjectsMap& layer, double scale,
                                     const Palette& palette, bool with_labels) {
  CMovingObjectsMap shown = layer;
  shown.line_scale = scale;
  shown.prediction_colour = palette.prediction;
  shown.insertionOptions.show_labels = with_labels;
  mrpt::opengl::CSetOfObjects all;
  shown.getVisualizationInto(all);
  return all;
}

std::shared_ptr<mrpt::opengl::CSetOfObjects> makeMovingObjects(const CMovingObjectsMap& layer,
                                                               double scale,
                                                               const Palette& palette) {
  auto objects = mrpt::opengl::CSetOfObjects::Create();
  objects->setName("moving_objects");
  int order = 0;
  for (const auto& object : visualOf(layer, scale, palette, true)) {
    setDrawOrder(DrawOrder::kMovingObjects, *object, order++);
    objects->insert(object);
  }
  return objects;
}

std::shared_ptr<mrpt::opengl::CPointCloudColoured> makeCloud(
    const std::vector<render::PaintedPoint>& points, float width_px) {
  auto cloud = mrpt::opengl::CPointCloudColoured::Create();
  cloud->setName("points");
  cloud->setPointSize(width_px);
  cloud->enableVariablePointSize(false);
  for (const auto& point : points) {
    const auto& p = point.position;
    const auto& c = point.colour;
    cloud->insertPoint({p.x(), p.y(), p.z(), c.red, c.green, c.blue, std::uint8_t{255}});
  }
  setDrawOrder(DrawOrder::kLandmarks, *cloud);
  return cloud;
}

std::shared_ptr<mrpt::opengl::CSetOfObjects> makeLandmarks(const SnapshotInput& input,
                                                           double ground_z,
                                                           const Palette& palette) {
  auto landmarks = mrpt::opengl::CSetOfObjects::Create();
  landmarks->setName("landmarks");
  landmarks->insert(
      makeCloud(landmarkPoints(*input.map.staticMap(), ground_z, sceneScale(input), palette), 2.F));
  return landmarks;
}

/// SceneViewer3D takes the viewpoint from a file that says so, and opens others at the origin.
void setCamera(const SnapshotInput& input, double ground_z, mrpt::opengl::COpenGLScene& scene) {
  const double scale = sceneScale(input);
  const double yaw = yawOf(input.T_map_robot);
  Eigen::Vector3d target = input.T_map_robot.translation();
  target += kCamera.ahead_m * scale * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  auto viewport = scene.getViewport();
  viewport->setViewportClipDistances(0.1F, 2000.F);
  auto& camera = viewport->getCamera();
  camera.setPointingAt(mrpt::math::TPoint3D(target.x(), target.y(), ground_z));
  camera.setZoomDistance(static_cast<float>(kCamera.distance_m * scale));
  camera.setAzimuthDegrees(static_cast<float>(mrpt::RAD2DEG(yaw) + 180.0 + kCamera.aside_deg));
  camera.setElevationDegrees(kCamera.elevation_deg);
  scene.enableFollowCamera(true);
}

void setBackground(Colour colour, mrpt::opengl::COpenGLScene& scene) {
  scene.getViewport()->setCustomBackgroundColor(
      {mrpt::u8tof(colour.red), mrpt::u8tof(colour.green), mrpt::u8tof(colour.blue), 1.f});
}

/// Paths and robot, in the order in which they are drawn.
std::vector<std::shared_ptr<CSetOfTriangles>> groundTriangles(const SnapshotInput& input,
                                                              double ground_z,
                                                              const Palette& palette) {
  const double scale = sceneScale(input);
  const double width = 0.25 * scale;
  const double spacing = 0.3 * scale;
  const double drop = input.T_map_robot.translation().z() - ground_z - 0.02;
  std::vector<std::shared_ptr<CSetOfTriangles>> result;
  if (!input.true_path.empty()) {
    result.push_back(makePath("true_path", input.true_path, drop, 2.2 * width, spacing,
                              palette.truth, DrawOrder::kTruth));
  }
  if (!input.path.empty()) {
    result.push_back(makePath("camera_path", input.path, drop - 0.01, width, spacing, palette.path,
                              DrawOrder::kPath));
  }
  result.push_back(makeRobot(input.T_map_robot, ground_z, scale, palette));
  return result;
}

void append(const CSetOfTriangles& triangles, std::vector<render::PaintedTriangle>& out) {
  for (const auto& triangle : triangles.shaderTrianglesBuffer()) {
    render::PaintedTriangle& painted = out.emplace_back();
    painted.colour = {triangle.r(0), triangle.g(0), triangle.b(0)};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      painted.corners[corner] = {triangle.x(corner), triangle.y(corner), triangle.z(corner)};
      painted.opacity[corner] = mrpt::u8tof(triangle.a(corner));
    }
  }
}

}  // namespace

void setDrawOrder(DrawOrder order, mrpt::opengl::CRenderizable& object, int offset) {
  const int rank = static_cast<int>(order) + offset;
  object.setLocalRepresentativePoint({0.f, 0.f, -8000.f + 500.f * static_cast<float>(rank)});
}

mrpt::opengl::COpenGLScene buildScene(const SnapshotInput& input, const SnapshotOptions& options,
                                      double ground_z) {
  const Palette& palette = paletteOf(options.theme);
  const Eigen::Vector3d position = input.T_map_robot.translation();
  const double scale = sceneScale(input);
  mrpt::opengl::COpenGLScene scene;
  setBackground(palette.backdrop.ground, scene);
  setCamera(input, ground_z, scene);
  if (const auto grid = input.map.staticGrid()) {
    if (const auto plane = makeOccupancy(*grid, position, ground_z - 0.01, palette)) {
      scene.insert(plane);
    }
  }
  scene.insert(makeGrid(position, ground_z, gridSpacing(scale), palette));
  if (options.dense && input.map.dense() != nullptr) {
    auto cloud = makeCloud(densePoints(*input.map.dense(), palette), 3.F);
    cloud->setName("dense");
    scene.insert(cloud);
  }
  scene.insert(makeLandmarks(input, ground_z, palette));
  for (const auto& triangles : groundTriangles(input, ground_z, palette)) scene.insert(triangles);
  scene.insert(makeMovingObjects(input.map.movingObjects(), scale, palette));
  if (!input.true_objects.empty()) {
    scene.insert(makeTrueObjects(input.true_objects, palette.truth));
  }
  if (input.camera != nullptr) {
    scene.insert(makeFrustum(*input.camera, input.T_map_robot, scale, palette.path));
  }
  return scene;
}

std::vector<render::PaintedTriangle> pictureTriangles(const SnapshotInput& input,
                                                      const Palette& palette, double ground_z) {
  std::vector<render::PaintedTriangle> result;
  for (const auto& triangles : groundTriangles(input, ground_z, palette)) {
    append(*triangles, result);
  }
  for (const auto& object :
       visualOf(input.map.movingObjects(), sceneScale(input), palette, false)) {
    const auto triangles = std::dynamic_pointer_cast<CSetOfTriangles>(object);
    if (triangles != nullptr) append(*triangles, result);
  }
  return result;
}

}  // namespace headway::scene
