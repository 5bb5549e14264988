// SPDX-License-Identifier: BSD-3-Clause
// Dense disparities of a stereo pair or of a depth camera.
#pragma once

#include <headway/core/params.h>
#include <headway/core/stereo_frame.h>

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::stereo {

/// The image at 1/reduce of its size, each pixel the mean of those that it stands for; the image
/// itself, not a copy, where that is 1.
inline cv::Mat reducedImage(const cv::Mat& image, int reduce) {
  if (reduce == 1) return image;
  cv::Mat result;
  cv::resize(image, result, {image.cols / reduce, image.rows / reduce}, 0, 0, cv::INTER_AREA);
  return result;
}

/// How stereo pairs are matched densely. Section [disparity].
struct DisparityParams {
  enum class Method { kBlocks, kSemiGlobal };

  Method method = Method::kBlocks;
  int reduce = 2;              ///< images are matched at 1/reduce of their size [-]
  double nearest_m = 0.0;      ///< minimum depth matched; 0: RigCapability::nearest_m [m]
  int block_px = 7;            ///< side of a block in the reduced image, made odd [px]
  int uniqueness_percent = 0;  ///< margin of the best match over the second best [%]
  int min_speckle_px = 40;     ///< minimum area of a connected region, reduced image [px]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "disparity"); }  ///< @throws InputError
};

/// Disparities of a left image, on a grid `reduce` times coarser than its pixels.
struct DisparityImage {
  cv::Mat values;  ///< 32-bit float, [px] of the full image; 0 where there is none
  int reduce = 1;  ///< pixels of the full image to one cell, each way
  /// Side of the blocks that were matched, by half of which edges may be displaced; 0: of a depth
  /// camera [px of the full image]
  int block_px = 0;

  [[nodiscard]] bool empty() const { return values.empty(); }
  /// Full-image coordinate of a cell's centre (its column or its row) [px].
  [[nodiscard]] double pixelOf(int cell) const { return (cell + 0.5) * reduce - 0.5; }
  /// Cell that holds a full-image coordinate; may lie outside of the grid.
  [[nodiscard]] int cellOf(double pixel) const;
  /// Disparity at a full-image pixel [px]; 0 where there is none or outside.
  [[nodiscard]] float at(double u, double v) const;
  /// Ratio of the cells with a disparity, 0 to 1.
  [[nodiscard]] double coverage() const;
};

/// A surface with a greater disparity than this is nearer, by a fifth. Of what is compared from
/// frame to frame beside it, its edge may be all that moves.
template <typename Disparity>
[[nodiscard]] auto nearerThan(const Disparity& disparity) {
  return 1.2 * disparity + 1.0;
}
/// The greatest disparity within a reach of each cell.
///
/// @param disparities  32-bit
[[nodiscard]] cv::Mat nearestAround(const cv::Mat& disparities, int reach_cells);

/// Least depth of which disparities are searched in a stereo pair [m]; infinite if it is too
/// narrow.
[[nodiscard]] double nearestMatched(const StereoCamera& camera, const DisparityParams& params);

/// Matches a stereo pair densely; the same result on any number of cores. Of a depth camera, its
/// disparities on the same grid, without small regions.
///
/// Matched both ways, without speckles: cells without texture, hidden in the right image or nearer
/// than `nearest_m` hold 0. A picture too narrow to match gives an image of zeros.
///
/// @see  Konolige 1998, "Small vision systems" (blocks); Hirschmueller 2008 (semi-global)
[[nodiscard]] DisparityImage denseDisparity(const StereoFrame& frame,
                                            const DisparityParams& params);

}  // namespace headway::stereo
