// SPDX-License-Identifier: BSD-3-Clause
#include "dynamic_rejection.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace headway::slam {
namespace {

/// The pixels of a box that lie in the image; none for a box that is not finite.
cv::Rect pixelsOf(const Box2d& box, const cv::Size& image_size) {
  if (!std::isfinite(box.left + box.right + box.top + box.bottom)) return {};
  const auto column = [&](double u) { return std::clamp(u, -1.0, image_size.width + 0.0); };
  const auto row = [&](double v) { return std::clamp(v, -1.0, image_size.height + 0.0); };
  const cv::Point first(static_cast<int>(std::floor(column(box.left))),
                        static_cast<int>(std::floor(row(box.top))));
  const cv::Point last(static_cast<int>(std::ceil(column(box.right))),
                       static_cast<int>(std::ceil(row(box.bottom))));
  if (last.x < first.x || last.y < first.y) return {};
  return cv::Rect(first, last + cv::Point(1, 1)) & cv::Rect({0, 0}, image_size);
}

void draw(const std::vector<MovingBox>& boxes, cv::Mat& mask) {
  for (const Box2d& box : boxes) mask(pixelsOf(box, mask.size())).setTo(255);
}

}  // namespace

cv::Mat excludedMask(const MovingRegions& moving, DynamicRejection mode,
                     const cv::Size& image_size) {
  const bool wanted = mode == DynamicRejection::kBoxes || mode == DynamicRejection::kBoth;
  const bool unsure = mode == DynamicRejection::kBoxes && !moving.unsure.empty();
  if (!wanted || (moving.boxes.empty() && moving.mask.empty() && !unsure)) return {};
  if (!moving.mask.empty() && (moving.mask.type() != CV_8UC1 || moving.mask.size() != image_size)) {
    throw InputError("moving regions: the mask is " + std::to_string(moving.mask.cols) + "x" +
                     std::to_string(moving.mask.rows) + ", must be 8-bit and " +
                     std::to_string(image_size.width) + "x" + std::to_string(image_size.height) +
                     " as the image");
  }
  cv::Mat mask =
      moving.mask.empty() ? cv::Mat(image_size, CV_8UC1, cv::Scalar(0)) : moving.mask.clone();
  draw(moving.boxes, mask);
  if (unsure) draw(moving.unsure, mask);
  return mask;
}

cv::Mat suspectMask(const MovingRegions& moving, DynamicRejection mode,
                    const cv::Size& image_size) {
  if (mode != DynamicRejection::kBoth || moving.unsure.empty()) return {};
  cv::Mat mask(image_size, CV_8UC1, cv::Scalar(0));
  draw(moving.unsure, mask);
  return mask;
}

}  // namespace headway::slam
