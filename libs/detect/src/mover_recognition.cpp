#include "mover_recognition.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "over_ground.h"

namespace headway::detect {
namespace {

constexpr double kSamePlace = 0.8;           // [m]
constexpr double kSamePlacePerMetre = 0.02;  // growth with depth [m/m]
constexpr double kFlowSigmas = 3.0;          // by which a flow may be off the expected one
constexpr double kSameFlow = 0.5;            // and share of it
constexpr int kLeastSightings = 2;           // of a mover that is sought by its look
constexpr double kNearest = 1.0;             // nearer than this nothing is sought [m]
constexpr double kLeastWidth = 4.0;          // of what is still in the image [px]
constexpr double kLeastHeight = 8.0;         // [px]

bool flowsAs(const AcrossSpeed& flow, double across) {
  return std::abs(flow.speed) > kLeastAcross + 2.0 * flow.sigma &&
         std::abs(flow.speed - across) < kFlowSigmas * flow.sigma + kSameFlow * std::abs(across);
}

bool isTaken(const BlobTrack& body, const std::vector<Mover>& movers) {
  return std::any_of(movers.begin(), movers.end(), [&](const Mover& mover) {
    return std::find(mover.bodies.begin(), mover.bodies.end(), &body) != mover.bodies.end();
  });
}

// The free body nearest to where the mover must be that flows like it; null if there is none.
BlobTrack* bodyOf(const ObjectIdentity& mover, const LookedAt& frame,
                  std::vector<BlobTrack>& bodies, const std::vector<Mover>& movers) {
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  const Eigen::Vector3d expected = mover.expectedAt(frame.path.timeOf(frame.path.newest()));
  const double across = T_cam_world.linear().row(0).dot(mover.velocity.value);
  BlobTrack* nearest = nullptr;
  double least = recognitionGate((T_cam_world * expected).z());
  for (auto& body : bodies) {
    if (body.last_frame != frame.path.newest() || !body.blob.across) continue;
    if (!flowsAs(*body.blob.across, across) || isTaken(body, movers)) continue;
    const double off = overGround(body.last_place - expected, frame.up).norm();
    if (off >= least) continue;
    least = off;
    nearest = &body;
  }
  return nearest;
}

// A look as the image shows it from farther away or nearer, and elsewhere.
class Moved {
 public:
  Moved(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double scale)
      : from_(from), to_(to), scale_(scale) {}

  [[nodiscard]] Eigen::Vector2d operator()(double u, double v) const {
    return to_ + scale_ * (Eigen::Vector2d(u, v) - from_);
  }

