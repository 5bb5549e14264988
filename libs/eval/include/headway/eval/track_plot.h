#pragma once

#include <headway/eval/object_truth.h>
#include <headway/eval/track_error.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::eval {

/// MOTA and scaled MOTA over recall, a colour for each class. 8-bit BGR.
[[nodiscard]] cv::Mat trackPlot(const TrackErrors& errors);

/// Paths of one recording seen from above; all in the map frame.
struct TrackMap {
  std::string title;
  std::vector<TrueObject> truth;
  std::vector<TrueObject> tracks;            ///< a colour each, so that switches show
  std::vector<TrueObject> raw;               ///< what the detector said; drawn as dots
  std::vector<Eigen::Vector2d> camera_path;  ///< [m]
};

/// True paths, tracks, detections and the camera's path from above. 8-bit BGR.
[[nodiscard]] cv::Mat trackMapPlot(const TrackMap& map);

}  // namespace headway::eval
