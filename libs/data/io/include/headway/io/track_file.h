// SPDX-License-Identifier: BSD-3-Clause
// Files of boxes, tracks and predictions: KITTI's rows and headway's CSV.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>

#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace headway::io {

/// One row of KITTI's tracking label or result format (position of the bottom centre, camera 0).
struct KittiRow {
  std::size_t frame = 0;
  std::int64_t id = -1;
  std::string type;  ///< KITTI's spelling, including "DontCare"; "Person" becomes "Person_sitting"
  double truncation = 0.0;                                  ///< -1 if not given
  int occlusion = 0;                                        ///< 0 .. 3, -1 if not given
  double alpha = -10.0;                                     ///< observation angle [rad]
  Box2d box2d;                                              ///< [px]
  double height = 0.0, width = 0.0, length = 0.0;           ///< [m]
  Eigen::Vector3d bottom_centre = Eigen::Vector3d::Zero();  ///< optical frame [m]
  double rotation_y = 0.0;                                  ///< [rad]
  double score = 0.0;                                       ///< results only
  double visible = 1.0;  ///< visible ratio 0..1, 18th column of simulated truth
};

/// @throws InputError naming file and line of an error
[[nodiscard]] std::vector<KittiRow> readKittiRows(const std::string& path);
/// Writes results: 18 columns, the last is the score.
void writeKittiResult(std::ostream& out, const KittiRow& row);
/// Writes labels: 17 columns, and the visible ratio as an 18th if `with_visible`.
void writeKittiLabel(std::ostream& out, const KittiRow& row, bool with_visible);

/// The row's box as a detection (score and id kept); nullopt if its class is unknown.
[[nodiscard]] std::optional<Detection> detectionFrom(const KittiRow& row);

/// The columns of a true object in `objects.csv`, without its `visible`.
[[nodiscard]] std::string objectCsvHeader();
/// The header line of `tracks.csv` and `tracks_smoothed.csv`: the same, and the covariance of the
/// velocity.
[[nodiscard]] std::string trackCsvHeader();
void writeTrackCsv(std::ostream& out, const TrackSample& row);
/// Reads either; without its columns a velocity's covariance is 0.
[[nodiscard]] std::vector<TrackSample> readTrackCsv(const std::string& path);
/// Reads either row by row, as long as it may be.
void visitTrackCsv(const std::string& path, const std::function<void(const TrackSample&)>& visit);

/// One row of `objects.csv`, the true objects of a simulation.
struct ObjectSample {
  TrackSample object;
  double visible = 1.0;  ///< visible ratio, 0 to 1; 1 in files without this column
};
/// Reads objects.csv, or a file of tracks.
[[nodiscard]] std::vector<ObjectSample> readObjectCsv(const std::string& path);

/// One row of `predictions.csv`.
struct PredictionRow {
  std::size_t frame = 0;
  Time time = 0.0;
  TrackId id;
  ObjectClass object_class = ObjectClass::kUnknown;
  int mode = 0;
  double probability = 1.0;
  PredictedPoint point;
};
[[nodiscard]] std::string predictionCsvHeader();
void writePredictionCsv(std::ostream& out, const PredictionRow& row);
[[nodiscard]] std::vector<PredictionRow> readPredictionCsv(const std::string& path);
/// Reads them row by row, as long as the file may be.
///
/// @param horizon_step_s  rows with other horizons than its multiples are passed over; 0: none [s]
void visitPredictionCsv(const std::string& path,
                        const std::function<void(const PredictionRow&)>& visit,
                        double horizon_step_s = 0.0);

/// The header line of `detections.csv`, headway's CSV of boxes.
[[nodiscard]] std::string detectionCsvHeader();
/// Writes one detection, with its 3D box unchanged; missing values are empty.
void writeDetectionCsv(std::ostream& out, std::size_t frame, const Detection& detection);

/// Detections by frame index from a side file: KITTI labels or results, KITTI-like detector
/// output (det3d, det2d) or headway's CSV; distinguished by their columns (doc/formats.md).
///
/// @param dropped  counts ignored rows, by reason ("unknown_class", "dont_care", "bad_row")
/// @throws InputError if the file cannot be read or has another format
[[nodiscard]] std::map<std::size_t, Detections> readDetections(
    const std::string& path, std::map<std::string, std::size_t>& dropped);

}  // namespace headway::io
