// SPDX-License-Identifier: BSD-3-Clause
// Patches around points, aligned between images.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace headway::stereo {

/// Side of the square that is compared between images [px]; a multiple of 4 keeps rows in SIMD.
inline constexpr int kPatchSize = 12;

/// Appearance of a landmark: pixels around it, at one pyramid level.
struct ReferencePatch {
  static constexpr int kSize = 32;
  std::array<std::uint8_t, kSize * kSize> pixels{};
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();  ///< of the landmark within `pixels` [px]
};

/// Cuts the surroundings of a point out of an image; beyond the border its edge is repeated.
///
/// @param uv  in pixels of this image (level)
[[nodiscard]] ReferencePatch cutReference(const cv::Mat& image, const Eigen::Vector2d& uv);

/// Patch to be aligned: values less their mean, gradients, and their normal equations.
struct Patch {
  static constexpr int kArea = kPatchSize * kPatchSize;
  alignas(16) std::array<float, kArea> value{};
  alignas(16) std::array<float, kArea> du{};
  alignas(16) std::array<float, kArea> dv{};
  float mean = 0.0F;
  float energy = 0.0F;                               ///< sum of value^2
  Eigen::Matrix4f normal = Eigen::Matrix4f::Zero();  ///< of (du, dv, value, 1)
};

/// The patch around a point of an image; nullopt where it would leave the image.
[[nodiscard]] std::optional<Patch> cutPatch(const cv::Mat& image, const Eigen::Vector2d& uv);

/// The patch warped to another view.
///
/// @param reference_from_view  2x2: a step of one pixel in the view, in pixels of the reference
/// @return                     nullopt where the view asks for more than the reference holds
[[nodiscard]] std::optional<Patch> warpPatch(const ReferencePatch& reference,
                                             const Eigen::Matrix2d& reference_from_view);

/// Axes along which an alignment may move.
enum class AlignmentAxes { kBoth, kRow };

/// Where a patch was found.
struct Alignment {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< pixels of the image searched
  double zncc = -1.0;                            ///< correlation there, -1 ... 1
  bool converged = false;                        ///< the last step was small
};

/// Moves a patch over an image until both agree up to gain and offset of brightness.
///
/// Inverse compositional Gauss-Newton: gradients come from the patch alone, so the normal matrix
/// is inverted once. Converges from about half a patch away.
///
/// @param start  initial position, pixels of `image`
/// @return       nullopt if the patch has no texture, leaves the image or diverges
/// @see          Baker & Matthews 2004, "Lucas-Kanade 20 years on", sec. 3.2
[[nodiscard]] std::optional<Alignment> align(const Patch& patch, const cv::Mat& image,
                                             const Eigen::Vector2d& start, AlignmentAxes axes,
                                             int max_iterations = 10);

}  // namespace headway::stereo
