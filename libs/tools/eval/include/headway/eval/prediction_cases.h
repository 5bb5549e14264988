// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_error.h>

#include <map>
#include <vector>

namespace headway::eval {

/// One frame of a true object with enough history to predict and enough future to compare.
struct HistoryCase {
  std::size_t object = 0;                ///< index in the list of objects
  std::vector<TrajectoryPoint> history;  ///< exact positions up to the current frame, oldest first
  HorizonPath future;
};

/// Every frame of a Car, Van, Truck, Tram, Pedestrian or Cyclist that has 20 consecutive frames
/// before it and 3 s of consecutive frames after it, each with its 21 positions up to that frame.
///
/// @param frame_interval_s  nominal frame interval [s]
[[nodiscard]] std::vector<HistoryCase> historyCases(const std::vector<TrueObject>& objects,
                                                    double frame_interval_s);

/// The prediction of one track at one frame.
struct TrackPrediction {
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  TrackId id;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<PredictedPath> paths;  ///< map frame, all with points at all horizons
};

/// A prediction of a track and the true object it was matched with.
struct TrackCase {
  std::size_t prediction = 0;  ///< index in the list of predictions
  std::size_t object = 0;      ///< index in the list of objects
  HorizonPath future;
};

/// Predictions paired with what their objects did.
struct TrackCases {
  std::vector<TrackCase> cases;
  std::size_t unmatched = 0;  ///< predictions without a true object of their class nearby
  std::size_t cut_short = 0;  ///< predictions that extend beyond the end of the truth
};

/// Matches predictions with true objects: one to one in each frame, of the same class, within
/// `max_distance_m` of the position predicted for 0.1 s ahead.
///
/// @param max_gap_s  longest gap of a true path to interpolate over [s]
[[nodiscard]] TrackCases trackCases(const std::vector<TrueObject>& objects,
                                    const std::vector<TrackPrediction>& predictions,
                                    double max_distance_m, double max_gap_s);

}  // namespace headway::eval
