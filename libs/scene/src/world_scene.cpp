// SPDX-License-Identifier: BSD-3-Clause
#include "world_scene.h"

#include <headway/core/class_colour.h>
#include <headway/core/mrpt_pose.h>
#include <headway/map/ribbon.h>
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
#include "view.h"

namespace headway::scene {
namespace {

using mrpt::opengl::CSetOfLines;
using mrpt::opengl::CSetOfTriangles;

constexpr double kGridExtentLines = 15.0;  // to each side of the robot
constexpr double kPathWidthM = 0.25;       // at scale 1, as the following
constexpr double kPathSpacingM = 0.3;
constexpr double kWholeMapM = 400.0;        // around the robot, in files
constexpr double kOccupancyRadiusM = 60.0;  // around the robot, in pictures

// Cells of the occupancy grid that are shown, and their opacity.
constexpr float kFreeAbove = 0.6F;
constexpr float kOccupiedBelow = 0.4F;
constexpr std::uint8_t kFreeOpacity = 110, kOccupiedOpacity = 235;

std::shared_ptr<mrpt::opengl::CGridPlaneXY> makeGrid(const Eigen::Vector3d& centre, double ground_z,
                                                     double spacing) {
  const double extent = kGridExtentLines * spacing;
  const double x = spacing * std::round(centre.x() / spacing);
  const double y = spacing * std::round(centre.y() / spacing);
  auto grid = mrpt::opengl::CGridPlaneXY::Create(
      static_cast<float>(x - extent), static_cast<float>(x + extent),
      static_cast<float>(y - extent), static_cast<float>(y + extent), static_cast<float>(ground_z),
      static_cast<float>(spacing));
  grid->setName("ground_grid");
  grid->setColor_u8(kGridColour.red, kGridColour.green, kGridColour.blue);
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
std::shared_ptr<CSetOfTriangles> makeRobot(const Pose& T_map_robot, double ground_z, double scale) {
  Eigen::Vector3d foot = T_map_robot.translation();
  foot.z() = ground_z + 0.04;
  const double yaw = yawOf(T_map_robot);
  const Eigen::Vector3d forward(std::cos(yaw), std::sin(yaw), 0.0);
  auto wedge = CSetOfTriangles::Create();
  wedge->setName("robot");
  wedge->enableLight(false);
  map::appendRibbon(
      {foot - 0.6 * scale * forward, foot + 0.9 * scale * forward},
      map::HalfWidths{0.5 * scale, 0.0}, kPathColour, [](double) { return 255.0; }, *wedge);
  setDrawOrder(DrawOrder::kRobot, *wedge);
  return wedge;
}

/// @param free    probability of the cell to be free
/// @param colour  one pixel, BGR
void paintCell(float free, std::uint8_t* colour, std::uint8_t* opacity) {
  const bool occupied = free < kOccupiedBelow;
  const Colour shown = occupied ? kOccupiedColour : kFreeColour;
  colour[0] = shown.blue;
  colour[1] = shown.green;
  colour[2] = shown.red;
  *opacity = occupied ? kOccupiedOpacity : free > kFreeAbove ? kFreeOpacity : 0;
}

/// Free and occupied cells as a picture on the ground; null without cells in the area.
std::shared_ptr<mrpt::opengl::CTexturedPlane> makeOccupancy(
    const mrpt::maps::COccupancyGridMap2D& grid, const Eigen::Vector3d& centre, double radius,
    double ground_z) {
  const auto cells = [&](double metres) { return static_cast<int>(std::floor(metres)); };
  const double size = static_cast<double>(grid.getResolution());
  const double x_min = static_cast<double>(grid.getXMin());
  const double y_min = static_cast<double>(grid.getYMin());
  const int left = std::max(0, cells((centre.x() - radius - x_min) / size));
  const int bottom = std::max(0, cells((centre.y() - radius - y_min) / size));
  const int right =
      std::min(static_cast<int>(grid.getSizeX()), cells((centre.x() + radius - x_min) / size) + 1);
  const int top =
      std::min(static_cast<int>(grid.getSizeY()), cells((centre.y() + radius - y_min) / size) + 1);
  if (left >= right || bottom >= top) return nullptr;
  mrpt::img::CImage colours(right - left, top - bottom, mrpt::img::CH_RGB);
  mrpt::img::CImage opacity(right - left, top - bottom, mrpt::img::CH_GRAY);
  for (int y = bottom; y < top; ++y) {
    const auto row = static_cast<unsigned>(y - bottom);  // the texture's first row is at y_min
    auto* colour = colours.ptrLine<std::uint8_t>(row);
    auto* alpha = opacity.ptrLine<std::uint8_t>(row);
    for (int x = left; x < right; ++x, colour += 3, ++alpha) {
      paintCell(grid.getCell(x, y), colour, alpha);
    }
  }
  const auto edge = [&](double from, int cell) { return static_cast<float>(from + size * cell); };
  auto plane = mrpt::opengl::CTexturedPlane::Create(edge(x_min, left), edge(x_min, right),
                                                    edge(y_min, bottom), edge(y_min, top));
  plane->assignImage(std::move(colours), std::move(opacity));
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
                                         double scale) {
  auto lines = CSetOfLines::Create();
  for (const auto& [from, to] : frustumEdges(camera, T_map_robot, scale))
    appendLine(from, to, *lines);
  lines->setName("camera");
  lines->setColor_u8(kPathColour.red, kPathColour.green, kPathColour.blue);
  lines->setLineWidth(2.f);
  return lines;
}

std::shared_ptr<CSetOfLines> makeTrueObjects(const std::vector<Track>& objects) {
  auto lines = CSetOfLines::Create();
  for (const auto& object : objects) {
    const auto corners = map::boxCorners(object);
    for (const auto& [a, b] : map::kBoxEdges) {
      appendLine(corners[static_cast<std::size_t>(a)], corners[static_cast<std::size_t>(b)],
                 *lines);
    }
  }
  lines->setName("true_objects");
  lines->setColor_u8(kTruthColour.red, kTruthColour.green, kTruthColour.blue);
  return lines;
}

std::shared_ptr<mrpt::opengl::CSetOfObjects> makeMovingObjects(const CMovingObjectsMap& layer,
                                                               SceneUse use, double scale) {
  CMovingObjectsMap shown = layer;
  shown.line_scale = scale;
  if (use == SceneUse::kPicture) shown.insertionOptions.show_labels = false;
  mrpt::opengl::CSetOfObjects all;
  shown.getVisualizationInto(all);
  auto objects = mrpt::opengl::CSetOfObjects::Create();
  objects->setName("moving_objects");
  int order = 0;
  for (const auto& object : all) {
    const bool outline = std::dynamic_pointer_cast<CSetOfLines>(object) != nullptr;
    if (outline && use == SceneUse::kPicture) continue;
    setDrawOrder(DrawOrder::kMovingObjects, *object, order++);
    objects->insert(object);
  }
  return objects;
}

/// The points of the dense map, each as wide as a landmark's dot.
mrpt::opengl::CPointCloudColoured::Ptr makeDense(const mrpt::maps::CColouredPointsMap& points) {
  auto cloud = mrpt::opengl::CPointCloudColoured::Create();
  cloud->setName("dense");
  cloud->loadFromPointsMap(&points);
  cloud->setPointSize(2.f);
  setDrawOrder(DrawOrder::kLandmarks, *cloud);
  return cloud;
}

void setBackground(mrpt::opengl::COpenGLScene& scene) {
  scene.getViewport()->setCustomBackgroundColor({mrpt::u8tof(kBackgroundColour.red),
                                                 mrpt::u8tof(kBackgroundColour.green),
                                                 mrpt::u8tof(kBackgroundColour.blue), 1.f});
}

}  // namespace

void setDrawOrder(DrawOrder order, mrpt::opengl::CRenderizable& object, int offset) {
  const int rank = static_cast<int>(order) + offset;
  object.setLocalRepresentativePoint({0.f, 0.f, -8000.f + 500.f * static_cast<float>(rank)});
}

mrpt::opengl::COpenGLScene WorldScene::build(const SnapshotInput& input, double ground_z,
                                             const render::PinholeView* view) {
  landmarks_.update(input.map.staticMap(), ground_z, sceneScale(input), point_size_);
  auto landmarks = mrpt::opengl::CSetOfObjects::Create();
  landmarks->setName("landmarks");
  if (view != nullptr) {
    landmarks_.insertVisible(*view, *landmarks);
  } else {
    landmarks_.insertAll(*landmarks);
  }
  const Eigen::Vector3d position = input.T_map_robot.translation();
  const double drop = position.z() - ground_z - 0.02;
  mrpt::opengl::COpenGLScene scene;
  setBackground(scene);
  const double scale = sceneScale(input);
  const double path_width = kPathWidthM * scale;
  const double spacing = kPathSpacingM * scale;
  if (const auto grid = input.map.staticGrid()) {
    const double radius = view != nullptr ? kOccupancyRadiusM * std::max(0.5, scale) : kWholeMapM;
    const auto plane = makeOccupancy(*grid, position, radius, ground_z - 0.01);
    if (plane) scene.insert(plane);
  }
  scene.insert(makeGrid(position, ground_z, gridSpacing(scale)));
  scene.insert(landmarks);
  if (!input.true_path.empty()) {
    scene.insert(makePath("true_path", input.true_path, drop, 2.2 * path_width, spacing,
                          kTruthColour, DrawOrder::kTruth));
  }
  if (!input.path.empty()) {
    scene.insert(makePath("camera_path", input.path, drop - 0.01, path_width, spacing, kPathColour,
                          DrawOrder::kPath));
  }
  scene.insert(makeRobot(input.T_map_robot, ground_z, scale));
  scene.insert(makeMovingObjects(input.map.movingObjects(), use_, scale));
  if (use_ == SceneUse::kPicture) return scene;
  if (const auto dense = input.map.dense()) scene.insert(makeDense(*dense));
  if (!input.true_objects.empty()) scene.insert(makeTrueObjects(input.true_objects));
  if (input.camera != nullptr) scene.insert(makeFrustum(*input.camera, input.T_map_robot, scale));
  return scene;
}

}  // namespace headway::scene
