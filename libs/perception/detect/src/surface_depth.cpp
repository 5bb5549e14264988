// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/class_size.h>
#include <headway/detect/surface_depth.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr double kBoxMargin = 0.05;    // of the box's width and height left out at each edge
constexpr double kMinWeight = 4.0;     // of the samples that make a mode, in cells
constexpr double kStereoSigma = 0.3;   // of one surface's disparity, common to its cells [px]
constexpr double kBoxSigma = 2.0;      // of the box's edges [px]
constexpr double kShapeSpread = 0.08;  // of projected height over true height: poses, tilt
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
      return {member.disparity, std::hypot(kStereoSigma, scatter),
              static_cast<int>(members.size())};
    }
  }
  return {mode, std::hypot(kStereoSigma, reach), static_cast<int>(members.size())};
}

}  // namespace

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

}  // namespace headway::detect
