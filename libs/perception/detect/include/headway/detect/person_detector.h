// SPDX-License-Identifier: BSD-3-Clause
// Finds upright people by OpenCV's histograms of oriented gradients.
#pragma once

#include <headway/core/params.h>
#include <headway/detect/detector.h>

#include <memory>

namespace headway::detect {

/// Section [hog].
struct PersonParams {
  double upscale = 1.5;     ///< the image is enlarged by this: people of 96 px / upscale [-]
  double scale_step = 1.1;  ///< ratio of successive scales searched [-]
  double min_score = 0.6;   ///< distance from the decision plane [-]
  double nms_iou = 0.4;     ///< of two boxes that overlap more the better is kept [-]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "hog"); }  ///< @throws InputError
};

/// Finds upright people by OpenCV's built-in detector: no file needed. 2D boxes.
///
/// @see  Dalal & Triggs 2005, "Histograms of oriented gradients for human detection"
class PersonDetector : public Detector {
 public:
  explicit PersonDetector(const PersonParams& params);
  ~PersonDetector() override;

  [[nodiscard]] Detections detect(const StereoFrame& frame) override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::detect
