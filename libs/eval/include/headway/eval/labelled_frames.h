#pragma once

#include <headway/core/detection.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

/// One object of one frame: as it truly is, or as a tracker reports it.
struct LabelledBox {
  std::int64_t id = -1;  ///< of the object, within its sequence
  ObjectClass object_class = ObjectClass::kUnknown;
  std::optional<Box2d> box2d;  ///< [px]
  std::optional<Box3d> box3d;  ///< optical frame, the same for truth and estimate
  int occlusion = 0;           ///< truth: 0 visible .. 3 unknown (KITTI)
  double truncation = 0.0;     ///< truth: above 0 where the image's edge cuts it
  double score = 0.0;          ///< estimates: greater is surer
};

/// One frame of a sequence, truth and estimates side by side.
struct LabelledFrame {
  std::vector<LabelledBox> truth;
  std::vector<Box2d> dont_care;  ///< regions where nobody labelled anything [px]
  std::vector<LabelledBox> estimates;
};

/// One recording.
struct LabelledSequence {
  std::string name;
  std::vector<LabelledFrame> frames;  ///< by frame index
};

}  // namespace headway::eval
