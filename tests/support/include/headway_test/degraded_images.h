// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace headway::test {

/// One way in which images are worse than they should be.
struct Trouble {
  const char* name;
  std::function<void(int, StereoFrame&)> spoil;  ///< the frame of an index
  double right_late_s = 0.0;                     ///< the right image shows a later moment
};

/// Streaks over an image, others for every seed.
inline void rain(int seed, cv::Mat& image) {
  cv::RNG random(static_cast<std::uint64_t>(seed) + 17);
  for (int drop = 0; drop < 250; ++drop) {
    const cv::Point from(random.uniform(0, image.cols), random.uniform(0, image.rows));
    cv::line(image, from, from + cv::Point(2, 9), cv::Scalar(random.uniform(150, 230)));
  }
}

/// Exposure that jumps, blur, rain, one black image, and cameras with converging axes.
///
/// @param black_frame  index of the frame whose left image is black
inline std::vector<Trouble> troubles(int black_frame) {
  return {
      {"exposure",
       [](int i, StereoFrame& frame) {
         const double gain = i % 4 < 2 ? 1.0 : 0.8;
         frame.left.convertTo(frame.left, CV_8U, gain);
         frame.right.convertTo(frame.right, CV_8U, gain);
       }},
      {"blur",
       [](int, StereoFrame& frame) {
         cv::blur(frame.left, frame.left, {5, 1});
         cv::blur(frame.right, frame.right, {5, 1});
       }},
      {"rain",
       [](int i, StereoFrame& frame) {
         rain(2 * i, frame.left);
         rain(2 * i + 1, frame.right);
       }},
      {"black",
       [black_frame](int i, StereoFrame& frame) {
         if (i == black_frame) frame.left.setTo(0);
       }},
      {"late", [](int, StereoFrame&) {}, 0.01},
  };
}

}  // namespace headway::test
