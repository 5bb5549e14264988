#pragma once

#include <headway/eval/object_truth.h>
#include <headway/eval/prediction_error.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

namespace headway::eval {

/// One prediction as drawn.
struct DrawnPrediction {
  std::size_t object = 0;  ///< index in the list of objects: gives the colour
  Eigen::Vector2d now = Eigen::Vector2d::Zero();
  std::vector<PredictedPath> paths;  ///< the first is drawn stronger
};

/// Predictions over the true paths of one recording from above, each object in its own colour.
///
/// @param camera_path  map frame [m]
/// @return             8-bit BGR
[[nodiscard]] cv::Mat predictionMapPlot(const std::string& title,
                                        const std::vector<TrueObject>& objects,
                                        const std::vector<DrawnPrediction>& predictions,
                                        const std::vector<Eigen::Vector2d>& camera_path);

/// Mean error over the horizon, a line for each named predictor. 8-bit BGR.
[[nodiscard]] cv::Mat errorOverHorizonPlot(
    const std::vector<std::pair<std::string, PredictionError>>& predictors);

}  // namespace headway::eval
