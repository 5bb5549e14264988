// SPDX-License-Identifier: BSD-3-Clause
// What makes figures of different machines comparable.
#pragma once

#include <headway/core/stage_times.h>

#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

namespace headway::bench {

/// Adds the stage "reference": OpenCV's ORB, detect and compute with 2,000 features, on both images
/// in one thread.
inline void measureReferenceWorkload(const cv::Mat& left, const cv::Mat& right, StageTimes& times) {
  static const auto orb = cv::ORB::create(2000);
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  {
    const auto watch = times.watch("reference");
    orb->detectAndCompute(left, cv::noArray(), keypoints, descriptors);
    orb->detectAndCompute(right, cv::noArray(), keypoints, descriptors);
  }
  cv::setNumThreads(threads);
}

}  // namespace headway::bench
