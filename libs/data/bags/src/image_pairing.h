// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace headway::bags {

/// An image and its time.
using StampedImage = Stamped<cv::Mat>;

/// Pairs the images of two cameras by their times.
class ImagePairing {
 public:
  explicit ImagePairing(double tolerance_s) : tolerance_s_(tolerance_s) {}

  using Pair = std::array<StampedImage, 2>;

  /// @param side  0: the first camera, 1: the second one
  /// @return      the pair that this image completes
  [[nodiscard]] std::optional<Pair> add(std::size_t side, StampedImage image) {
    auto& partners = waiting_[1 - side];
    const auto distance = [&](const StampedImage& other) {
      return std::abs(other.time - image.time);
    };
    const auto nearest = std::min_element(
        partners.begin(), partners.end(),
        [&](const StampedImage& a, const StampedImage& b) { return distance(a) < distance(b); });
    if (nearest != partners.end()) nearest_s_ = std::min(nearest_s_, distance(*nearest));
    if (nearest == partners.end() || distance(*nearest) > tolerance_s_) {
      waiting_[side].push_back(std::move(image));
      if (waiting_[side].size() > kMaxWaiting) drop(waiting_[side], 1);
      return std::nullopt;
    }
    Pair pair;
    pair[1 - side] = *nearest;
    pair[side] = std::move(image);
    const auto older = static_cast<std::size_t>(nearest - partners.begin());
    drop(partners, older);
    partners.pop_front();
    return pair;
  }

  /// Number of images without a partner; those that wait are among them at the end.
  [[nodiscard]] std::size_t unpaired() const {
    return unpaired_ + waiting_[0].size() + waiting_[1].size();
  }
  /// Smallest distance of a left and a right image [s]; infinite if one camera has none.
  [[nodiscard]] double nearest() const { return nearest_s_; }

 private:
  static constexpr std::size_t kMaxWaiting = 8;

  void drop(std::deque<StampedImage>& images, std::size_t count) {
    images.erase(images.begin(), images.begin() + static_cast<std::ptrdiff_t>(count));
    unpaired_ += count;
  }

  double tolerance_s_;
  double nearest_s_ = std::numeric_limits<double>::infinity();
  std::array<std::deque<StampedImage>, 2> waiting_;
  std::size_t unpaired_ = 0;
};

}  // namespace headway::bags
