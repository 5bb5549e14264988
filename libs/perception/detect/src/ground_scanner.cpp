// SPDX-License-Identifier: BSD-3-Clause
// Scans the ground for free space and obstacles, column by column of a disparity image.
#include <headway/core/error.h>
#include <headway/core/scan.h>
#include <headway/core/text.h>
#include <headway/detect/ground_scanner.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "appearance.h"
#include "left_out_cells.h"

namespace headway::detect {
namespace {

constexpr double kMaxUpY = -0.3;  // of "up" in the camera: columns must cross the ground

// Ratios of the minimum height of an obstacle.
constexpr double kUprightRatio = 0.25 / 0.3;  // height that must be matched at one distance,
constexpr double kMatchedRatio = 0.6;         // of that height: texture may be missing
constexpr double kMinRiseRatio = 0.4;         // from its lowest to its highest point

constexpr int kMinRows = 3;              // of an obstacle or a drop
constexpr double kMaxSlope = 0.12;       // of a ramp
constexpr double kDepth = 0.25;          // "one distance" [m]
constexpr double kDisparity = 1.5;       // or this difference of disparities [px]
constexpr double kDistinctSigmas = 2.0;  // between depths of one obstacle that are kept apart
constexpr double kHangingWidth = 0.2;    // of what is seen without its foot: a person is wider [m]
constexpr double kFloatingWidth = 0.4;   // of what ground is seen under: seats and tables [m]
constexpr double kBeyondReach = 1.3;     // of the reach: an obstacle up to here ends a column
constexpr double kContrastSigmas = 3.0;  // between ground and an obstacle that would hide it
// Ground without texture is free where it is shorter than this. A drop as long could not be told
// from it; shorter ones are bridged by a robot, whose length is about its camera's height.
constexpr double kMaxGapRatio = 1.5;  // of the camera's height,
constexpr double kMaxGapRows = 3.0;   // or of the distance between neighbouring rows

/// Scans the columns of a disparity image for free ground and obstacles, see scanGround().
class ColumnScanner {
 public:
  /// All arguments must outlive the scanner.
  ColumnScanner(const stereo::DisparityImage& disparity, const cv::Mat& image,
                const StereoCamera& camera, const stereo::GroundPlane& ground,
                const stereo::RigCapability& rig, const GroundScanParams& params)
      : disparity_(disparity),
        image_(image),
        camera_(camera),
        ground_(ground),
        rig_(rig),
        params_(params),
        fb_(camera.fx * camera.baseline_m),
        matched_to_m_(kBeyondReach * rig.obstacles_to_m),
        obstacles_to_m_(rig.meets_drops
                            ? std::clamp(rig.high_obstacles_to_m, rig.obstacles_to_m, matched_to_m_)
                            : rig.obstacles_to_m) {}

  /// Height from which an obstacle at a depth can be told from ground and ramps [m].
  /// The part of an obstacle that is above the noise of the ground must rise more than a ramp.
  [[nodiscard]] static double minDetectableHeight(const stereo::GroundPlane& ground, double depth) {
    return ground.tolerance(depth) + kMaxSlope * kDepth;
  }

  /// Adds what a column shows.
  /// @param left_out  nonzero where cells of the disparity image are not used
  void scan(int column, const cv::Mat& left_out, GroundScan& scan) {
    read(column, left_out);
    columns_.push_back({column, obstacles()});
    const auto drop = findDrop();
    double free_to = drop ? std::min(rig_.obstacles_to_m, drop->from) : rig_.obstacles_to_m;
    if (!columns_.back().obstacles.empty()) {
      const double nearest = fb_ / columns_.back().obstacles.front().disparity;
      free_to = std::min(free_to, nearest - kContrastSigmas * sigmaAt(nearest));
    }
    for (const auto& piece : freeBefore(free_to)) {
      scan.free.push_back({placeAt(column, piece.from), placeAt(column, piece.to)});
    }
    if (drop && rig_.meets_drops && drop->to <= rig_.obstacles_to_m) {
      const auto sigma = static_cast<float>(sigmaAt(drop->to));
      scan.obstacles.push_back({placeAt(column, drop->to), sigma});
      if (drop->to - drop->from < kMaxGapRatio * ground_.camera_height) {
        scan.obstacles.push_back({placeAt(column, drop->from), sigma});
      }
    }
  }

