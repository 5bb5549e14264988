// SPDX-License-Identifier: BSD-3-Clause
// Corners of images and their ORB descriptors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::slam {

/// A corner of an image.
struct Keypoint {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< [px], level 0
  double score = 0.0;  ///< smaller eigenvalue of its structure tensor, mean squared grey a pixel
};

/// Square cells that spread features over an image.
class FeatureGrid {
 public:
  FeatureGrid() = default;
  /// About `cells` square cells on an image of this size [px].
  FeatureGrid(int width, int height, int cells);

  [[nodiscard]] int count() const { return columns_ * rows_; }
  [[nodiscard]] int cellOf(const Eigen::Vector2d& uv) const;
  [[nodiscard]] cv::Rect pixelsOf(int cell) const;

 private:
  int width_ = 0;
  int height_ = 0;
  int size_ = 1;  ///< side of a cell [px]
  int columns_ = 0;
  int rows_ = 0;
};

/// The best corner of every cell that is still free.
///
/// FAST finds candidates, with a threshold that is lowered in cells without any; Shi-Tomasi's
/// score chooses among them, so that edges lose.
///
/// @param occupied  per cell of the grid: true where no corner is wanted
/// @param excluded  8-bit, non-zero where corners are not allowed; may be empty
/// @see Rosten & Drummond 2006; Shi & Tomasi 1994
[[nodiscard]] std::vector<Keypoint> detectKeypoints(const cv::Mat& image, const FeatureGrid& grid,
                                                    const std::vector<bool>& occupied,
                                                    const cv::Mat& excluded);

/// 256 binary comparisons of the pixels around a corner, turned with it (ORB).
///
/// @see Rublee et al. 2011, "ORB: an efficient alternative to SIFT or SURF"
using Descriptor = std::array<std::uint8_t, 32>;

/// Bits in which two descriptors differ.
[[nodiscard]] int distance(const Descriptor& a, const Descriptor& b);

/// A corner with its descriptor.
struct DescribedPoint {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< [px], level 0
  Descriptor descriptor{};
};

/// Descriptors of given points; all zero for points too near to the border.
[[nodiscard]] std::vector<Descriptor> describe(const cv::Mat& image,
                                               const std::vector<Eigen::Vector2d>& points);

/// The strongest corners of an image at several scales, and others spread evenly over it at full
/// resolution (about `count` of each), with their descriptors.
[[nodiscard]] std::vector<DescribedPoint> detectAndDescribe(const cv::Mat& image, int count,
                                                            const cv::Mat& excluded);

/// Descriptors of points, in their order.
[[nodiscard]] std::vector<Descriptor> descriptorsOf(const std::vector<DescribedPoint>& points);

/// Bits in which two views of one corner differ at most, of 256: of unrelated ones half differ.
inline constexpr int kMaxDescriptorDistance = 64;

/// Which descriptors, by their indices, are of one corner: these do not compete with each other.
struct SameCorner {
  std::function<bool(int, int)> in_a = [](int, int) { return false; };
  std::function<bool(int, int)> in_b = [](int, int) { return false; };
};

/// Index pairs (a, b) of descriptors that are each other's clearly nearest.
///
/// @see Lowe 2004, sec. 7.1 (ratio of the nearest to the second nearest)
[[nodiscard]] std::vector<std::pair<int, int>> matchDescriptors(const std::vector<Descriptor>& a,
                                                                const std::vector<Descriptor>& b,
                                                                const SameCorner& are_one = {});

}  // namespace headway::slam
