// SPDX-License-Identifier: BSD-3-Clause
// Place of a map on the earth by the fixes of a satellite receiver, of which half may be wrong.
#include <headway/core/pose.h>
#include <headway/core/random.h>
#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/geo/georeference.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace headway::geo {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A position in two frames whose z axes point up.
struct PositionPair {
  Eigen::Vector3d in_map = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d enu = Eigen::Vector3d::Zero();     ///< measured [m]
  double sigma = 1.0;                                ///< of each horizontal axis [m]
};

/// Rotation about the vertical and horizontal shift from a map to the earth.
struct PlanarAlignment {
  double yaw = 0.0;                                 ///< [rad]
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< [m]
  double spread = 1.0;       ///< of the residuals, times the receiver's sigma; at least 1
  std::vector<bool> agrees;  ///< for each pair

  [[nodiscard]] std::size_t agreeing() const {
    return static_cast<std::size_t>(std::count(agrees.begin(), agrees.end(), true));
  }
};

/// Greatest horizontal distance from the first position in the map [m].
double horizontalExtent(const std::vector<PositionPair>& pairs) {
  double extent = 0.0;
  for (const auto& pair : pairs) {
    extent = std::max(extent, (pair.in_map - pairs.front().in_map).head<2>().norm());
  }
  return extent;
}

constexpr int kHypotheses = 600;         // half of the pairs wrong: 1 in 10^70 has none right
constexpr std::size_t kMaxJudges = 500;  // pairs that judge a hypothesis
constexpr double kMedianOfChi2 = 1.386;  // of two degrees of freedom
constexpr double kMaxChi2 = 11.83;       // 99.73 % of two degrees of freedom
constexpr int kRefinements = 20;         // the marks settle within a few

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

/// The alignment on which most pairs agree, with the weighted mean over these; nullopt if the way
/// is too short for any. See georeference().
std::optional<PlanarAlignment> alignPlanar(const std::vector<PositionPair>& pairs) {
  auto alignment = consensus(pairs);
  if (!alignment) return std::nullopt;
  for (int i = 0; i < kRefinements && markAgreeing(pairs, *alignment); ++i) {
    fitAgreeing(pairs, *alignment);
  }
  return alignment;
}

std::vector<PositionPair> pairsOf(const std::vector<FixOnMap>& fixes, const GeodeticFrame& frame,
                                  double min_sigma_m) {
  std::vector<PositionPair> pairs;
  pairs.reserve(fixes.size());
  for (const auto& [fix, in_map] : fixes) {
    pairs.push_back({in_map, frame.enuOf({fix.latitude_deg, fix.longitude_deg, fix.altitude_m}),
                     std::max(fix.sigma_m, min_sigma_m)});
  }
  return pairs;
}

/// The frame at the fixes' median, since any of them may be wrong.
GeodeticFrame amidst(const std::vector<FixOnMap>& fixes) {
  const GnssFix& first = fixes.front().fix;
  const GeodeticFrame any({first.latitude_deg, first.longitude_deg, first.altitude_m});
  std::vector<double> east, north, up;
  for (const PositionPair& pair : pairsOf(fixes, any, 0.0)) {
    east.push_back(pair.enu.x());
    north.push_back(pair.enu.y());
    up.push_back(pair.enu.z());
  }
  return GeodeticFrame(any.positionOf({median(east), median(north), median(up)}));
}

std::vector<PositionPair> agreeingOf(const std::vector<PositionPair>& pairs,
                                     const PlanarAlignment& alignment) {
  std::vector<PositionPair> agreeing;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (alignment.agrees[i]) agreeing.push_back(pairs[i]);
  }
  return agreeing;
}

/// The alignment with the median height of all pairs.
Pose liftedPose(const PlanarAlignment& alignment, const std::vector<PositionPair>& pairs) {
  std::vector<double> heights;
  for (const auto& pair : pairs) heights.push_back(pair.enu.z() - pair.in_map.z());
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(alignment.yaw, Eigen::Vector3d::UnitZ()).matrix();
  pose.translation() << alignment.shift, median(std::move(heights));
  return pose;
}

