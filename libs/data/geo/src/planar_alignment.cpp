// SPDX-License-Identifier: BSD-3-Clause
#include "planar_alignment.h"

#include <headway/core/random.h>
#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>

namespace headway::geo {
namespace {

constexpr int kHypotheses = 600;         // half of the pairs wrong: 1 in 10^70 has none right
constexpr std::size_t kMaxJudges = 500;  // pairs that judge a hypothesis
constexpr double kMedianOfChi2 = 1.386;  // of two degrees of freedom
constexpr double kMaxChi2 = 11.83;       // 99.73 % of two degrees of freedom
constexpr int kRefinements = 20;

double squaredResidual(const PlanarAlignment& alignment, const PositionPair& pair) {
  const Eigen::Vector2d moved =
      Eigen::Rotation2Dd(alignment.yaw) * pair.in_map.head<2>() + alignment.shift;
  return (moved - pair.enu.head<2>()).squaredNorm() / square(pair.sigma);
}

double medianResidual(const PlanarAlignment& alignment, const std::vector<PositionPair>& pairs) {
  std::vector<double> residuals;
  const std::size_t step = std::max<std::size_t>(1, pairs.size() / kMaxJudges);
  for (std::size_t i = 0; i < pairs.size(); i += step) {
    residuals.push_back(squaredResidual(alignment, pairs[i]));
  }
  return median(std::move(residuals));
}

/// The alignment that moves one pair onto the other; nullopt if their distances differ.
std::optional<PlanarAlignment> alignmentOf(const PositionPair& a, const PositionPair& b,
                                           double min_distance) {
  const Eigen::Vector2d in_map = (b.in_map - a.in_map).head<2>();
  const Eigen::Vector2d enu = (b.enu - a.enu).head<2>();
  constexpr double kMaxScaleError = 0.1;  // of a drifting map
  const double tolerance = 4.0 * std::hypot(a.sigma, b.sigma) + kMaxScaleError * in_map.norm();
  if (in_map.norm() < min_distance || std::abs(in_map.norm() - enu.norm()) > tolerance) {
    return std::nullopt;
  }
  PlanarAlignment alignment;
  alignment.yaw = std::atan2(enu.y(), enu.x()) - std::atan2(in_map.y(), in_map.x());
  const Eigen::Vector2d middle = 0.5 * (a.in_map + b.in_map).head<2>();
  alignment.shift = 0.5 * (a.enu + b.enu).head<2>() - Eigen::Rotation2Dd(alignment.yaw) * middle;
  return alignment;
}

/// The hypothesis with the least median residual.
std::optional<PlanarAlignment> consensus(const std::vector<PositionPair>& pairs) {
  const double min_distance = 0.3 * horizontalExtent(pairs);
  Random random(seedOf({pairs.size()}));
  std::optional<PlanarAlignment> best;
  double best_residual = 0.0;
  const int count = static_cast<int>(pairs.size());
  for (int i = 0; i < kHypotheses; ++i) {
    const auto& a = pairs[static_cast<std::size_t>(random.below(count))];
    const auto& b = pairs[static_cast<std::size_t>(random.below(count))];
    const auto hypothesis = alignmentOf(a, b, min_distance);
    if (!hypothesis) continue;
    const double residual = medianResidual(*hypothesis, pairs);
    if (best && residual >= best_residual) continue;
    best = hypothesis;
    best_residual = residual;
  }
  return best;
}

/// Marks the pairs that agree with an alignment. @return whether any mark has changed
bool markAgreeing(const std::vector<PositionPair>& pairs, PlanarAlignment& alignment) {
  alignment.spread = std::max(1.0, std::sqrt(medianResidual(alignment, pairs) / kMedianOfChi2));
  const double limit = kMaxChi2 * square(alignment.spread);
  std::vector<bool> agrees;
  agrees.reserve(pairs.size());
  for (const auto& pair : pairs) agrees.push_back(squaredResidual(alignment, pair) <= limit);
  const bool has_changed = agrees != alignment.agrees;
  alignment.agrees = std::move(agrees);
  return has_changed;
}

/// The weighted least-squares alignment of the agreeing pairs.
void fitAgreeing(const std::vector<PositionPair>& pairs, PlanarAlignment& alignment) {
  double sum = 0.0;
  Eigen::Vector2d map_mean = Eigen::Vector2d::Zero(), enu_mean = Eigen::Vector2d::Zero();
  const auto visit = [&](const auto& add) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (alignment.agrees[i]) add(pairs[i], 1.0 / square(pairs[i].sigma));
    }
  };
  visit([&](const PositionPair& pair, double weight) {
    sum += weight;
    map_mean += weight * pair.in_map.head<2>();
    enu_mean += weight * pair.enu.head<2>();
  });
  if (sum <= 0.0) return;
  map_mean /= sum;
  enu_mean /= sum;
  double sine = 0.0, cosine = 0.0;
  visit([&](const PositionPair& pair, double weight) {
    const Eigen::Vector2d a = pair.in_map.head<2>() - map_mean, b = pair.enu.head<2>() - enu_mean;
    sine += weight * (a.x() * b.y() - a.y() * b.x());
    cosine += weight * a.dot(b);
  });
  alignment.yaw = std::atan2(sine, cosine);
  alignment.shift = enu_mean - Eigen::Rotation2Dd(alignment.yaw) * map_mean;
}

}  // namespace

std::size_t PlanarAlignment::agreeing() const {
  return static_cast<std::size_t>(std::count(agrees.begin(), agrees.end(), true));
}

double horizontalExtent(const std::vector<PositionPair>& pairs) {
  double extent = 0.0;
  for (const auto& pair : pairs) {
    extent = std::max(extent, (pair.in_map - pairs.front().in_map).head<2>().norm());
  }
  return extent;
}

std::optional<PlanarAlignment> alignPlanar(const std::vector<PositionPair>& pairs) {
  auto alignment = consensus(pairs);
  if (!alignment) return std::nullopt;
  for (int i = 0; i < kRefinements && markAgreeing(pairs, *alignment); ++i) {
    fitAgreeing(pairs, *alignment);
  }
  return alignment;
}

}  // namespace headway::geo
