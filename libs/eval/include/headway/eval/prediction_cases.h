#pragma once

#include <headway/eval/object_truth.h>
#include <headway/eval/prediction_error.h>

#include <map>
#include <vector>

namespace headway::eval {

/// A moment in an object's true life at which its future may be foretold and compared.
struct HistoryCase {
  std::size_t object = 0;                ///< index in the list of objects
  std::vector<TrajectoryPoint> history;  ///< exact, the last one is now; nothing before them
  HorizonPath future;
};

/// Every frame of every moving kind of object that has 20 earlier and 3 s of later consecutive
/// frames, each with its 21 places up to then.
///
/// Moving kinds: Car, Van, Truck, Tram, Pedestrian, Cyclist.
///
/// @param frame_interval_s  nominal time between frames [s]
[[nodiscard]] std::vector<HistoryCase> historyCases(const std::vector<TrueObject>& objects,
                                                    double frame_interval_s);

/// What a tracker foretold of one track at one frame.
struct TrackPrediction {
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  TrackId id;
  ObjectClass object_class = ObjectClass::kUnknown;
  std::vector<PredictedPath> paths;  ///< map frame, at all the horizons
};

/// A prediction of a track, and the object that it turned out to be about.
struct TrackCase {
  std::size_t prediction = 0;  ///< index in the list of predictions
  std::size_t object = 0;      ///< index in the list of objects
  HorizonPath future;
};

struct TrackCases {
  std::vector<TrackCase> cases;
  std::size_t unmatched = 0;  ///< no true object of its class is near
  std::size_t cut_short = 0;  ///< the truth ends before the prediction does
};

/// Finds the true object of each prediction: one to one in each frame, of the same class, within
/// `max_distance_m` of the place foretold for the next 0.1 s.
///
/// @param max_gap_s  longest gap in a true path that is bridged by a straight line [s]
[[nodiscard]] TrackCases trackCases(const std::vector<TrueObject>& objects,
                                    const std::vector<TrackPrediction>& predictions,
                                    double max_distance_m, double max_gap_s);

}  // namespace headway::eval