/// Least squares of pose and tilt, by increments in east, north, up axes at the map's origin.
struct PoseFit {
  Pose T_enu_map = Pose::Identity();
  Matrix6 information = Matrix6::Zero();
};

/// Robust standard deviation of the heights' residuals, in units of theirs, at least 1.
double heightSpread(const Pose& T_enu_map, const std::vector<PositionPair>& pairs,
                    double up_over_horizontal) {
  std::vector<double> residuals;
  for (const auto& pair : pairs) {
    const double residual = (T_enu_map * pair.in_map - pair.enu).z();
    residuals.push_back(std::abs(residual) / (up_over_horizontal * pair.sigma));
  }
  return std::max(1.0, kSigmaOfMedian * median(std::move(residuals)));
}

void addTiltPrior(const Pose& T_enu_map, double sigma, Matrix6& information, Vector6& gradient) {
  const Eigen::Vector3d up = T_enu_map.linear().col(2);
  Eigen::Matrix<double, 2, 6> jacobian = Eigen::Matrix<double, 2, 6>::Zero();
  jacobian.rightCols<3>() = -crossMatrix(up).topRows<2>();
  information += jacobian.transpose() * jacobian / square(sigma);
  gradient += jacobian.transpose() * up.head<2>() / square(sigma);
}

PoseFit fitPose(const std::vector<PositionPair>& pairs, Pose T_enu_map,
                const GeoreferenceParams& params) {
  constexpr int kIterations = 8;  // of a fit that starts within degrees
  PoseFit fit;
  for (int i = 0; i < kIterations; ++i) {
    const double height_spread = heightSpread(T_enu_map, pairs, params.up_over_horizontal);
    fit.information.setZero();
    Vector6 gradient = Vector6::Zero();
    for (const auto& pair : pairs) {
      const Eigen::Vector3d arm = T_enu_map.linear() * pair.in_map;
      const Eigen::Vector3d residual = arm + T_enu_map.translation() - pair.enu;
      Eigen::Matrix<double, 3, 6> jacobian;
      jacobian << Eigen::Matrix3d::Identity(), -crossMatrix(arm);
      const double up_sigma = params.up_over_horizontal * pair.sigma * height_spread;
      const double cauchy = 1.0 / (1.0 + square(residual.z() / (2.0 * up_sigma)));
      const Eigen::Vector3d weights(1.0 / square(pair.sigma), 1.0 / square(pair.sigma),
                                    cauchy / square(up_sigma));
      fit.information += jacobian.transpose() * weights.asDiagonal() * jacobian;
      gradient += jacobian.transpose() * weights.asDiagonal() * residual;
    }
    addTiltPrior(T_enu_map, params.tilt_sigma_deg * kDegree, fit.information, gradient);
    const Vector6 step = -fit.information.ldlt().solve(gradient);
    T_enu_map.translation() += step.head<3>();
    T_enu_map.linear() = expSo3(step.tail<3>()) * T_enu_map.linear();
  }
  fit.T_enu_map = normalized(T_enu_map);
  return fit;
}

/// What the covariance of independent errors with the receiver's sigma is multiplied by: the
/// observed spread, and the correlation of errors that follow each other.
double covarianceFactor(const Pose& T_enu_map, const std::vector<PositionPair>& pairs) {
  constexpr double kMaxCorrelation = 0.98;  // at 1 there would be no information
  double squares = 0.0, products = 0.0;
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
  for (const auto& pair : pairs) {
    const Eigen::Vector2d residual = (T_enu_map * pair.in_map - pair.enu).head<2>() / pair.sigma;
    squares += residual.squaredNorm();
    products += residual.dot(last);
    last = residual;
  }
  const double variance = squares / (2.0 * static_cast<double>(pairs.size()) - 3.0);
  const double correlation =
      squares > 0.0 ? std::clamp(products / squares, 0.0, kMaxCorrelation) : 0.0;
  return std::max(1.0, variance * (1.0 + correlation) / (1.0 - correlation));
}

