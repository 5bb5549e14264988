// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/geo/georeference.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "planar_alignment.h"

namespace headway::geo {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kDegree = M_PI / 180.0;
constexpr std::size_t kMinFixes = 10;
constexpr double kMinExtentM = 5.0;
constexpr double kMaxHeadingSigma = 5.0 * kDegree;
constexpr double kTiltSigma = 2.0 * kDegree;
constexpr double kUpOverHorizontal = 1.7;  // standard deviation of altitudes; of most receivers
constexpr double kMinSigmaM = 0.1;         // the map is not more accurate
constexpr int kIterations = 8;

std::vector<PositionPair> pairsOf(const std::vector<FixOnMap>& fixes, const GeodeticFrame& frame) {
  std::vector<PositionPair> pairs;
  pairs.reserve(fixes.size());
  for (const auto& [fix, in_map] : fixes) {
    pairs.push_back({in_map, frame.enuOf({fix.latitude_deg, fix.longitude_deg, fix.altitude_m}),
                     std::max(fix.sigma_m, kMinSigmaM)});
  }
  return pairs;
}

/// The frame at the fixes' median, since any of them may be wrong.
GeodeticFrame amidst(const std::vector<FixOnMap>& fixes) {
  const GnssFix& first = fixes.front().fix;
  const GeodeticFrame any({first.latitude_deg, first.longitude_deg, first.altitude_m});
  std::vector<double> east, north, up;
  for (const PositionPair& pair : pairsOf(fixes, any)) {
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
double heightSpread(const Pose& T_enu_map, const std::vector<PositionPair>& pairs) {
  constexpr double kSigmaOfMedian = 1.4826;
  std::vector<double> residuals;
  for (const auto& pair : pairs) {
    const double residual = (T_enu_map * pair.in_map - pair.enu).z();
    residuals.push_back(std::abs(residual) / (kUpOverHorizontal * pair.sigma));
  }
  return std::max(1.0, kSigmaOfMedian * median(std::move(residuals)));
}

void addTiltPrior(const Pose& T_enu_map, Matrix6& information, Vector6& gradient) {
  const Eigen::Vector3d up = T_enu_map.linear().col(2);
  Eigen::Matrix<double, 2, 6> jacobian = Eigen::Matrix<double, 2, 6>::Zero();
  jacobian.rightCols<3>() = -crossMatrix(up).topRows<2>();
  information += jacobian.transpose() * jacobian / square(kTiltSigma);
  gradient += jacobian.transpose() * up.head<2>() / square(kTiltSigma);
}

PoseFit fitPose(const std::vector<PositionPair>& pairs, Pose T_enu_map) {
  PoseFit fit;
  for (int i = 0; i < kIterations; ++i) {
    const double height_spread = heightSpread(T_enu_map, pairs);
    fit.information.setZero();
    Vector6 gradient = Vector6::Zero();
    for (const auto& pair : pairs) {
      const Eigen::Vector3d arm = T_enu_map.linear() * pair.in_map;
      const Eigen::Vector3d residual = arm + T_enu_map.translation() - pair.enu;
      Eigen::Matrix<double, 3, 6> jacobian;
      jacobian << Eigen::Matrix3d::Identity(), -crossMatrix(arm);
      const double up_sigma = kUpOverHorizontal * pair.sigma * height_spread;
      const double cauchy = 1.0 / (1.0 + square(residual.z() / (2.0 * up_sigma)));
      const Eigen::Vector3d weights(1.0 / square(pair.sigma), 1.0 / square(pair.sigma),
                                    cauchy / square(up_sigma));
      fit.information += jacobian.transpose() * weights.asDiagonal() * jacobian;
      gradient += jacobian.transpose() * weights.asDiagonal() * residual;
    }
    addTiltPrior(T_enu_map, fit.information, gradient);
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
  constexpr double kMaxCorrelation = 0.98;
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
                     const GeodeticFrame& first_frame, const Pose& first_pose) {
  Georeference result;
  Pose T_enu_map = first_pose;
  result.frame = first_frame;
  std::vector<PositionPair> agreeing;
  PoseFit fit;
  for (int i = 0; i < 2; ++i) {  // the second time, the frame is exactly the map's
    result.frame = GeodeticFrame(result.frame.positionOf(T_enu_map.translation()));
    T_enu_map.translation().setZero();
    agreeing = agreeingOf(pairsOf(fixes, result.frame), planar);
    fit = fitPose(agreeing, T_enu_map);
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

std::variant<Georeference, NoGeoreference> georeference(const std::vector<FixOnMap>& fixes) {
  if (fixes.size() < kMinFixes) {
    return NoGeoreference{"only " + std::to_string(fixes.size()) +
                          " fixes at times with a pose, at least " + std::to_string(kMinFixes) +
                          " are needed"};
  }
  const GeodeticFrame frame = amidst(fixes);
  const auto pairs = pairsOf(fixes, frame);
  const double extent = horizontalExtent(pairs);
  if (extent < kMinExtentM) return NoGeoreference{shortWay(extent)};
  const auto planar = alignPlanar(pairs);
  if (!planar || 2 * planar->agreeing() < fixes.size() || planar->agreeing() < kMinFixes) {
    return NoGeoreference{"the fixes contradict each other or the map"};
  }
  const Georeference result =
      refined(fixes, *planar, frame, liftedPose(*planar, agreeingOf(pairs, *planar)));
  if (!(result.headingSigmaDeg() * kDegree <= kMaxHeadingSigma)) {
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
