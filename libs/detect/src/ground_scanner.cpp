#include <headway/detect/ground_scanner.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace headway::detect {
namespace {

// Ratios of the minimum height of an obstacle.
constexpr double kUprightRatio = 0.25 / 0.3;  // height that must be matched at one distance,
constexpr double kMatchedRatio = 0.6;         // of that height: texture may be missing
constexpr double kMinRiseRatio = 0.4;         // from its lowest to its highest point

constexpr int kMinRows = 3;              // of an obstacle
constexpr double kMaxSlope = 0.12;       // of a ramp
constexpr double kDepth = 0.25;          // "one distance" [m]
constexpr double kDisparity = 1.5;       // or this difference of disparities [px]
constexpr int kMarginCells = 2;          // block matching widens objects by half a block
constexpr double kMaxUpY = -0.3;         // of "up" in the camera: columns must cross the ground
constexpr double kBeyondReach = 1.3;     // an obstacle up to here ends a column
constexpr double kContrastSigmas = 3.0;  // between ground and an obstacle that would hide it

// Cells of the disparity image to leave out.
cv::Mat leftOut(const MovingRegions& moving, const stereo::DisparityImage& disparity) {
  cv::Mat mask(disparity.values.size(), CV_8U, cv::Scalar(0));
  if (!moving.mask.empty()) {
    cv::resize(moving.mask, mask, mask.size(), 0, 0, cv::INTER_NEAREST);
  }
  const cv::Rect inside({0, 0}, mask.size());
  const auto fill = [&](const Box2d& box) {
    const cv::Point corner(disparity.cellOf(box.left), disparity.cellOf(box.top));
    const cv::Point opposite(disparity.cellOf(box.right) + 1, disparity.cellOf(box.bottom) + 1);
    mask(cv::Rect(corner, opposite) & inside).setTo(255);
  };
  for (const auto& box : moving.boxes) fill(box);
  for (const auto& box : moving.unsure) fill(box);
  const int side = 2 * kMarginCells + 1;
  cv::dilate(mask, mask, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return mask;
}

/// Part of a column that may stand.
struct Upright {
  double disparity;
  double height;
};

/// Depths between which the ground of a column is free [m].
struct Interval {
  double from;
  double to;
};

class ColumnScanner {
 public:
  ColumnScanner(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                const stereo::GroundPlane& ground, const GroundScanParams& params)
      : disparity_(disparity),
        camera_(camera),
        ground_(ground),
        params_(params),
        fb_(camera.fx * camera.baseline_m) {}

  void scan(int column, const cv::Mat& left_out, GroundScan& scan) {
    read(column, left_out);
    const auto end = nearestUpright();
    const double free_to = end ? fb_ / *end - sigmaAt(fb_ / *end) : params_.reach_m;
    for (const auto& piece : freeBefore(free_to)) {
      scan.free.push_back({placeAt(column, piece.from), placeAt(column, piece.to)});
    }
    if (!end) return;
    const double depth = fb_ / *end;
    if (depth > params_.reach_m || sigmaAt(depth) > params_.max_error_m) return;
    scan.obstacles.push_back({placeAt(column, depth), static_cast<float>(sigmaAt(depth))});
  }

 private:
  void read(int column, const cv::Mat& left_out) {
    upright_.clear();
    ground_seen_.clear();
    const double x = (disparity_.pixelOf(column) - camera_.cx) / camera_.fx;
    const double least = fb_ / (kBeyondReach * params_.reach_m);
    for (int row = 0; row < disparity_.values.rows; ++row) {
      const double d = disparity_.values.at<float>(row, column);
      if (d < least || left_out.at<std::uint8_t>(row, column) != 0) continue;
      const double y = (disparity_.pixelOf(row) - camera_.cy) / camera_.fy;
      const double depth = fb_ / d;
      const double height = ground_.heightOf(Eigen::Vector3d(x, y, 1.0) * depth);
      const double clearance = ground_.clearance(depth);
      if (height > params_.max_obstacle_height_m || height < -clearance) continue;
      if (height > clearance) {
        upright_.push_back({d, height});
      } else {
        ground_seen_.push_back(depth);
      }
    }
  }

  /// Disparity of the nearest thing that stands in the column read.
  std::optional<double> nearestUpright() {
    std::sort(upright_.begin(), upright_.end(),
              [](const Upright& a, const Upright& b) { return a.disparity > b.disparity; });
    std::size_t last = 0;
    for (std::size_t first = 0; first < upright_.size(); ++first) {
      const double d = upright_[first].disparity;
      const double depth = fb_ / d;
      const double least = d - std::max(kDisparity, d * kDepth / (depth + kDepth));
      while (last < upright_.size() && upright_[last].disparity >= least) ++last;
      const double rows =
          kUprightRatio * params_.min_obstacle_height_m * camera_.fy / disparity_.reduce / depth;
      if (static_cast<double>(last - first) < std::max(1.0 * kMinRows, kMatchedRatio * rows)) {
        continue;
      }
      double sum = 0.0;
      double top = 0.0;
      double bottom = params_.max_obstacle_height_m;
      for (std::size_t i = first; i < last; ++i) {
        sum += upright_[i].disparity;
        top = std::max(top, upright_[i].height);
        bottom = std::min(bottom, upright_[i].height);
      }
      const double rise = std::max(kMinRiseRatio * params_.min_obstacle_height_m,
                                   kMaxSlope * (fb_ / least - depth));
      if (top < params_.min_obstacle_height_m || top - bottom < rise) continue;
      return sum / static_cast<double>(last - first);
    }
    return std::nullopt;
  }

  /// Ground on which an obstacle of the minimum height would have been noticed: it would hide
  /// ground that was matched behind it, at a disparity that differs from its own.
  std::vector<Interval> freeBefore(double depth) {
    std::sort(ground_seen_.begin(), ground_seen_.end());
    const double end = std::min(depth, params_.reach_m);
    std::vector<Interval> pieces;
    for (const double seen : ground_seen_) {
      const double from = hiddenFrom(seen);
      const double to = std::min(distinctBefore(seen), end);
      if (from >= end) break;
      if (from >= to) continue;
      if (pieces.empty() || pieces.back().to < from) pieces.push_back({from, to});
      pieces.back().to = std::max(pieces.back().to, to);
    }
    return pieces;
  }

  /// An obstacle of the minimum height hides the ground seen at a depth if it stands from here on.
  [[nodiscard]] double hiddenFrom(double seen) const {
    return seen * (1.0 - std::min(1.0, params_.min_obstacle_height_m / ground_.camera_height));
  }

  /// An obstacle up to here has another disparity than the ground at a depth.
  [[nodiscard]] double distinctBefore(double seen) const {
    return fb_ / (fb_ / seen + kContrastSigmas * params_.sigma_disparity_px);
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
  const StereoCamera& camera_;
  const stereo::GroundPlane& ground_;
  const GroundScanParams& params_;
  double fb_;
  std::vector<Upright> upright_;     ///< of the column read
  std::vector<double> ground_seen_;  ///< depths, of the column read [m]
};

}  // namespace

void GroundScanParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("reach", reach_m, 0.0, 100.0, "m",
           "Maximum distance of free and occupied cells from the camera; 0: derived from the rig");
  user.add("min_obstacle_height_m", min_obstacle_height_m, 0.0, 2.0, "m",
           "Height above ground from which the robot cannot drive over an obstacle; 0: 0.12 m for "
           "a camera mounted below 1 m, else 0.3 m");
  user.add("max_obstacle_height_m", max_obstacle_height_m, 0.3, 10.0, "m",
           "Height above ground from which the robot can drive under an obstacle");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px",
              "Noise of an obstacle's disparity");
  section.add("max_error_m", max_error_m, 0.05, 10.0, "m",
              "Maximum uncertainty of the distance of an obstacle that is entered");
  section.renamed({{"lowest_obstacle", "min_obstacle_height_m"},
                   {"highest_obstacle", "max_obstacle_height_m"},
                   {"sigma_disparity", "sigma_disparity_px"},
                   {"most_error", "max_error_m"}});
}

