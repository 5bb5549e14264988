// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::slam {

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

/// Index pairs (a, b) of descriptors that are each other's clearly nearest.
///
/// @see Lowe 2004, sec. 7.1 (ratio of the nearest to the second nearest)
[[nodiscard]] std::vector<std::pair<int, int>> matchDescriptors(const std::vector<Descriptor>& a,
                                                                const std::vector<Descriptor>& b);

}  // namespace headway::slam
