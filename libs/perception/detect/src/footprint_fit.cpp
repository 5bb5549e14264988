// SPDX-License-Identifier: BSD-3-Clause
#include "footprint_fit.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace headway::detect {
namespace {

constexpr int kHeadings = 36;  // tried in half a turn
constexpr double kPi = 3.14159265358979323846;
constexpr double kColumnsThatCount = 12.0;     // neighbouring columns err together
constexpr double kColumnDisparitySigma = 0.5;  // of a column [px]
constexpr double kShapeSigma = 0.2;            // of a real side off a flat one [m]
constexpr double kSizeSpread = 0.08;           // of length and width
constexpr double kWorst = 9.0;                 // squared error at which a column is an outlier

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
    const double off = (max - min - width) / std::hypot(1.4 * sigma, kSizeSpread * width);
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
    total += std::min(off * off, kWorst);
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

}  // namespace

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
    const double yaw = -kPi * i / kHeadings;  // front away from the camera: z >= 0
    rectangles[i] = placed(yaw, size, depth, edges, columns);
    errors[i] = edges.error(rectangles[i]) + columnError(rectangles[i], columns, fb);
  }

  const int best =
      static_cast<int>(std::min_element(errors.begin(), errors.end()) - errors.begin());
  FittedFootprint fit;
  fit.centre = rectangles[best].centre;
  fit.yaw = wrapAngle(-kPi * best / kHeadings);
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

}  // namespace headway::detect
