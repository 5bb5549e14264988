// SPDX-License-Identifier: BSD-3-Clause
// Depth, size and heading of 2D boxes by stereo.
#include <headway/core/detection.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>
#include <headway/detect/stereo_lifter.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "object_extent.h"

namespace headway::detect {

std::optional<ClassSize> classSize(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kCar:
      return ClassSize{{4.0, 1.65, 1.52}, 0.09};
    case ObjectClass::kVan:
      return ClassSize{{5.1, 1.9, 2.2}, 0.14};
    case ObjectClass::kTruck:
      return ClassSize{{9.5, 2.55, 3.2}, 0.15};
    case ObjectClass::kPedestrian:
      return ClassSize{{0.7, 0.6, 1.74}, 0.07};
    case ObjectClass::kPersonSitting:
      return ClassSize{{0.8, 0.6, 1.27}, 0.1};
    case ObjectClass::kCyclist:
      return ClassSize{{1.75, 0.6, 1.73}, 0.07};
    case ObjectClass::kTram:
      return ClassSize{{16.0, 2.5, 3.5}, 0.15};
    case ObjectClass::kUnknown:
    case ObjectClass::kMisc:
      break;
  }
  return std::nullopt;
}

namespace {

/// One stereo measurement inside a box.
struct DisparitySample {
  double u = 0.0;          ///< [px], full image
  double v = 0.0;          ///< [px]
  double disparity = 0.0;  ///< [px]
};

constexpr double kBoxMargin = 0.05;    // of the box's width and height left out at each edge
constexpr double kMinWeight = 4.0;     // of the samples that make a mode, in cells
constexpr double kBoxSigma = 2.0;      // of the box's edges [px]
constexpr double kShapeSpread = 0.08;  // of what is seen of a size over the size: poses, tilt
constexpr double kPriorFloor = 0.05;   // weight of a mode that contradicts the size
constexpr double kGridStep = 1.015;    // from one disparity tried to the next

// Disparities this near to each other are one surface [px].
double bandwidthAt(double disparity) { return std::max(0.6, 0.035 * disparity); }

// Disparity at which an object of the class would be as high as the box, with its error.
struct SizePrior {
  double disparity = 0.0;  // [px]
  double spread = 0.0;     // ratio to it
};

std::optional<SizePrior> sizePrior(const Box2d& box, ObjectClass object_class,
                                   const StereoCamera& camera) {
  const auto known = classSize(object_class);
  const bool cut = box.top < 1.5 || box.bottom > camera.height - 2.5;
  if (!known || cut || !(box.height() > 4.0)) return std::nullopt;
  const double depth = camera.fy * known->size.z() / box.height();
  const double edges = kBoxSigma / box.height();
  return SizePrior{
      camera.fx * camera.baseline_m / depth,
      std::sqrt(known->spread * known->spread + kShapeSpread * kShapeSpread + edges * edges)};
}

double agreement(const std::optional<SizePrior>& prior, double disparity) {
  if (!prior) return 1.0;
  const double off = std::log(disparity / prior->disparity) / (1.5 * prior->spread);
  return kPriorFloor + (1.0 - kPriorFloor) * std::exp(-0.5 * off * off);
}

// A sample in the box's middle counts in full, one at its sides hardly.
double centrality(const Box2d& box, const DisparitySample& sample) {
  const double off = (sample.u - 0.5 * (box.left + box.right)) / (0.35 * box.width());
  return std::exp(-0.5 * off * off);
}

struct Weighted {
  double disparity;
  double weight;
};

double weightNear(const std::vector<Weighted>& sorted, double disparity) {
  const double reach = bandwidthAt(disparity);
  auto it = std::lower_bound(sorted.begin(), sorted.end(), disparity - reach,
                             [](const Weighted& a, double b) { return a.disparity < b; });
  double total = 0.0;
  for (; it != sorted.end() && it->disparity <= disparity + reach; ++it) total += it->weight;
  return total;
}

// The disparity of the winning mode; nullopt if none has enough samples.
std::optional<double> modeOf(const std::vector<Weighted>& sorted,
                             const std::optional<SizePrior>& prior) {
  double best = 0.0;
  double best_score = 0.0;
  for (double d = sorted.front().disparity; d <= sorted.back().disparity * kGridStep;
       d *= kGridStep) {
    const double weight = weightNear(sorted, d);
    const double score = weight * agreement(prior, d);
    if (weight < kMinWeight || score <= best_score) continue;
    best = d;
    best_score = score;
  }
  if (best_score <= 0.0) return std::nullopt;
  return best;
}

// Weighted median of the samples of a mode.
SurfaceDepth surfaceAt(double mode, const std::vector<Weighted>& sorted) {
  const double reach = 1.5 * bandwidthAt(mode);
  std::vector<Weighted> members;
  double total = 0.0;
  for (const auto& sample : sorted) {
    if (std::abs(sample.disparity - mode) > reach) continue;
    members.push_back(sample);
    total += sample.weight;
  }
  double passed = 0.0;
  for (const auto& member : members) {
    passed += member.weight;
    if (passed >= 0.5 * total) {
      const double scatter = reach / std::sqrt(total);
      return {member.disparity, std::hypot(kSurfaceSigma_px, scatter),
              static_cast<int>(members.size())};
    }
  }
  return {mode, std::hypot(kSurfaceSigma_px, reach), static_cast<int>(members.size())};
}

/// Stereo measurements inside a box, without those on the ground.
std::vector<DisparitySample> samplesInside(const Box2d& box,
                                           const stereo::DisparityImage& disparity,
                                           const StereoCamera& camera,
                                           const std::optional<stereo::GroundPlane>& ground) {
  std::vector<DisparitySample> samples;
  const double side = kBoxMargin * box.width();
  const double end = kBoxMargin * box.height();
  const int first_row = std::max(0, disparity.cellOf(box.top + end));
  const int last_row = std::min(disparity.values.rows - 1, disparity.cellOf(box.bottom - end));
  const int first_column = std::max(0, disparity.cellOf(box.left + side));
  const int last_column = std::min(disparity.values.cols - 1, disparity.cellOf(box.right - side));
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const double d = disparity.values.at<float>(row, column);
      if (!(d > 0.5)) continue;
      const DisparitySample sample{disparity.pixelOf(column), disparity.pixelOf(row), d};
      if (ground) {
        if (ground->isGround(*triangulate({sample.u, sample.v, d}, camera))) continue;
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

/// Depth of an object by the mode of the stereo measurements inside its box.
///
/// Background seen past the object or through its windows and occluders before it make modes of
/// their own; the mode wins that has most measurements near the box's middle and agrees with the
/// depth at which an object of the class would be as high as the box. Without stereo
/// measurements that height alone determines it, with its large error.
///
/// @return  nullopt without enough measurements and without a known size (expected, not an error)
std::optional<SurfaceDepth> surfaceDepth(const Box2d& box, ObjectClass object_class,
                                         const std::vector<DisparitySample>& samples,
                                         const StereoCamera& camera) {
  const auto prior = sizePrior(box, object_class, camera);
  std::vector<Weighted> sorted;
  sorted.reserve(samples.size());
  for (const auto& sample : samples) {
    sorted.push_back({sample.disparity, centrality(box, sample)});
  }
  std::sort(sorted.begin(), sorted.end(), [](const Weighted& a, const Weighted& b) {
    return std::tie(a.disparity, a.weight) < std::tie(b.disparity, b.weight);
  });
  const auto mode = sorted.empty() ? std::nullopt : modeOf(sorted, prior);
  if (!mode && !prior) return std::nullopt;
  if (!mode) return SurfaceDepth{prior->disparity, prior->disparity * prior->spread, 0};
  return surfaceAt(*mode, sorted);
}

/// A rectangle of known size on the ground, placed so that it explains what stereo saw of it.
struct FittedFootprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< (x, z), camera frame [m]
  double yaw = 0.0;  ///< KITTI's rotation_y, front taken to look away from the camera [rad]
  /// Of the centre (x, z): what the headings that explain it as well leave open [m^2].
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
};

constexpr int kHeadings = 36;                  // tried in half a turn
constexpr double kColumnsThatCount = 12.0;     // neighbouring columns err together
constexpr double kColumnDisparitySigma = 0.5;  // of a column [px]
constexpr double kShapeSigma = 0.2;            // of a real side off a flat one [m]

struct Column {
  double slope;  // x over z of its ray
  double depth;  // [m]
};

// Robust depth of each column of cells, of those samples that may belong to the object.
std::vector<Column> columnsOf(const std::vector<DisparitySample>& samples, double surface_depth,
                              double reach, const StereoCamera& camera) {
  const double fb = camera.fx * camera.baseline_m;
  std::map<double, std::vector<double>> depths;
  for (const auto& sample : samples) {
    const double depth = fb / sample.disparity;
    const double noise = 0.02 * depth + depth * depth / fb;
    if (depth < surface_depth - 0.4 * reach - noise || depth > surface_depth + reach + noise) {
      continue;
    }
    depths[sample.u].push_back(depth);
  }
  std::vector<Column> columns;
  for (auto& [u, values] : depths) {
    if (values.size() < 3) continue;
    columns.push_back({(u - camera.cx) / camera.fx, median(std::move(values))});
  }
  return columns;
}

struct Rectangle {
  Eigen::Vector2d centre;  // (x, z)
  Eigen::Vector2d along;   // unit
  Eigen::Vector2d half;    // along, across

  [[nodiscard]] Eigen::Vector2d across() const { return {-along.y(), along.x()}; }

  // Depth at which a ray from the camera first meets it; nullopt if it misses.
  [[nodiscard]] std::optional<double> depthAlong(double slope) const {
    const Eigen::Vector2d ray(slope, 1.0);
    double enter = 0.0;
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d direction = axis == 0 ? along : across();
      const double speed = direction.dot(ray);
      const double start = direction.dot(centre);
      if (std::abs(speed) < 1e-9) {
        if (std::abs(start) > half[axis]) return std::nullopt;
        continue;
      }
      const double a = (start - half[axis]) / speed;
      const double b = (start + half[axis]) / speed;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter > leave || enter <= 0.0) return std::nullopt;
    return enter;
  }

  // Slopes of the outermost rays that touch it.
  [[nodiscard]] std::pair<double, double> outline() const {
    double min = std::numeric_limits<double>::infinity();
    double max = -min;
    for (const int i : {-1, 1}) {
      for (const int j : {-1, 1}) {
        const Eigen::Vector2d corner = centre + i * half.x() * along + j * half.y() * across();
        const double slope = corner.x() / std::max(0.3, corner.y());
        min = std::min(min, slope);
        max = std::max(max, slope);
      }
    }
    return {min, max};
  }
};

// The image box's left and right edge as rays; edges cut by the image are not used.
struct Edges {
  Edges(const Box2d& box, double edge_sigma, const StereoCamera& camera)
      : left((box.left - camera.cx) / camera.fx),
        right((box.right - camera.cx) / camera.fx),
        left_seen(box.left > 1.5),
        right_seen(box.right < camera.width - 2.5),
        sigma(edge_sigma / camera.fx) {}

