// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/scene/snapshot.h>

#include <array>
#include <string>
#include <vector>

#include "canvas.h"

namespace headway::scene {

/// Legend of colours and line styles. Classes remain in it once they occur, so that the legend of a
/// video does not change size from frame to frame.
class Legend {
 public:
  enum class Layout {
    kColumn,  ///< vertically in the bottom left corner
    kRow,     ///< horizontally at the bottom
  };
  /// @return the place that it takes [px]; empty without entries
  cv::Rect draw(Canvas& canvas, const SnapshotInput& input, Layout layout);

 private:
  struct Entry {
    std::string text;
    Colour colour;
    bool dashed = false;
  };
  [[nodiscard]] std::vector<Entry> entries(const SnapshotInput& input, Layout layout,
                                           const Palette& palette);
  static void drawEntry(Canvas& canvas, const Entry& entry, cv::Point left_middle);

  std::array<bool, kObjectClassCount> seen_{};
};

}  // namespace headway::scene