  /// Adds the obstacles of all columns scanned, of which others agree.
  /// @param step  from one column to the next
  void addObstacles(int step, GroundScan& scan) const {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      for (const auto& obstacle : columns_[i].obstacles) {
        const double nearest = fb_ / obstacle.disparity;
        if (nearest > obstacles_to_m_ || sigmaAt(nearest) > params_.max_error_m) break;
        if (!obstacle.is_certain) continue;
        const auto disparity = agreed(i, obstacle, step);
        if (!disparity) continue;
        // A wall of stripes that is matched a period off seems to hang in front of itself.
        if (disparity_.block_px > 0 && hangs(obstacle.low) &&
            repeats(columns_[i].column, obstacle)) {
          continue;
        }
        const double depth = fb_ / *disparity;
        scan.obstacles.push_back(
            {placeAt(columns_[i].column, depth), static_cast<float>(sigmaAt(depth)),
             static_cast<float>(obstacle.low), static_cast<float>(obstacle.high)});
      }
    }
  }

 private:
  /// A point that may be part of an obstacle.
  struct Raised {
    double disparity;
    double height;  ///< [m]
    int row;
  };
  /// A point of the ground, or below it [m].
  struct Surface {
    double depth;
    double height;
    int row;
  };
  /// What stands at one distance of a column.
  struct Obstacle {
    double disparity;       ///< [px]
    double low, high;       ///< heights between which it is matched [m]
    bool floats;            ///< it hangs, and farther ground is seen under it
    bool is_certain;        ///< false: may be too low; ends free ground, but is not entered
    std::vector<int> rows;  ///< that show it
  };
  struct Column {
    int column;
    std::vector<Obstacle> obstacles;  ///< the nearest first
  };
  /// Depths between which the ground of a column is free [m].
  struct Interval {
    double from;
    double to;
  };

  void read(int column, const cv::Mat& left_out) {
    raised_.clear();
    seen_ground_.clear();
    below_.clear();
    const double x = (disparity_.pixelOf(column) - camera_.cx) / camera_.fx;
    const double least = fb_ / matched_to_m_;
    for (int row = 0; row < disparity_.values.rows; ++row) {
      const double d = disparity_.values.at<float>(row, column);
      if (d < least || left_out.at<std::uint8_t>(row, column) != 0) continue;
      const double y = (disparity_.pixelOf(row) - camera_.cy) / camera_.fy;
      const double depth = fb_ / d;
      const double height = ground_.heightOf(Eigen::Vector3d(x, y, 1.0) * depth);
      if (height > params_.max_obstacle_height_m) continue;
      const double lowest = rig_.obstacleHeight(depth);
      const double clearance = std::max(stereo::kGroundRatio * lowest, ground_.tolerance(depth));
      if (height > clearance) {
        raised_.push_back({d, height, row});
      } else if (height >= -clearance) {
        seen_ground_.push_back({depth, height, row});
      } else if (height <= -lowest) {
        below_.push_back({depth, height, row});
      }
    }
    std::sort(raised_.begin(), raised_.end(),
              [](const Raised& a, const Raised& b) { return a.disparity > b.disparity; });
    std::sort(seen_ground_.begin(), seen_ground_.end(),
              [](const Surface& a, const Surface& b) { return a.depth < b.depth; });
  }

