#include "world_scene.h"

#include <headway/core/class_colour.h>
#include <headway/core/mrpt_pose.h>
#include <headway/map/ribbon.h>
#include <headway/map/track_geometry.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include <algorithm>
#include <cmath>

#include "canvas.h"
#include "view.h"

namespace headway::scene {
namespace {

using mrpt::opengl::CSetOfLines;
using mrpt::opengl::CSetOfTriangles;

constexpr double kGridSpacingM = 10.0;
constexpr double kGridExtentM = 150.0;
constexpr double kPathWidthM = 0.25;
constexpr double kPathSpacingM = 0.3;

std::shared_ptr<mrpt::opengl::CGridPlaneXY> makeGrid(const Eigen::Vector3d& centre,
                                                     double ground_z) {
  const double x = kGridSpacingM * std::round(centre.x() / kGridSpacingM);
  const double y = kGridSpacingM * std::round(centre.y() / kGridSpacingM);
  auto grid = mrpt::opengl::CGridPlaneXY::Create(
      static_cast<float>(x - kGridExtentM), static_cast<float>(x + kGridExtentM),
      static_cast<float>(y - kGridExtentM), static_cast<float>(y + kGridExtentM),
      static_cast<float>(ground_z), static_cast<float>(kGridSpacingM));
  grid->setName("ground_grid");
  grid->setColor_u8(kGridColour.red, kGridColour.green, kGridColour.blue);
  setDrawOrder(DrawOrder::kGrid, *grid);
  return grid;
}

/// The path projected to the ground, without points closer than kPathSpacingM.
std::vector<Eigen::Vector3d> pathOnGround(const std::vector<Stamped<Pose>>& path, double drop) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& pose : path) {
    const Eigen::Vector3d point = pose.value.translation() - Eigen::Vector3d(0.0, 0.0, drop);
    if (points.empty() || (point - points.back()).norm() >= kPathSpacingM) points.push_back(point);
  }
  return points;
}

std::shared_ptr<CSetOfTriangles> makePath(const std::string& name,
                                          const std::vector<Stamped<Pose>>& path, double drop,
                                          double width, Colour colour, DrawOrder order) {
  auto ribbon = CSetOfTriangles::Create();
  ribbon->setName(name);
  ribbon->enableLight(false);
  map::appendRibbon(pathOnGround(path, drop), width, colour, 255.0, *ribbon);
  setDrawOrder(order, *ribbon);
  return ribbon;
}

/// A wedge on the ground under the robot, pointing forward.
std::shared_ptr<CSetOfTriangles> makeRobot(const Pose& T_map_robot, double ground_z) {
  Eigen::Vector3d foot = T_map_robot.translation();
  foot.z() = ground_z + 0.04;
  const double yaw = yawOf(T_map_robot);
  const Eigen::Vector3d forward(std::cos(yaw), std::sin(yaw), 0.0);
  auto wedge = CSetOfTriangles::Create();
  wedge->setName("robot");
  wedge->enableLight(false);
  map::appendRibbon(
      {foot - 0.6 * forward, foot + 0.9 * forward}, map::HalfWidths{0.5, 0.0}, kPathColour,
      [](double) { return 255.0; }, *wedge);
  setDrawOrder(DrawOrder::kRobot, *wedge);
  return wedge;
}

void appendLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, CSetOfLines& lines) {
  lines.appendLine(from.x(), from.y(), from.z(), to.x(), to.y(), to.z());
}

std::shared_ptr<CSetOfLines> makeFrustum(const StereoCamera& camera, const Pose& T_map_robot) {
  auto lines = CSetOfLines::Create();
  for (const auto& [from, to] : frustumEdges(camera, T_map_robot)) appendLine(from, to, *lines);
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
                                                               SceneUse use) {
  CMovingObjectsMap shown = layer;
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

}  // namespace

void setDrawOrder(DrawOrder order, mrpt::opengl::CRenderizable& object, int offset) {
  const int rank = static_cast<int>(order) + offset;
  object.setLocalRepresentativePoint({0.f, 0.f, -8000.f + 500.f * static_cast<float>(rank)});
}

mrpt::opengl::COpenGLScene WorldScene::build(const SnapshotInput& input, double ground_z,
                                             const render::PinholeView* view) {
  landmarks_.update(input.map.staticMap(), ground_z, point_size_);
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
  scene.getViewport()->setCustomBackgroundColor({mrpt::u8tof(kBackgroundColour.red),
                                                 mrpt::u8tof(kBackgroundColour.green),
                                                 mrpt::u8tof(kBackgroundColour.blue), 1.f});
  scene.insert(makeGrid(position, ground_z));
  scene.insert(landmarks);
  if (!input.true_path.empty()) {
    scene.insert(makePath("true_path", input.true_path, drop, 2.2 * kPathWidthM, kTruthColour,
                          DrawOrder::kTruth));
  }
  if (!input.path.empty()) {
    scene.insert(makePath("camera_path", input.path, drop - 0.01, kPathWidthM, kPathColour,
                          DrawOrder::kPath));
  }
  scene.insert(makeRobot(input.T_map_robot, ground_z));
  scene.insert(makeMovingObjects(input.map.movingObjects(), use_));
  if (use_ == SceneUse::kPicture) return scene;
  if (!input.true_objects.empty()) scene.insert(makeTrueObjects(input.true_objects));
  if (input.camera != nullptr) scene.insert(makeFrustum(*input.camera, input.T_map_robot));
  return scene;
}

}  // namespace headway::scene
