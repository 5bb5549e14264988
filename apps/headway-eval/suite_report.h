#pragma once

#include <headway/eval/text_table.h>
#include <headway/eval/track_error.h>

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite_objects.h"
#include "suite_worlds.h"

namespace headway::app {

/// Ways to keep moving things out of the map, as slam.dynamic_rejection names them.
struct Rejection {
  std::string name;
  slam::DynamicRejection value;
};
[[nodiscard]] const std::vector<Rejection>& rejections();

/// How well the camera was localised in one world with one way of rejection.
struct CameraFigures {
  std::size_t frames = 0;
  std::size_t wanted = 0;  ///< more than `frames` if the world's path ended before
  std::size_t lost = 0;
  std::optional<eval::TrajectoryError> error;
};

/// What was found out about the objects of one recording, or of several together.
struct ObjectErrors {
  eval::TrackErrors raw;
  eval::TrackErrors tracks;
  std::vector<std::pair<std::string, eval::PredictionErrors>> on_tracks;  ///< by predictor
  std::vector<std::pair<std::string, eval::PredictionErrors>> on_truth;
};
[[nodiscard]] ObjectErrors judgeObjects(const ObjectFigures& figures);

/// All that the suite found out about one recording, or about several together.
struct SuiteEntry {
  std::string name;
  std::vector<std::pair<std::string, CameraFigures>> camera;  ///< by rejection; empty: no images
  std::optional<ObjectErrors> objects;                        ///< none if it was interrupted
  bool in_plot = true;
  bool is_group = false;  ///< several recordings, judged as one set
};

/// The paper's Table I: RMSE / mean / SD of the camera's position.
[[nodiscard]] eval::TextTable cameraTable(const std::vector<SuiteEntry>& entries);
/// The paper's Table II: ADE / FDE, a column for each predictor.
///
/// @param figures  on_tracks or on_truth
[[nodiscard]] eval::TextTable predictionTable(
    const std::vector<SuiteEntry>& entries,
    std::vector<std::pair<std::string, eval::PredictionErrors>> ObjectErrors::*figures);
/// Every predictor on one set of recordings: errors and the share inside the 90 % ellipse, on exact
/// histories and on the layer's own tracks.
[[nodiscard]] eval::TextTable predictorTable(const ObjectErrors& errors);
/// The paper's Table III: positions of raw detections and of ours.
[[nodiscard]] eval::TextTable objectTable(const std::vector<SuiteEntry>& entries);

/// All tables with their headings, as Markdown.
void writeSuite(std::ostream& out, const std::vector<SuiteEntry>& entries);

[[nodiscard]] nlohmann::ordered_json suiteFigures(const std::vector<SuiteEntry>& entries);
[[nodiscard]] cv::Mat suitePlot(const std::vector<SuiteEntry>& entries);

}  // namespace headway::app