  /// What the robot can drive neither over nor under, the nearest first.
  ///
  /// The nearest stands upright or is higher than a ramp could be, such as the top of a table.
  /// Behind it, whatever is as high as an obstacle is one: it could only be reached through the
  /// nearest.
  [[nodiscard]] std::vector<Obstacle> obstacles() {
    std::vector<Obstacle> found;
    std::size_t last = 0;
    for (std::size_t first = 0; first < raised_.size();) {
      const double d = raised_[first].disparity;
      const double depth = fb_ / d;
      const double farthest = d - std::max(kDisparity, d * kDepth / (depth + kDepth));
      while (last < raised_.size() && raised_[last].disparity >= farthest) ++last;
      const auto stands = [&](double edge) {
        return isUpright(first, last, fb_ / farthest - depth, edge) ||
               isElevated(first, last, !found.empty(), edge);
      };
      if (stands(0.0)) {
        addSurfaces(first, last, stands(edgeAt(depth)), found);
        first = last;
      } else {
        ++first;
      }
    }
    return found;
  }

  /// The median disparity of an obstacle in the columns around its own; nullopt unless most have
  /// it.
  ///
  /// A matched block gives its own width to whatever it sees, so that narrower strips are wrong
  /// matches, of stripes or bricks for instance, which seem to hang in the air before their wall:
  /// what is seen without a foot must be as wide as a person, or, if farther ground is seen under
  /// it, as a seat.
  [[nodiscard]] std::optional<double> agreed(std::size_t index, const Obstacle& obstacle,
                                             int step) const {
    if (disparity_.block_px == 0) return obstacle.disparity;
    const double width = obstacle.floats       ? kFloatingWidth
                         : hangs(obstacle.low) ? kHangingWidth
                                               : 0.0;
    const double width_px =
        std::max<double>(disparity_.block_px, width * camera_.fx * obstacle.disparity / fb_);
    const auto half = static_cast<std::size_t>(0.5 * width_px / (disparity_.reduce * step));
    std::vector<double> around;
    for (std::size_t i = index - std::min(index, half);
         i <= std::min(columns_.size() - 1, index + half); ++i) {
      const auto closest =
          std::min_element(columns_[i].obstacles.begin(), columns_[i].obstacles.end(),
                           [&](const Obstacle& a, const Obstacle& b) {
                             return std::abs(a.disparity - obstacle.disparity) <
                                    std::abs(b.disparity - obstacle.disparity);
                           });
      if (closest == columns_[i].obstacles.end()) continue;
      if (std::abs(closest->disparity - obstacle.disparity) < kDisparity) {
        around.push_back(closest->disparity);
      }
    }
    if (around.size() <= half) return std::nullopt;
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    return *middle;
  }

  /// Whether points at one distance stand.
  /// @param extent  of that distance [m]
  /// @param edge    by which they may seem too high [m]
  [[nodiscard]] bool isUpright(std::size_t first, std::size_t last, double extent,
                               double edge) const {
    const double depth = fb_ / raised_[first].disparity;
    const double least = rig_.obstacleHeight(depth);
    const double rows = kUprightRatio * least * camera_.fy / disparity_.reduce / depth;
    if (static_cast<double>(last - first) < std::max(1.0 * kMinRows, kMatchedRatio * rows)) {
      return false;
    }
    const double top = highest(first, last) - edge;
    const double bottom = lowest(first, last);
    const double rise = std::max(kMinRiseRatio * least, kMaxSlope * extent);
    return top >= least && top - bottom >= rise;
  }

  /// Whether points at one distance have at least a height: enough rows, or behind an obstacle as
  /// many as a horizontal surface would show.
  [[nodiscard]] bool isElevated(std::size_t first, std::size_t last, bool behind,
                                double edge) const {
    const double near = raised_[first].disparity / fb_;
    const double ramp = behind ? 0.0 : kMaxSlope / near;
    const double height = std::max(ramp, rig_.obstacleHeight(1.0 / near));
    const double far = raised_[last - 1].disparity / fb_;
    const double below = std::abs(ground_.camera_height - height);
    const double horizontal = camera_.fy / disparity_.reduce * below * (near - far);
    int rows = 0;
    for (std::size_t i = first; i < last; ++i) rows += raised_[i].height >= height + edge ? 1 : 0;
    const double needed =
        behind ? std::clamp(kMatchedRatio * horizontal, 1.0, 1.0 * kMinRows) : kMinRows;
    return rows >= needed;
  }