  double left, right;
  bool left_seen, right_seen;
  double sigma;

  // Moves the rectangle sideways to where its outline fits best.
  void align(Rectangle& rectangle) const {
    const auto [min, max] = rectangle.outline();
    const bool both = left_seen == right_seen;
    const double off = both        ? 0.5 * (left + right - min - max)
                       : left_seen ? left - min
                                   : right - max;
    rectangle.centre.x() += off * rectangle.centre.y();
  }

  [[nodiscard]] double error(const Rectangle& rectangle) const {
    if (!left_seen || !right_seen) return 0.0;
    const auto [min, max] = rectangle.outline();
    const double width = right - left;
    const double off = (max - min - width) / std::hypot(1.4 * sigma, kShapeSpread * width);
    return off * off;
  }
};

// Median of how much deeper the columns lie than the rectangle's sides; 0 if no ray meets it.
double medianOffset(const Rectangle& rectangle, const std::vector<Column>& columns) {
  std::vector<double> offsets;
  for (const auto& column : columns) {
    if (const auto depth = rectangle.depthAlong(column.slope)) {
      offsets.push_back(column.depth - *depth);
    }
  }
  return median(std::move(offsets));
}

double columnError(const Rectangle& rectangle, const std::vector<Column>& columns, double fb) {
  double total = 0.0;
  for (const auto& column : columns) {
    const auto depth = rectangle.depthAlong(column.slope);
    const double sigma =
        std::hypot(kShapeSigma, kColumnDisparitySigma * column.depth * column.depth / fb);
    const double off = depth ? (column.depth - *depth) / sigma : 1e9;
    // Beyond three sigmas a column is an outlier.
    total += std::min(off * off, square(3.0));
  }
  const auto count = static_cast<double>(columns.size());
  return total * std::min(1.0, kColumnsThatCount / std::max(1.0, count));
}

/// The rectangle of a heading behind the visible surface, moved to where columns and edges fit
/// best.
Rectangle placed(double yaw, const Eigen::Vector2d& size, double depth, const Edges& edges,
                 const std::vector<Column>& columns) {
  const double middle = 0.5 * (edges.left + edges.right);
  Rectangle rectangle;
  rectangle.along = {std::cos(yaw), -std::sin(yaw)};
  rectangle.half = 0.5 * size;
  const Eigen::Vector2d sight = Eigen::Vector2d(middle, 1.0).normalized();
  const double behind =
      std::min(rectangle.half.x() / std::max(1e-9, std::abs(rectangle.along.dot(sight))),
               rectangle.half.y() / std::max(1e-9, std::abs(rectangle.across().dot(sight))));
  rectangle.centre = (depth + behind) * Eigen::Vector2d(middle, 1.0);
  for (int pass = 0; pass < 3; ++pass) {
    edges.align(rectangle);
    rectangle.centre *= 1.0 + medianOffset(rectangle, columns) / rectangle.centre.y();
  }
  return rectangle;
}

/// Places an upright box of known length and width behind the surface seen in an image box.
///
/// For each heading the box is put where its sides, seen from the camera, have the depths measured
/// in the columns of the image box, and its outline the image box's edges (those not cut by the
/// image). The heading with the least robust error wins: the visible side's slope decides, and the
/// width of the image box where that is unclear.
///
/// @param edge_sigma  of each of the image box's edges [px]
/// @param size     length and width [m]
/// @param surface  depth of the visible surface
FittedFootprint fitFootprint(const Box2d& box, double edge_sigma, const Eigen::Vector2d& size,
                             const SurfaceDepth& surface,
                             const std::vector<DisparitySample>& samples,
                             const StereoCamera& camera) {
  const double fb = camera.fx * camera.baseline_m;
  const double depth = fb / surface.disparity;
  const auto columns = columnsOf(samples, depth, size.norm(), camera);
  const Edges edges(box, edge_sigma, camera);

  std::array<double, kHeadings> errors{};
  std::array<Rectangle, kHeadings> rectangles;
  for (int i = 0; i < kHeadings; ++i) {
    const double yaw = -M_PI * i / kHeadings;  // front away from the camera: z >= 0
    rectangles[i] = placed(yaw, size, depth, edges, columns);
    errors[i] = edges.error(rectangles[i]) + columnError(rectangles[i], columns, fb);
  }

  const int best =
      static_cast<int>(std::min_element(errors.begin(), errors.end()) - errors.begin());
  FittedFootprint fit;
  fit.centre = rectangles[best].centre;
  fit.yaw = wrapAngle(-M_PI * best / kHeadings);
  double weights = 0.0;
  for (int i = 0; i < kHeadings; ++i) {
    const double weight = std::exp(-0.5 * (errors[i] - errors[best]));
    const Eigen::Vector2d off = rectangles[i].centre - fit.centre;
    weights += weight;
    fit.spread += weight * off * off.transpose();
  }
  fit.spread /= weights;
  return fit;
}

constexpr double kEdgeWidthRatio = 0.07;  // or of its width: networks frame what they see roughly
constexpr double kElongated = 1.5;        // length over width from which a heading can be told
constexpr double kDeepestUnknown = 2.0;   // of an object of unknown size [m]

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

double edgeSigma(const Box2d& box) { return std::hypot(kBoxSigma, kEdgeWidthRatio * box.width()); }

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
    fit.yaw = -0.5 * M_PI;  // front along +z: away from the camera
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