 private:
  Eigen::Vector2d from_, to_;
  double scale_;
};

// The box, cut off at the image's edges; nullopt if hardly any of it is left.
std::optional<Box2d> movedBox(const Box2d& box, const Moved& moved, const StereoCamera& camera) {
  const Eigen::Vector2d least = moved(box.left, box.top).cwiseMax(0.0);
  const Eigen::Vector2d most =
      moved(box.right, box.bottom).cwiseMin(Eigen::Vector2d(camera.width - 1, camera.height - 1));
  if (most.x() - least.x() < kLeastWidth || most.y() - least.y() < kLeastHeight) {
    return std::nullopt;
  }
  return Box2d{least.x(), least.y(), most.x(), most.y()};
}

std::vector<cv::Point> movedCells(const std::vector<cv::Point>& cells, const Moved& moved,
                                  const stereo::DisparityImage& disparity) {
  const cv::Rect inside({0, 0}, disparity.values.size());
  std::vector<cv::Point> result;
  for (const auto& cell : cells) {
    const Eigen::Vector2d pixel = moved(disparity.pixelOf(cell.x), disparity.pixelOf(cell.y));
    const cv::Point place(disparity.cellOf(pixel.x()), disparity.cellOf(pixel.y()));
    if (inside.contains(place)) result.push_back(place);
  }
  return result;
}

// Where the look of a mover is seen, as an extent in this frame; nullopt if it is not seen.
std::optional<ObjectExtent> lookAt(const ObjectIdentity& mover, const LookedAt& frame,
                                   const StereoCamera& camera) {
  const MoverLook& look = *mover.look;
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  const double seconds = frame.path.timeOf(frame.path.newest()) - look.time;
  const Eigen::Vector3d way = seconds * mover.velocity.value;
  const Eigen::Vector3d standing = T_cam_world * look.T_world_cam * look.extent.box.centre;
  const Eigen::Vector3d going = standing + T_cam_world.linear() * way;
  if (going.z() < kNearest || standing.z() < kNearest) return std::nullopt;
  const auto pixel_then = project(look.extent.box.centre, camera);
  const auto pixel_standing = project(standing, camera);
  const auto pixel_going = project(going, camera);
  if (!pixel_then || !pixel_standing || !pixel_going) return std::nullopt;

  const double scale = look.extent.box.centre.z() / going.z();
  const double reduce = frame.disparity.reduce;
  const Moved expected(pixel_then->head<2>(), pixel_going->head<2>(), scale);
  const auto& middle = look.appearance.middle;
  const Eigen::Vector2d there = expected(middle.x * reduce, middle.y * reduce) / reduce;
  const auto off = seek(look.appearance, frame.image, {there.x(), there.y()}, scale);
  if (!off) return std::nullopt;
  const double from_standing = off->x - (pixel_standing->x() - pixel_going->x()) / reduce;
  if (std::abs(off->x) > std::abs(from_standing) + 0.5) return std::nullopt;

  const Eigen::Vector2d shift = reduce * Eigen::Vector2d(off->x, off->y);
  const Moved found(pixel_then->head<2>(), pixel_going->head<2>() + shift, scale);
  const auto box2d = movedBox(look.extent.box2d, found, camera);
  if (!box2d) return std::nullopt;
  ObjectExtent extent = look.extent;
  extent.box2d = *box2d;
  extent.box.centre = going + Eigen::Vector3d(shift.x() * going.z() / camera.fx, 0.0, 0.0);
  const Eigen::Matrix3d R = T_cam_world.linear() * look.T_world_cam.linear();
  extent.surface = extent.box.centre + R * (look.extent.surface - look.extent.box.centre);
  extent.centre_covariance = R * look.extent.centre_covariance * R.transpose() +
                             seconds * seconds * T_cam_world.linear() * mover.velocity.covariance *
                                 T_cam_world.linear().transpose();
  extent.cells = movedCells(look.extent.cells, found, frame.disparity);
  return extent;
}

Mover recognised(const ObjectIdentity& mover, ObjectExtent extent, MoverEvidence evidence,
                 const LookedAt& frame) {
  Mover result;
  result.extent = std::move(extent);
  result.velocity = mover.velocity;
  result.first_frame = frame.path.oldest();
  result.evidence = evidence;
  result.known_as = mover.id;
  return result;
}

}  // namespace

double recognitionGate(double depth) { return kSamePlace + kSamePlacePerMetre * depth; }

void recogniseBodies(const LookedAt& frame, const std::vector<ObjectIdentity>& missing,
                     std::vector<BlobTrack>& bodies, const StereoCamera& camera,
                     std::vector<Mover>& movers) {
  if (!frame.ground) return;
  const Pose& T_cam_world = frame.path.T_cam_world(frame.path.newest());
  for (const auto& identity : missing) {
    BlobTrack* body = bodyOf(identity, frame, bodies, movers);
    if (body == nullptr) continue;
    auto extent = extentOf(body->blob.cells, T_cam_world.linear() * identity.velocity.value,
                           frame.disparity, camera, *frame.ground);
    if (!extent || isPartOfAny(*extent, movers)) continue;
    Mover mover = recognised(identity, std::move(*extent), MoverEvidence::kFlow, frame);
    mover.points = static_cast<int>(body->across.size());
    mover.bodies = {body};
    movers.push_back(std::move(mover));
  }
}

void recogniseLooks(const LookedAt& frame, const std::vector<ObjectIdentity>& missing,
                    const StereoCamera& camera, std::vector<Mover>& movers) {
  for (const auto& identity : missing) {
    if (!identity.look || identity.sightings < kLeastSightings) continue;
    auto extent = lookAt(identity, frame, camera);
    if (!extent || isPartOfAny(*extent, movers)) continue;
    Mover mover = recognised(identity, std::move(*extent), MoverEvidence::kLook, frame);
    mover.points = identity.look->points;
    movers.push_back(std::move(mover));
  }
}

}  // namespace headway::detect
