// SPDX-License-Identifier: BSD-3-Clause
// Dense disparities of a stereo pair or of a depth camera.
#include <headway/stereo/disparity.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "block_matcher.h"

namespace headway::stereo {
namespace {

constexpr int kSpeckleRange = 2;  // between neighbours in a region [px of the reduced image]
// Between the pixels of one surface within a cell:
constexpr float kSurfaceStep = 2.0F;        // [px]
constexpr float kSurfaceStepRatio = 0.02F;  // or this ratio of the disparity

// Disparities to search, a multiple of 16 that leaves half of the picture to match; 0: too narrow.
int searchRange(const StereoCamera& camera, const DisparityParams& params, int width) {
  RigAssumptions configured;
  configured.nearest_m = params.nearest_m;
  const double nearest_m = rigCapability(camera, configured).nearest_m;
  const double largest = camera.fx * camera.baseline_m / nearest_m / params.reduce;
  const int wanted = (static_cast<int>(std::ceil(largest)) + 15) / 16 * 16;
  return std::min(wanted, (width / 2) / 16 * 16);
}

cv::Mat widened(const cv::Mat& image, int columns) {
  cv::Mat result;
  cv::copyMakeBorder(image, result, 0, 0, columns, 0, cv::BORDER_REPLICATE);
  return result;
}

// Leaves 0 where nothing was matched, or something left of the right image.
void dropMatchesOutside(DisparityImage& disparity) {
  for (int column = 0; column < disparity.values.cols; ++column) {
    const auto max = static_cast<float>(disparity.pixelOf(column));
    for (int row = 0; row < disparity.values.rows; ++row) {
      float& d = disparity.values.at<float>(row, column);
      if (d < 0.0F || d > max) d = 0.0F;
    }
  }
}

int blockSide(const DisparityParams& params) {
  const bool is_semi_global = params.method == DisparityParams::Method::kSemiGlobal;
  return is_semi_global ? std::min(params.block_px | 1, 5) : params.block_px | 1;
}

cv::Ptr<cv::StereoMatcher> makeMatcher(const DisparityParams& params, int range) {
  if (params.method == DisparityParams::Method::kSemiGlobal) {
    const int side = blockSide(params);
    auto matcher = cv::StereoSGBM::create(0, range, side, 8 * side * side, 32 * side * side);
    matcher->setUniquenessRatio(params.uniqueness_percent);
    return matcher;
  }
  auto matcher = blockMatcher(range, blockSide(params));
  matcher->setUniquenessRatio(params.uniqueness_percent);
  return matcher;
}

/// Mean of a cell's nearest surface; 0 if less than a half of the cell has disparities.
float cellValue(const cv::Mat& cell) {
  float nearest = 0.0F;
  int known = 0;
  for (int row = 0; row < cell.rows; ++row) {
    for (const auto* d = cell.ptr<float>(row); d != cell.ptr<float>(row) + cell.cols; ++d) {
      nearest = std::max(nearest, *d);
      known += *d > 0.0F ? 1 : 0;
    }
  }
  if (2 * known < static_cast<int>(cell.total())) return 0.0F;
  const float least = nearest - std::max(kSurfaceStep, kSurfaceStepRatio * nearest);
  float sum = 0.0F;
  int count = 0;
  for (int row = 0; row < cell.rows; ++row) {
    for (const auto* d = cell.ptr<float>(row); d != cell.ptr<float>(row) + cell.cols; ++d) {
      if (*d < least || *d <= 0.0F) continue;
      sum += *d;
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<float>(count) : 0.0F;
}

/// Removes small regions, as stereo matching does: a depth camera's are as often wrong.
void removeSpeckles(int min_area, DisparityImage& disparity) {
  cv::Mat fixed;
  disparity.values.convertTo(fixed, CV_16S, static_cast<double>(kSubpixels) / disparity.reduce);
  cv::filterSpeckles(fixed, 0, min_area, kSpeckleRange * kSubpixels);
  disparity.values.setTo(0.0F, fixed == 0);
}

/// The disparities that a depth camera gives, on the grid of matched ones.
DisparityImage givenDisparities(const StereoFrame& frame, const DisparityParams& params) {
  DisparityImage result;
  const int reduce = result.reduce = params.reduce;
  const cv::Mat& given = frame.disparity;
  result.values = cv::Mat(given.rows / reduce, given.cols / reduce, CV_32F, cv::Scalar(0));
  for (int row = 0; row < result.values.rows; ++row) {
    for (int column = 0; column < result.values.cols; ++column) {
      result.values.at<float>(row, column) =
          cellValue(given(cv::Rect(reduce * column, reduce * row, reduce, reduce)));
    }
  }
  if (params.min_speckle_px > 0) removeSpeckles(params.min_speckle_px, result);
  return result;
}

}  // namespace

void DisparityParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("method", method, {{"blocks", Method::kBlocks}, {"semi_global", Method::kSemiGlobal}},
           "Dense stereo matching; semi_global is denser and five times slower");
  user.add("nearest_m", nearest_m, 0.0, 50.0, "m",
           "Minimum depth matched; smaller is slower; 0: derived from the rig");
  section.add("reduce", reduce, 1, 4, "", "Factor by which images are reduced before matching");
  section.add("block_px", block_px, 5, 31, "px", "Side of a block in the reduced image, made odd");
  section.add("uniqueness_percent", uniqueness_percent, 0, 50, "%",
              "Margin by which the best match must beat the second best");
  section.add("min_speckle_px", min_speckle_px, 0, 1000, "px",
              "Minimum area of a connected region, in the reduced image");
}

int DisparityImage::cellOf(double pixel) const {
  return static_cast<int>(std::floor((pixel + 0.5) / reduce));
}

float DisparityImage::at(double u, double v) const {
  const int column = cellOf(u);
  const int row = cellOf(v);
  const bool inside = column >= 0 && row >= 0 && column < values.cols && row < values.rows;
  return inside ? values.at<float>(row, column) : 0.0F;
}

double DisparityImage::coverage() const {
  if (values.empty()) return 0.0;
  return cv::countNonZero(values) / static_cast<double>(values.total());
}

cv::Mat nearestAround(const cv::Mat& disparities, int reach_cells) {
  cv::Mat nearest;
  const int side = 2 * reach_cells + 1;
  cv::dilate(disparities, nearest, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return nearest;
}

double nearestMatched(const StereoCamera& camera, const DisparityParams& params) {
  const int range = searchRange(camera, params, camera.width / params.reduce);
  return camera.fx * camera.baseline_m / (range * params.reduce);
}

DisparityImage denseDisparity(const StereoFrame& frame, const DisparityParams& params) {
  if (!frame.disparity.empty()) return givenDisparities(frame, params);
  DisparityImage result;
  result.reduce = params.reduce;
  result.block_px = params.reduce * blockSide(params);
  const cv::Mat left = reducedImage(frame.left, params.reduce);
  const cv::Mat right = reducedImage(frame.right, params.reduce);
  const int range = searchRange(*frame.camera, params, left.cols);
  result.values = cv::Mat(left.size(), CV_32F, cv::Scalar(0));
  if (range < 16 || left.rows <= 2 * params.block_px) return result;
  auto matcher = makeMatcher(params, range);
  matcher->setDisp12MaxDiff(1);
  matcher->setSpeckleRange(kSpeckleRange);
  matcher->setSpeckleWindowSize(params.min_speckle_px);
  // OpenCV leaves the first `range` columns unmatched: they are given as many more to their left.
  cv::Mat fixed;
  matcher->compute(widened(left, range), widened(right, range), fixed);
  fixed.colRange(range, fixed.cols)
      .convertTo(result.values, CV_32F, static_cast<double>(params.reduce) / kSubpixels);
  dropMatchesOutside(result);
  return result;
}

}  // namespace headway::stereo