stereo::RigCapability GroundScanParams::capabilityOf(const StereoCamera& camera) const {
  auto rig = stereo::rigCapability(camera, {min_obstacle_height_m, sigma_disparity_px});
  if (reach_m > 0.0) rig.obstacles_to_m = reach_m;
  return rig;
}

GroundScanParams GroundScanParams::forRig(const stereo::RigCapability& rig) const {
  GroundScanParams params = *this;
  params.reach_m = rig.obstacles_to_m;
  params.min_obstacle_height_m = rig.min_obstacle_height_m;
  return params;
}

GroundScan scanGround(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                      const stereo::GroundPlane& ground, const MovingRegions& moving,
                      const GroundScanParams& params) {
  GroundScan scan;
  if (ground.up.y() > kMaxUpY) return scan;
  const cv::Mat left_out = leftOut(moving, disparity);
  const auto rig = params.capabilityOf(camera);
  const GroundScanParams for_rig = params.forRig(rig);
  const auto plane = stereo::groundPlane(rig, ground.up, ground.camera_height);
  ColumnScanner scanner(disparity, camera, plane, for_rig);
  for (int column = 0; column < disparity.values.cols; ++column) {
    scanner.scan(column, left_out, scan);
  }
  return scan;
}

}  // namespace headway::detect
