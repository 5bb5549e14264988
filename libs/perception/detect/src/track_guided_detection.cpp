// SPDX-License-Identifier: BSD-3-Clause
// Detection of objects that the tracker expects, by less evidence: their appearance.
#include "track_guided_detection.h"

#include <headway/core/assignment.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "appearance.h"
#include "point_motion.h"

namespace headway::detect {
namespace {

constexpr double kGate = 0.8;              // between an object and its expected place [m]
constexpr double kIndistinctTime = 0.7;    // in which it is searched though these coincide [s]
constexpr double kMinVisibleRatio = 0.25;  // of the box left inside the image, of its width
constexpr double kMinVisibleHeight = 8.0;  // [px]

double gateAt(double depth) { return kGate + kGatePerMetre * depth; }

double depthOf(const Eigen::Vector3d& position, const CameraPath& path) {
  return (path.T_cam_world(path.newest()) * position).z();
}

// Image coordinates of a template in a later image: shifted and scaled.
class Similarity {
 public:
  Similarity(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double scale)
      : from_(from), to_(to), scale_(scale) {}

  [[nodiscard]] Eigen::Vector2d operator()(double u, double v) const {
    return to_ + scale_ * (Eigen::Vector2d(u, v) - from_);
  }

 private:
  Eigen::Vector2d from_, to_;
  double scale_;
};

// The box, clipped to the image; nullopt if hardly any of it is left.
std::optional<Box2d> transformed(const Box2d& box, const Similarity& similarity,
                                 const StereoCamera& camera) {
  const Eigen::Vector2d min = similarity(box.left, box.top).cwiseMax(0.0);
  const Eigen::Vector2d max = similarity(box.right, box.bottom)
                                  .cwiseMin(Eigen::Vector2d(camera.width - 1, camera.height - 1));
  const double width = similarity(box.right, 0.0).x() - similarity(box.left, 0.0).x();
  if (max.x() - min.x() < kMinVisibleRatio * width || max.y() - min.y() < kMinVisibleHeight)
    return std::nullopt;
  return Box2d{min.x(), min.y(), max.x(), max.y()};
}

std::vector<cv::Point> transformedCells(const ObjectMask& mask, const Similarity& similarity,
                                        const stereo::DisparityImage& disparity) {
  const cv::Rect inside({0, 0}, disparity.values.size());
  std::vector<cv::Point> result;
  for (int row = 0; row < mask.cells.rows; ++row) {
    for (int column = 0; column < mask.cells.cols; ++column) {
      if (mask.cells.at<unsigned char>(row, column) == 0) continue;
      const Eigen::Vector2d pixel = similarity(disparity.pixelOf(mask.corner.x + column),
                                               disparity.pixelOf(mask.corner.y + row));
      const cv::Point place(disparity.cellOf(pixel.x()), disparity.cellOf(pixel.y()));
      if (inside.contains(place)) result.push_back(place);
    }
  }
  return result;
}

// Where an object's template would be seen now: had it stopped, and at its velocity.
struct ExpectedView {
  Eigen::Vector3d moving;  ///< box centre, camera frame now [m]
  Eigen::Vector2d template_px, stopped_px, moving_px;
  double scale;  ///< of the image now over that of the template
};

std::optional<ExpectedView> expectedView(const SearchedObject& object, const MotionFrame& frame,
                                         const StereoCamera& camera) {
  const AppearanceTemplate& appearance = *object.appearance;
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  const double seconds = frame.path.timeOf(frame.path.newest()) - appearance.time;
  const Eigen::Vector3d stopped = object.T_cam_then * appearance.box3d.centre;
  const Eigen::Vector3d moving = stopped + T_cam_world.linear() * (seconds * object.velocity.value);
  const auto template_px = project(appearance.box3d.centre, camera);
  const auto stopped_px = project(stopped, camera);
  const auto moving_px = project(moving, camera);
  if (!template_px || !stopped_px || !moving_px) return std::nullopt;
  return ExpectedView{moving, template_px->head<2>(), stopped_px->head<2>(), moving_px->head<2>(),
                      appearance.box3d.centre.z() / moving.z()};
}

// How far from its expected place the template is found [px]; nullopt if it is not found, or
// nearer to where the object would be had it stopped.
std::optional<Eigen::Vector2d> foundOffset(const SearchedObject& object, const ExpectedView& view,
                                           const MotionFrame& frame) {
  const double reduce = frame.disparity.reduce;
  const ObjectMask& mask = object.appearance->mask;
  const Similarity expected(view.template_px, view.moving_px, view.scale);
  const Eigen::Vector2d centre = expected((mask.corner.x + 0.5 * mask.cells.cols) * reduce,
                                          (mask.corner.y + 0.5 * mask.cells.rows) * reduce);
  const auto offset = findTemplate(*object.appearance, frame.image,
                                   {centre.x() / reduce, centre.y() / reduce}, view.scale);
  if (!offset) return std::nullopt;
  const double from_stopped = offset->x - (view.stopped_px.x() - view.moving_px.x()) / reduce;
  if (std::abs(offset->x) > std::abs(from_stopped) + 0.5) return std::nullopt;
  const double seconds = frame.path.timeOf(frame.path.newest()) - object.last_motion;
  const bool distinct =
      (view.stopped_px - view.moving_px).norm() > 2.0 * reduce || seconds < kIndistinctTime;
  if (!distinct) return std::nullopt;
  return reduce * Eigen::Vector2d(offset->x, offset->y);
}

// Whether most of the cells show something farther. What is nearer may hide a part of the object.
bool isSeenFarther(const std::vector<cv::Point>& cells, double expected_disparity,
                   const stereo::DisparityImage& disparity) {
  std::vector<float> values;
  for (const auto& cell : cells) {
    const float d = disparity.values.at<float>(cell);
    if (d > 0.0F) values.push_back(d);
  }
  if (values.empty() || 2 * values.size() < cells.size()) return false;
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return expected_disparity - values[values.size() / 2] >
         std::max(kFarther_px, kFartherRatio * expected_disparity);
}

std::optional<ObjectExtent> extentByAppearance(const SearchedObject& object,
                                               const MotionFrame& frame,
                                               const StereoCamera& camera) {
  const auto view = expectedView(object, frame, camera);
  const auto offset = view ? foundOffset(object, *view, frame) : std::nullopt;
  if (!offset) return std::nullopt;
  const AppearanceTemplate& appearance = *object.appearance;
  const Similarity found(view->template_px, view->moving_px + *offset, view->scale);
  const auto box2d = transformed(appearance.box2d, found, camera);
  if (!box2d) return std::nullopt;
  ObjectExtent extent;
  extent.box2d = *box2d;
  extent.object_class = object.object_class;
  extent.box = appearance.box3d;
  extent.box.centre =
      view->moving + Eigen::Vector3d(offset->x() * view->moving.z() / camera.fx, 0.0, 0.0);
  const Eigen::Matrix3d R = object.T_cam_then.linear();
  extent.box.yaw = opticalYaw(R * frontOf(appearance.box3d));
  extent.surface = extent.box.centre + R * (appearance.surface - appearance.box3d.centre);
  const Eigen::Matrix3d R_cam_world = frame.path.T_cam_world(frame.path.newest()).linear();
  const double seconds = frame.path.timeOf(frame.path.newest()) - appearance.time;
  extent.centre_covariance =
      R * appearance.centre_covariance * R.transpose() +
      seconds * seconds * R_cam_world * object.velocity.covariance * R_cam_world.transpose();
  extent.cells = transformedCells(appearance.mask, found, frame.disparity);
  const double disparity = camera.fx * camera.baseline_m / extent.surface.z();
  if (isSeenFarther(extent.cells, disparity, frame.disparity)) return std::nullopt;
  return extent;
}

MovingObject detected(const SearchedObject& object, ObjectExtent extent, const MotionFrame& frame) {
  MovingObject result;
  result.extent = std::move(extent);
  result.velocity = object.velocity;
  result.first_frame = frame.path.newest();
  result.evidence.appearance = true;
  result.searched_track = object.track;
  result.group = object.group;
  result.points = object.appearance->support;
  return result;
}

}  // namespace

std::vector<SearchedObject> searchedObjects(const std::vector<ExpectedObject>& expected,
                                            const CameraPath& path, const Pose& T_map_cam) {
  const Time now = path.timeOf(path.newest());
  const Pose T_cam_map = T_map_cam.inverse();
  const Pose T_world_map = path.T_cam_world(path.newest()).inverse() * T_cam_map;
  std::vector<SearchedObject> searched;
  for (const auto& object : expected) {
    if (now - object.last_motion > kMotionMemory_s) continue;
    SearchedObject result{object.track,
                          object.object_class,
                          T_world_map * object.positionAt(now),
                          rotated(object.velocity, T_world_map.linear()),
                          object.observations,
                          object.detector_id.value_or(-1),
                          object.last_motion,
                          Pose::Identity(),
                          object.appearance};
    if (object.appearance) result.T_cam_then = T_cam_map * object.appearance->T_map_camera;
    searched.push_back(std::move(result));
  }
  return searched;
}

std::vector<SearchedObject> withoutFound(std::vector<SearchedObject> searched,
                                         const std::vector<MovingObject>& found,
                                         const CameraPath& path) {
  const Pose& T_cam_world = path.T_cam_world(path.newest());
  std::vector<bool> explained(searched.size(), false);
  std::vector<bool> explains(found.size(), false);
  for (std::size_t s = 0; s < searched.size(); ++s) {
    for (std::size_t f = 0; f < found.size() && !explained[s]; ++f) {
      explained[s] = !explains[f] && found[f].group >= 0 && found[f].group == searched[s].group;
      explains[f] = explains[f] || explained[s];
    }
  }
  std::vector<CandidatePair> candidates;
  for (std::size_t s = 0; s < searched.size(); ++s) {
    if (explained[s]) continue;
    const Eigen::Vector3d expected = T_cam_world * searched[s].position;
    for (std::size_t f = 0; f < found.size(); ++f) {
      if (explains[f]) continue;
      const double distance = (found[f].extent.box.centre - expected).norm();
      if (distance < gateAt(expected.z())) candidates.push_back({s, f, distance});
    }
  }
  for (const auto& pair : assignPairs(std::move(candidates))) explained[pair.row] = true;
  std::vector<SearchedObject> missing;
  for (std::size_t s = 0; s < searched.size(); ++s) {
    if (!explained[s]) missing.push_back(std::move(searched[s]));
  }
  return missing;
}

void detectByAppearance(const MotionFrame& frame, const std::vector<SearchedObject>& searched,
                        double beyond_m, const StereoCamera& camera,
                        std::vector<MovingObject>& found) {
  for (const auto& object : searched) {
    if (object.appearance == nullptr || object.observations < 2) continue;
    if (depthOf(object.position, frame.path) < beyond_m) continue;
    const bool is_found = std::any_of(found.begin(), found.end(), [&](const MovingObject& other) {
      return other.searched_track == object.track;
    });
    auto extent = is_found ? std::nullopt : extentByAppearance(object, frame, camera);
    if (!extent || isPartOfAny(*extent, found)) continue;
    found.push_back(detected(object, std::move(*extent), frame));
  }
}

}  // namespace headway::detect
