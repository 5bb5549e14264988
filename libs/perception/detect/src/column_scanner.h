// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/scan.h>
#include <headway/detect/ground_scanner.h>
#include <headway/stereo/rig_capability.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::detect {

/// Scans the columns of a disparity image for free ground and obstacles, see scanGround().
class ColumnScanner {
 public:
  /// @param params  without 0; all arguments must outlive the scanner
  ColumnScanner(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                const stereo::GroundPlane& ground, const stereo::RigCapability& rig,
                const GroundScanParams& params);

  /// Height from which an obstacle at a depth can be told from ground and ramps [m].
  [[nodiscard]] static double minDetectableHeight(const stereo::GroundPlane& ground, double depth);

  /// Adds what a column shows.
  /// @param left_out  nonzero where cells of the disparity image are not used
  void scan(int column, const cv::Mat& left_out, GroundScan& scan);

 private:
  /// A point that may be part of an obstacle.
  struct Raised {
    double disparity;
    double height;  ///< [m]
  };
  /// A point of the ground, or below it [m].
  struct Surface {
    double depth;
    double height;
  };
  /// Depths between which the ground of a column is free [m].
  struct Interval {
    double from;
    double to;
  };

  void read(int column, const cv::Mat& left_out);
  [[nodiscard]] std::vector<double> obstacleDepths() const;
  [[nodiscard]] bool isUpright(std::size_t first, std::size_t last, double extent) const;
  [[nodiscard]] bool isElevated(std::size_t first, std::size_t last, bool behind) const;
  void addDepths(std::size_t first, std::size_t last, std::vector<double>& depths) const;
  [[nodiscard]] std::optional<Interval> findDrop() const;
  [[nodiscard]] std::vector<Interval> freeBefore(double depth) const;

  [[nodiscard]] double hiddenFrom(double seen) const;
  [[nodiscard]] double distinctBefore(double seen) const;
  [[nodiscard]] double distinctBehind(double seen) const;
  [[nodiscard]] double sigmaAt(double depth) const;
  [[nodiscard]] Eigen::Vector3f placeAt(int column, double depth) const;

  const stereo::DisparityImage& disparity_;
  const StereoCamera& camera_;
  const stereo::GroundPlane& ground_;
  const GroundScanParams& params_;
  double fb_;
  bool meets_drops_;
  double matched_to_m_;    ///< an obstacle up to here ends a column
  double obstacles_to_m_;  ///< and is entered up to here
  // Points of the column read, by their heights; what is raised and the ground nearest first.
  std::vector<Raised> raised_;
  std::vector<Surface> seen_ground_;
  std::vector<Surface> below_;
};

}  // namespace headway::detect
