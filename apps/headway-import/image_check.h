// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_source.h>

#include <opencv2/core.hpp>
#include <vector>

#include "check_item.h"
#include "time_check.h"

namespace headway::import {

/// Images of a recording: exposure, blur, vertical offset, and the camera's turns, which are
/// compared with the gyroscope.
class ImageCheck {
 public:
  /// @param every_nth_pair  of the pairs, one is matched for its vertical offset
  explicit ImageCheck(std::size_t every_nth_pair) : every_nth_pair_(every_nth_pair) {}

  void add(const StereoFrame& frame);
  [[nodiscard]] std::vector<CheckItem> items() const;
  /// The offset of the gyroscope's clock; nothing without samples.
  [[nodiscard]] std::vector<CheckItem> clockItems(const std::vector<TurnSample>& turns) const;

 private:
  /// The camera's turn between two frames.
  struct Turn {
    Time begin = 0.0, end = 0.0;
    Eigen::Vector3d angle = Eigen::Vector3d::Zero();  ///< robot frame [rad]
  };
  void addPair(const StereoFrame& frame);
  void addTurn(const StereoFrame& frame);
  [[nodiscard]] CheckItem pairItem() const;
  [[nodiscard]] CheckItem depthItem() const;

  std::size_t every_nth_pair_;
  std::size_t frames_ = 0;
  std::vector<double> brightness_, difference_, saturated_, sharpness_, vertical_, matches_;
  std::vector<double> known_depth_;  ///< ratio of the pixels, of a depth camera
  std::vector<Turn> turns_;
  cv::Mat last_;
  Time last_time_ = 0.0;
};

}  // namespace headway::import
