#pragma once

#include <headway/scene/snapshot.h>

#include <array>
#include <string>
#include <vector>

#include "canvas.h"

namespace headway::scene {

/// What colours and lines mean. Classes stay in it once seen, so that a video's does not jump.
class Legend {
 public:
  enum class Layout {
    kColumn,  ///< one below the other, at the bottom left
    kRow,     ///< side by side along the bottom
  };
  void draw(Canvas& canvas, const SnapshotInput& input, Layout layout);

 private:
  struct Entry {
    std::string text;
    Colour colour;
    bool dashed = false;
  };
  [[nodiscard]] std::vector<Entry> entries(const SnapshotInput& input, Layout layout);
  static void drawEntry(Canvas& canvas, const Entry& entry, cv::Point left_middle);

  std::array<bool, kObjectClassCount> seen_{};
};

}  // namespace headway::scene
