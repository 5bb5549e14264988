// SPDX-License-Identifier: BSD-3-Clause
// Parameters of all detectors, and the making of one by its name.
#pragma once

#include <headway/core/params.h>
#include <headway/detect/detector.h>
#include <headway/detect/network_detector.h>
#include <headway/detect/people_by_shape.h>
#include <headway/detect/person_detector.h>
#include <headway/detect/stereo_motion.h>
#include <headway/stereo/frame_context.h>

#include <memory>
#include <string>
#include <vector>

namespace headway::detect {

/// Parameters of every detector.
struct DetectParams {
  double period_s = 0.0;  ///< of makeDetector()'s; 0: every frame [s]
  stereo::DisparityParams disparity;
  StereoMotionParams stereo_motion;
  NetworkParams network;
  PersonParams person;
  ShapeParams shape;

  /// Binds sections [detect], [disparity], [stereo_motion], [dnn], [hog] and [shape].
  void describe(Params& params);
  void validate() const;  ///< @throws InputError
};

/// Names of all detectors: "stereo_motion", "dnn", "hog", "shape".
[[nodiscard]] const std::vector<std::string>& detectorNames();

/// Makes a detector that works on single frames.
///
/// @param name  one of detectorNames() but "stereo_motion" and "shape", which need more than a
///              frame
/// @throws      InputError for any other name, or a model that cannot be used
[[nodiscard]] std::unique_ptr<Detector> makeDetector(const std::string& name,
                                                     const DetectParams& params);

}  // namespace headway::detect