  /// By how much a surface seems higher than it is: half a block above its edge, a block still has
  /// its disparity [m].
  [[nodiscard]] double edgeAt(double depth) const {
    return 0.5 * disparity_.block_px * depth / camera_.fy;
  }

  [[nodiscard]] double lowest(std::size_t first, std::size_t last) const {
    double height = params_.max_obstacle_height_m;
    for (std::size_t i = first; i < last; ++i) height = std::min(height, raised_[i].height);
    return height;
  }

  [[nodiscard]] double highest(std::size_t first, std::size_t last) const {
    double height = 0.0;
    for (std::size_t i = first; i < last; ++i) height = std::max(height, raised_[i].height);
    return height;
  }

  /// Appends the medians of the points at one distance, apart where they differ significantly.
  void addSurfaces(std::size_t first, std::size_t last, bool is_certain,
                   std::vector<Obstacle>& found) const {
    const double apart = kDistinctSigmas * params_.sigma_disparity_px;
    const double low = lowest(first, last), high = highest(first, last);
    const bool floats = hangs(low) && isGroundSeenUnder(first, last);
    const std::size_t before = found.size();
    const auto endOf = [&](std::size_t from, double least) {
      while (from < last && raised_[from].disparity >= least) ++from;
      return from;
    };
    for (std::size_t i = first; i < last;) {
      const std::size_t window = endOf(i, raised_[i].disparity - 2.0 * apart);
      const double median = raised_[i + (window - i) / 2].disparity;
      const std::size_t end = std::max(endOf(i, median - apart), i + 1);
      if (end - i >= kMinRows) {
        found.push_back({median, low, high, floats, is_certain, rowsOf(i, end)});
      }
      i = end;
    }
    if (found.size() == before) {
      found.push_back({raised_[(first + last) / 2].disparity, low, high, floats, is_certain,
                       rowsOf(first, last)});
    }
  }

  /// Whether the lowest matched point is as high as an obstacle.
  [[nodiscard]] bool hangs(double low) const { return low > rig_.min_obstacle_height_m; }

  /// Whether ground behind points at one distance is matched below them in the image.
  [[nodiscard]] bool isGroundSeenUnder(std::size_t first, std::size_t last) const {
    int foot = 0;
    for (std::size_t i = first; i < last; ++i) foot = std::max(foot, raised_[i].row);
    const double behind = fb_ / raised_[last - 1].disparity + kDepth;
    const auto rows = std::count_if(
        seen_ground_.begin(), seen_ground_.end(),
        [&](const Surface& ground) { return ground.row > foot && ground.depth > behind; });
    return rows >= kMinRows;
  }

  [[nodiscard]] std::vector<int> rowsOf(std::size_t first, std::size_t last) const {
    std::vector<int> rows;
    for (std::size_t i = first; i < last; ++i) rows.push_back(raised_[i].row);
    return rows;
  }

  /// Whether the image of an obstacle repeats along the rows, around its column.
  [[nodiscard]] bool repeats(int column, const Obstacle& obstacle) const {
    const int side = disparity_.block_px / disparity_.reduce;
    const int first = std::max(0, column - side);
    const int last = std::min(image_.cols - 1, column + side);
    // A few rows will do: a block has smoothed them.
    const std::size_t step = 1 + obstacle.rows.size() / static_cast<std::size_t>(side / 2 + 1);
    std::vector<cv::Point> cells;
    for (std::size_t i = 0; i < obstacle.rows.size(); i += step) {
      for (int x = first; x <= last; ++x) cells.emplace_back(x, obstacle.rows[i]);
    }
    return repeatsAlongRows(image_, cells);
  }