double horizontalRmse(const Pose& T_enu_map, const std::vector<PositionPair>& pairs) {
  double sum = 0.0;
  for (const auto& pair : pairs) {
    sum += (T_enu_map * pair.in_map - pair.enu).head<2>().squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(pairs.size()));
}

std::string shortWay(double extent) {
  return formatted("the way between the fixes is too short for a heading (%.1f m)", extent);
}

/// The pose in the frame at the map's origin, from a first estimate in the frame of a fix.
Georeference refined(const std::vector<FixOnMap>& fixes, const PlanarAlignment& planar,
                     const GeodeticFrame& first_frame, const Pose& first_pose,
                     const GeoreferenceParams& params) {
  Georeference result;
  Pose T_enu_map = first_pose;
  result.frame = first_frame;
  std::vector<PositionPair> agreeing;
  PoseFit fit;
  for (int i = 0; i < 2; ++i) {  // the second time, the frame is exactly the map's
    result.frame = GeodeticFrame(result.frame.positionOf(T_enu_map.translation()));
    T_enu_map.translation().setZero();
    agreeing = agreeingOf(pairsOf(fixes, result.frame, params.min_sigma_m), planar);
    fit = fitPose(agreeing, T_enu_map, params);
    T_enu_map = fit.T_enu_map;
  }
  result.rmse_m = horizontalRmse(T_enu_map, agreeing);
  result.covariance =
      covarianceFactor(T_enu_map, agreeing) * fit.information.ldlt().solve(Matrix6::Identity());
  result.frame = GeodeticFrame(result.frame.positionOf(T_enu_map.translation()));
  result.T_enu_map.linear() = T_enu_map.linear();
  result.used = agreeing.size();
  result.rejected = fixes.size() - agreeing.size();
  return result;
}

}  // namespace

double Georeference::headingDeg() const {
  const double heading = 90.0 - yawOf(T_enu_map) / kDegree;
  return heading - 360.0 * std::floor(heading / 360.0);
}

double Georeference::headingSigmaDeg() const { return std::sqrt(covariance(5, 5)) / kDegree; }

double Georeference::originSigma() const { return std::sqrt(covariance(0, 0) + covariance(1, 1)); }

std::variant<Georeference, NoGeoreference> georeference(const std::vector<FixOnMap>& fixes,
                                                        const GeoreferenceParams& params) {
  if (fixes.size() < params.min_fixes) {
    return NoGeoreference{"only " + std::to_string(fixes.size()) +
                          " fixes at times with a pose, at least " +
                          std::to_string(params.min_fixes) + " are needed"};
  }
  const GeodeticFrame frame = amidst(fixes);
  const auto pairs = pairsOf(fixes, frame, params.min_sigma_m);
  const double extent = horizontalExtent(pairs);
  if (extent < params.min_extent_m) return NoGeoreference{shortWay(extent)};
  const auto planar = alignPlanar(pairs);
  if (!planar || 2 * planar->agreeing() < fixes.size() || planar->agreeing() < params.min_fixes) {
    return NoGeoreference{"the fixes contradict each other or the map"};
  }
  const Georeference result =
      refined(fixes, *planar, frame, liftedPose(*planar, agreeingOf(pairs, *planar)), params);
  if (!(result.headingSigmaDeg() <= params.max_heading_sigma_deg)) {
    return NoGeoreference{shortWay(extent) + formatted(": it would be uncertain by %.1f degrees",
                                                       result.headingSigmaDeg())};
  }
  // A spread as wide as the way agrees with any heading.
  if (!(result.rmse_m <= 0.2 * extent)) {
    return NoGeoreference{formatted("the fixes deviate from the map by %.1f m on a way of %.1f m",
                                    result.rmse_m, extent)};
  }
  return result;
}

}  // namespace headway::geo
