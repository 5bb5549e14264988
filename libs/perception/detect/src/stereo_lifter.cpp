// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/class_size.h>
#include <headway/detect/stereo_lifter.h>

#include <algorithm>
#include <cmath>

#include "footprint_fit.h"

namespace headway::detect {
namespace {

constexpr double kBoxEdgeSigma = 2.0;  // of the image box's edges [px]
constexpr double kEdgeShare = 0.07;    // or of its width: networks frame what they see roughly
constexpr double kElongated = 1.5;     // length over width from which a heading can be told
constexpr double kAwayFromCamera = -1.5707963267948966;  // rotation_y of a front along +z
constexpr double kDeepestUnknown = 2.0;                  // of an object of unknown size [m]

std::optional<Box2d> clipped(const Box2d& box, const StereoCamera& camera) {
  if (!std::isfinite(box.left + box.top + box.right + box.bottom)) return std::nullopt;
  const Box2d inside{std::max(0.0, box.left), std::max(0.0, box.top),
                     std::min(camera.width - 1.0, box.right),
                     std::min(camera.height - 1.0, box.bottom)};
  if (!(inside.width() > 2.0 && inside.height() > 2.0)) return std::nullopt;
  return inside;
}

// What is known of the class; for an unknown one as deep as it is wide.
ClassSize sizeOf(ObjectClass object_class, const Box2d& box, double depth,
                 const StereoCamera& camera) {
  if (const auto known = classSize(object_class)) return *known;
  const double width = depth * box.width() / camera.fx;
  return {{std::min(width, kDeepestUnknown), width, depth * box.height() / camera.fy}, 0.3};
}

// The height that the box shows, unless the image cuts it.
double heightOf(const Box2d& box, double depth, double usual, const StereoCamera& camera) {
  if (box.top < 1.5 || box.bottom > camera.height - 2.5) return usual;
  return std::clamp(depth * box.height() / camera.fy, 0.6 * usual, 1.6 * usual);
}

double edgeSigma(const Box2d& box) { return std::hypot(kBoxEdgeSigma, kEdgeShare * box.width()); }

// Along the ray: stereo and size; across it: the box's edges.
Eigen::Matrix3d covarianceOf(const Eigen::Vector3d& centre, const Box2d& box, double depth_sigma,
                             const StereoCamera& camera) {
  const double across = edgeSigma(box) * centre.z() / camera.fx + 0.05;
  const Eigen::Vector3d sight = centre.normalized();
  const double along = std::max(depth_sigma, across);
  return across * across * Eigen::Matrix3d::Identity() +
         (along * along - across * across) * sight * sight.transpose();
}

}  // namespace

StereoLifter::StereoLifter(const StereoFrame& frame, const stereo::DisparityParams& params)
    : camera_(frame.camera),
      disparity_(stereo::denseDisparity(frame, validated(params))),
      ground_(stereo::findGround(disparity_, *camera_, std::nullopt)) {}

StereoLifter::StereoLifter(std::shared_ptr<const StereoCamera> camera,
                           stereo::DisparityImage disparity,
                           std::optional<stereo::GroundPlane> ground)
    : camera_(std::move(camera)), disparity_(std::move(disparity)), ground_(std::move(ground)) {}

std::optional<SurfaceDepth> StereoLifter::surfaceOf(const Box2d& box,
                                                    ObjectClass object_class) const {
  const auto inside = clipped(box, *camera_);
  if (!inside) return std::nullopt;
  const auto samples = samplesInside(*inside, disparity_, *camera_, ground_);
  return surfaceDepth(*inside, object_class, samples, *camera_);
}

std::optional<LiftedBox> StereoLifter::lift(const Box2d& box, ObjectClass object_class) const {
  const auto inside = clipped(box, *camera_);
  if (!inside) return std::nullopt;
  const auto samples = samplesInside(*inside, disparity_, *camera_, ground_);
  const auto surface = surfaceDepth(*inside, object_class, samples, *camera_);
  if (!surface) return std::nullopt;

  const double depth = camera_->fx * camera_->baseline_m / surface->disparity;
  const ClassSize known = sizeOf(object_class, *inside, depth, *camera_);
  const bool elongated = known.size.x() > kElongated * known.size.y();
  FittedFootprint fit;
  if (elongated) {
    fit = fitFootprint(*inside, edgeSigma(*inside), known.size.head<2>(), *surface, samples,
                       *camera_);
  } else {
    const double behind = depth + 0.5 * known.size.x();
    const double u = 0.5 * (inside->left + inside->right);
    fit.centre = {behind * (u - camera_->cx) / camera_->fx, behind};
    fit.yaw = kAwayFromCamera;
  }
  LiftedBox lifted;
  lifted.box.length = known.size.x();
  lifted.box.width = known.size.y();
  lifted.box.height = heightOf(*inside, depth, known.size.z(), *camera_);
  lifted.box.yaw = fit.yaw;
  const double v = 0.5 * (inside->top + inside->bottom);
  lifted.box.centre = {fit.centre.x(), depth * (v - camera_->cy) / camera_->fy, fit.centre.y()};
  const double of_stereo = depth * surface->sigma / surface->disparity;
  const double of_size = 0.5 * 0.1 * known.size.x();
  lifted.centre_covariance =
      covarianceOf(lifted.box.centre, *inside, std::hypot(of_stereo, of_size), *camera_);
  Eigen::Matrix<double, 3, 2> ground = Eigen::Matrix<double, 3, 2>::Zero();
  ground(0, 0) = ground(2, 1) = 1.0;
  lifted.centre_covariance += ground * fit.spread * ground.transpose();
  return lifted;
}

void liftAll(Detections& detections, const StereoLifter& lifter) {
  for (auto& detection : detections.items) {
    if (detection.box3d || !detection.box2d) continue;
    const auto lifted = lifter.lift(*detection.box2d, detection.object_class);
    if (!lifted) continue;
    detection.box3d = lifted->box;
    detection.centre_covariance = lifted->centre_covariance;
  }
}

}  // namespace headway::detect
