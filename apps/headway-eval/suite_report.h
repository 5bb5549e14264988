// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/track_error.h>
#include <headway/plot/text_table.h>

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

/// Values of slam.dynamic_rejection.
struct Rejection {
  std::string name;
  slam::DynamicRejection value;
};
[[nodiscard]] const std::vector<Rejection>& rejections();

/// Camera error in one world with one kind of rejection.
struct CameraFigures {
  std::size_t frames = 0;
  std::size_t wanted = 0;  ///< greater than `frames` if the world's path ended early
  std::size_t lost = 0;
  std::optional<eval::TrajectoryError> error;
};

/// Object errors on one recording, or on several together.
struct ObjectErrors {
  eval::TrackErrors raw;
  eval::TrackErrors tracks;
  std::vector<std::pair<std::string, eval::PredictionErrors>> on_tracks;  ///< by predictor
  std::vector<std::pair<std::string, eval::PredictionErrors>> on_truth;
};
[[nodiscard]] ObjectErrors evaluateObjects(const ObjectFigures& figures);

/// Results of the suite on one recording, or on several together.
struct SuiteEntry {
  std::string name;
  std::vector<std::pair<std::string, CameraFigures>> camera;  ///< by rejection; empty: no images
  std::optional<ObjectErrors> objects;                        ///< none if interrupted
  bool in_plot = true;
  bool is_group = false;  ///< several recordings, evaluated as one set
};

/// The paper's Table I: RMSE / mean / SD of the camera's position.
[[nodiscard]] plot::TextTable cameraTable(const std::vector<SuiteEntry>& entries);
/// The paper's Table II: ADE / FDE, a column for each predictor.
///
/// @param figures  on_tracks or on_truth
[[nodiscard]] plot::TextTable predictionTable(
    const std::vector<SuiteEntry>& entries,
    std::vector<std::pair<std::string, eval::PredictionErrors>> ObjectErrors::*figures);
/// All predictors on one set of recordings: errors and the ratio inside the 90 % ellipse, on exact
/// histories and on headway's tracks.
[[nodiscard]] plot::TextTable predictorTable(const ObjectErrors& errors);
/// The paper's Table III: positions of raw detections and of tracks.
[[nodiscard]] plot::TextTable objectTable(const std::vector<SuiteEntry>& entries);

/// All tables with their headings, as Markdown.
void writeSuite(std::ostream& out, const std::vector<SuiteEntry>& entries);

[[nodiscard]] nlohmann::ordered_json suiteFigures(const std::vector<SuiteEntry>& entries);
[[nodiscard]] cv::Mat suitePlot(const std::vector<SuiteEntry>& entries);

}  // namespace headway::app
