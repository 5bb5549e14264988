// SPDX-License-Identifier: BSD-3-Clause
// Probability of a contact between footprints, by the predicted paths of tracks and their
// covariance.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/track.h>

#include <optional>
#include <vector>

namespace headway::map {

/// Footprint of an object or robot: a rectangle or its inscribed ellipse. All zero: a point.
struct FootprintShape {
  double length_m = 0.0;
  double width_m = 0.0;
  bool round = false;

  /// Of the smallest circle about the centre that encloses it [m].
  [[nodiscard]] double radius() const;

  /// Its farthest point along a direction, both in its own axes, x along length_m [m].
  [[nodiscard]] Eigen::Vector2d supportPoint(const Eigen::Vector2d& normal) const;
};

/// The footprint of a track: elliptic for people, else a rectangle.
[[nodiscard]] FootprintShape footprintOf(const Track& track);

/// The positions of b's centre relative to a's at which the footprints overlap.
///
/// Their Minkowski sum, as a convex polygon in counter-clockwise order. Ellipses are replaced by
/// inscribed polygons, at most 0.5 % too small.
///
/// @param yaw_a, yaw_b  of the footprints' fronts [rad]
/// @return              corners, map axes [m]
[[nodiscard]] std::vector<Eigen::Vector2d> contactRegion(const FootprintShape& a, double yaw_a,
                                                         const FootprintShape& b, double yaw_b);

/// Standard deviations beyond which a position is not expected.
inline constexpr double kContactSigmas = 5.0;

/// The probability that a normally distributed point lies in a convex polygon, to about 1 %.
///
/// @param polygon     corners in order; fewer than three: the result is 0
/// @param covariance  of the point [m^2]; variances are at least (1 cm)^2
[[nodiscard]] double probabilityInside(const std::vector<Eigen::Vector2d>& polygon,
                                       const Eigen::Vector2d& mean,
                                       const Eigen::Matrix2d& covariance);

/// Position of an object at one time along one of its predicted paths.
struct PathSample {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();      ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of the centre [m^2]
};

/// Interpolates a predicted path linearly between its points, and the track itself at time zero.
///
/// Beyond its last point the path is extrapolated straight, with a covariance that grows at the
/// same rate. A path without points remains at the track's position.
///
/// @param horizon_s  from the track's time; negative counts as zero [s]
[[nodiscard]] PathSample samplePath(const Track& track, const PredictedPath& path,
                                    double horizon_s);

/// Combines the probabilities of contacts with several tracks, each with several predicted paths:
/// the paths of one track exclude each other, the tracks are independent.
class ContactSum {
 public:
  /// Adds one predicted path; the paths of one track must be added consecutively.
  ///
  /// @param of_future   probability of the path
  /// @param of_contact  probability of a contact, given the path
  void add(TrackId track, double of_future, double of_contact);

  /// Probability of a contact with at least one track.
  double total();

  /// The track of the most probable contact, after total().
  [[nodiscard]] std::optional<TrackId> mostProbable() const { return most_probable_; }

 private:
  void closeTrack();

  std::optional<TrackId> current_, most_probable_;
  double of_track_ = 0.0;
  double max_probability_ = 0.0;
  double none_ = 1.0;
};

}  // namespace headway::map