  /// The nearest drop.
  ///
  /// A point below the ground by an obstacle's height proves that there is no ground where its ray
  /// would meet it. It belongs to a drop unless a ramp could lead down to it.
  [[nodiscard]] std::optional<Interval> findDrop() const {
    std::vector<Interval> rims;  // from the last ground to where it is missing
    const double height = ground_.camera_height;
    for (const auto& point : below_) {
      const double missing = point.depth * height / (height - point.height);
      const auto after = std::upper_bound(
          seen_ground_.begin(), seen_ground_.end(), missing,
          [](double depth, const Surface& ground) { return depth < ground.depth; });
      const Surface edge = after == seen_ground_.begin() ? Surface{0.0, 0.0, 0} : *(after - 1);
      const double slope = (edge.height - point.height) / (point.depth - edge.depth);
      if (slope > kMaxSlope) rims.push_back({edge.depth, missing});
    }
    if (rims.size() < kMinRows) return std::nullopt;
    const auto third = rims.begin() + kMinRows - 1;
    std::nth_element(rims.begin(), third, rims.end(), [](const Interval& a, const Interval& b) {
      return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    });
    return *third;
  }

  /// Ground on which an obstacle of the minimum height would have been noticed: it would hide
  /// ground that was matched behind it, at a disparity that differs from its own. Ground seen
  /// across a gap shows that no obstacle stands in the gap, but not that there is ground.
  [[nodiscard]] std::vector<Interval> freeBefore(double depth) const {
    std::vector<Interval> pieces;
    double last = -std::numeric_limits<double>::infinity();
    double ground_from = 0.0;  // of the stretch without a gap
    for (const auto& point : seen_ground_) {
      const double seen = point.depth;
      const double row = seen * seen / (camera_.fy * ground_.camera_height) * disparity_.reduce;
      const double max_gap = std::max(kMaxGapRatio * ground_.camera_height, kMaxGapRows * row);
      const bool joined = seen - last <= max_gap;
      // A far rim looks like ground behind a gap. Roads have no drops, but asphalt hardly any
      // texture.
      if (!joined) {
        ground_from = rig_.meets_drops ? distinctBehind(seen) : seen - max_gap;
      }
      const double from =
          std::max({hiddenFrom(seen), ground_from, joined ? distinctBefore(last) : 0.0});
      const double to = std::min(distinctBefore(seen), depth);
      last = seen;
      if (from >= depth) break;
      if (from >= to) continue;
      if (pieces.empty() || pieces.back().to < from) pieces.push_back({from, to});
      pieces.back().to = std::max(pieces.back().to, to);
    }
    return pieces;
  }

  /// An obstacle of the minimum height hides the ground seen at a depth if it stands from here on.
  [[nodiscard]] double hiddenFrom(double seen) const {
    return seen * (1.0 - std::min(1.0, rig_.min_obstacle_height_m / ground_.camera_height));
  }

  /// An obstacle up to here has another disparity than the ground at a depth.
  [[nodiscard]] double distinctBefore(double seen) const {
    return fb_ / (fb_ / seen + kContrastSigmas * params_.sigma_disparity_px);
  }

  /// Ground from here on has another disparity than the ground at a depth.
  [[nodiscard]] double distinctBehind(double seen) const {
    const double disparity = fb_ / seen - kContrastSigmas * params_.sigma_disparity_px;
    return disparity > 0.0 ? fb_ / disparity : std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] double sigmaAt(double depth) const {
    return params_.sigma_disparity_px * depth * depth / fb_;
  }

  /// Where the column's plane of sight meets the ground at a depth, in the robot's frame.
  [[nodiscard]] Eigen::Vector3f placeAt(int column, double depth) const {
    const double x = depth * (disparity_.pixelOf(column) - camera_.cx) / camera_.fx;
    const double y =
        -(ground_.camera_height + ground_.up.x() * x + ground_.up.z() * depth) / ground_.up.y();
    return (camera_.T_robot_cam * Eigen::Vector3d(x, y, depth)).cast<float>();
  }

