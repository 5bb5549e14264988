#pragma once

#include <headway/core/params.h>
#include <headway/detect/detector.h>
#include <headway/detect/disparity.h>
#include <headway/detect/network_detector.h>
#include <headway/detect/person_detector.h>
#include <headway/detect/stereo_motion.h>

#include <memory>
#include <string>
#include <vector>

namespace headway::detect {

/// Parameters of every detector.
struct DetectParams {
  int every_nth_frame = 1;  ///< detectors look at one frame in so many; tracks coast between
  DisparityParams disparity;
  StereoMotionParams stereo_motion;
  NetworkParams network;
  PersonParams person;

  /// Binds sections [detect], [disparity], [stereo_motion], [dnn] and [hog].
  void describe(Params& params);
};

/// Names that makeDetector knows: "stereo_motion", "dnn", "hog".
[[nodiscard]] const std::vector<std::string>& detectorNames();

/// Makes a detector by its name; it looks at every n-th frame given to it.
///
/// @param camera  of every frame to come
/// @throws        InputError for a name that is none of detectorNames(), or a model that cannot be
///                used
[[nodiscard]] std::unique_ptr<Detector> makeDetector(const std::string& name,
                                                     std::shared_ptr<const StereoCamera> camera,
                                                     const DetectParams& params);

/// Makes several, from names joined by "+": "dnn+stereo_motion".
[[nodiscard]] std::vector<std::unique_ptr<Detector>> makeDetectors(
    const std::string& names, const std::shared_ptr<const StereoCamera>& camera,
    const DetectParams& params);

}  // namespace headway::detect
