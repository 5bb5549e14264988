// SPDX-License-Identifier: BSD-3-Clause
// OpenCV's block matcher as the dense disparities and those of the ground use it.
#pragma once

#include <opencv2/calib3d.hpp>

namespace headway::stereo {

constexpr int kSubpixels = 16;  ///< OpenCV's fixed-point disparities

/// Block matching of whole-pixel disparities in a range, from 0 on unless set.
///
/// @param block_px  made odd
inline cv::Ptr<cv::StereoBM> blockMatcher(int range, int block_px) {
  auto matcher = cv::StereoBM::create(range, block_px | 1);
  matcher->setTextureThreshold(12);
  matcher->setPreFilterCap(31);
  return matcher;
}

}  // namespace headway::stereo