  const stereo::DisparityImage& disparity_;
  const cv::Mat& image_;
  const StereoCamera& camera_;
  const stereo::GroundPlane& ground_;
  const stereo::RigCapability& rig_;
  const GroundScanParams& params_;
  double fb_;
  double matched_to_m_;    ///< an obstacle up to here ends a column
  double obstacles_to_m_;  ///< and is entered up to here
  // Points of the column read, by their heights; what is raised and the ground nearest first.
  std::vector<Raised> raised_;
  std::vector<Surface> seen_ground_;
  std::vector<Surface> below_;
  std::vector<Column> columns_;  ///< those scanned
};

}  // namespace

void GroundScanParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("reach", reach_m, 0.0, 100.0, "m",
           "Maximum distance of free cells and of obstacles of the minimum height from the camera; "
           "a robot's grid has higher ones up to 1.3 times as far; 0: derived from the rig");
  user.add(
      "min_obstacle_height_m", min_obstacle_height_m, 0.0, 2.0, "m",
      "Height above ground from which the robot cannot drive over an obstacle; 0: 0.12 m for "
      "a camera mounted below 1 m, near ones from 0.08 m on, else 0.3 m; refused below the noise "
      "of the ground's height");
  user.add("max_obstacle_height_m", max_obstacle_height_m, 0.3, 10.0, "m",
           "Height above ground from which the robot can drive under an obstacle");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px",
              "Noise of an obstacle's disparity");
  section.add("max_error_m", max_error_m, 0.05, 10.0, "m",
              "Maximum uncertainty of the distance of an obstacle that is entered");
}

stereo::RigAssumptions GroundScanParams::configured() const {
  stereo::RigAssumptions result;
  result.min_obstacle_height_m = min_obstacle_height_m;
  result.sigma_disparity_px = sigma_disparity_px;
  result.obstacles_to_m = reach_m;
  return result;
}

stereo::RigCapability GroundScanParams::capabilityOf(const StereoCamera& camera) const {
  const auto rig = stereo::rigCapability(camera, configured());
  if (min_obstacle_height_m <= 0.0) return rig;
  const auto ground = stereo::groundPlane(rig, stereo::mountedUp(camera), rig.camera_height_m);
  const double detectable = ColumnScanner::minDetectableHeight(ground, rig.obstacles_from_m);
  const double centimetres = std::floor(100.0 * detectable);
  if (min_obstacle_height_m < 0.01 * centimetres) {
    throw InputError(formatted(
        "[grid] min_obstacle_height_m = %.3g: this camera tells obstacles from ground and ramps "
        "from %.2f m on (%.3f m is the noise of the ground's height at %.1f m); give that or more, "
        "or 0 for the camera's value",
        min_obstacle_height_m, 0.01 * centimetres, ground.tolerance(rig.obstacles_from_m),
        rig.obstacles_from_m));
  }
  return rig;
}

GroundScan scanGround(const stereo::DisparityImage& disparity, const cv::Mat& image,
                      const StereoCamera& camera, const stereo::GroundPlane& ground,
                      const MovingRegions& moving, const GroundScanParams& params, int step) {
  GroundScan scan;
  if (ground.up.y() > kMaxUpY) return scan;
  const cv::Mat left_out = leftOutCells(moving, disparity);
  const auto rig = stereo::rigCapability(camera, params.configured());
  const auto plane = stereo::groundPlane(rig, ground.up, ground.camera_height);
  ColumnScanner scanner(disparity, image, camera, plane, rig, params);
  for (int column = 0; column < disparity.values.cols; column += step) {
    scanner.scan(column, left_out, scan);
  }
  scanner.addObstacles(step, scan);
  return scan;
}

}  // namespace headway::detect
