// SPDX-License-Identifier: BSD-3-Clause
// Plots of errors.
#pragma once

#include <headway/eval/dense_error.h>
#include <headway/eval/grid_error.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/people_error.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/track_error.h>
#include <headway/eval/trajectory_error.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

// Plots of the comparisons, as 8-bit BGR pictures.

namespace headway::eval {

/// Axes of the poses shown in a plan view.
enum class TopView {
  kXy,  ///< robot and world frames: z is up
  kXz,  ///< camera frames (KITTI poses): y is down
};

/// Plan view of truth and estimate, coloured by its error, above the error over the path length.
[[nodiscard]] cv::Mat trajectoryPlot(const TrajectoryError& error, TopView view,
                                     const std::string& title);

/// MOTA and scaled MOTA over recall, one colour per class.
[[nodiscard]] cv::Mat trackPlot(const std::string& title, const TrackErrors& errors);

/// Trajectories of one recording in the map frame.
struct TrackMap {
  std::string title;
  std::vector<TrueObject> truth;
  std::vector<TrueObject> tracks;  ///< drawn in different colours, which shows identity switches
  std::vector<TrueObject> raw;     ///< detections, drawn as dots
  std::vector<Eigen::Vector2d> camera_path;  ///< [m]
};

/// Plan view of true paths, tracks, detections and the camera path.
[[nodiscard]] cv::Mat trackMapPlot(const TrackMap& map);

/// One prediction to draw.
struct DrawnPrediction {
  std::size_t object = 0;  ///< index in the list of objects; determines the colour
  Eigen::Vector2d now = Eigen::Vector2d::Zero();
  std::vector<PredictedPath> paths;  ///< the first is emphasised
};

/// Plan view of predictions over the true paths of one recording, one colour per object.
///
/// @param camera_path  map frame [m]
[[nodiscard]] cv::Mat predictionMapPlot(const std::string& title,
                                        const std::vector<TrueObject>& objects,
                                        const std::vector<DrawnPrediction>& predictions,
                                        const std::vector<Eigen::Vector2d>& camera_path);

/// Mean error over the horizon, one line per predictor.
[[nodiscard]] cv::Mat errorOverHorizonPlot(
    const std::string& title,
    const std::vector<std::pair<std::string, PredictionError>>& predictors);

/// Ratio of the people found by distance, a bar each for walking and standing ones.
[[nodiscard]] cv::Mat peoplePlot(const PeopleError& error);

/// Plan view of the estimated grid, x to the right, with wrong cells in colour.
///
/// @param swept  as for gridError()
[[nodiscard]] cv::Mat gridPlot(const GridCells& truth, const GridCells& estimate,
                               const std::vector<std::uint8_t>& swept);

/// Plan view of the true surface, by how much of it is covered above each cell of 0.2 m, with the
/// points where only moving objects were.
///
/// @param patches, points  that the error is of
[[nodiscard]] cv::Mat densePlot(const std::vector<TrueSurface::Patch>& patches,
                                const std::vector<Eigen::Vector3d>& points,
                                const DenseError& error);

}  // namespace headway::eval
