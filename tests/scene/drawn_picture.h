// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/plot/colours.h>
#include <headway/render/pinhole_view.h>

#include <opencv2/imgproc.hpp>

#include "canvas.h"

namespace headway::scene {

inline constexpr int kWidth = 960, kHeight = 540;

inline cv::Mat background() {
  return cv::Mat(kHeight, kWidth, CV_8UC3, plot::bgr(kDarkPalette.backdrop.ground));
}

/// Bounding rectangle of the pixels that differ from the background.
inline cv::Rect changed(const cv::Mat& picture) {
  cv::Mat difference, grey;
  cv::absdiff(picture, background(), difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  return cv::boundingRect(grey);
}

/// A view from 20 m behind the map's origin along +x.
inline render::PinholeView forwardView() {
  return render::makeView(kWidth, kHeight, 1.2, render::lookAt({-20, 0, 3}, {10, 0, 1}));
}

}  // namespace headway::scene
