// SPDX-License-Identifier: BSD-3-Clause
// Errors of predictions, and the cases that they are of.
#pragma once

#include <headway/core/track.h>
#include <headway/eval/labelled_frames.h>

#include <array>
#include <map>
#include <optional>
#include <vector>

namespace headway::eval {

/// Predictions are evaluated at 0.1 s, 0.2 s ... 3.0 s.
inline constexpr double kHorizonStep_s = 0.1;
inline constexpr std::size_t kHorizons = 30;
/// Predictions with a larger error are misses [m].
inline constexpr double kMissDistance_m = 2.0;

/// Positions at all horizons on the ground plane of the map [m].
using HorizonPath = std::array<Eigen::Vector2d, kHorizons>;

/// Errors of predictions, as distances on the ground plane. All but the best of k are those of the
/// most probable path.
struct PredictionError {
  std::size_t cases = 0;        ///< predictions evaluated; if 0, the other figures are undefined
  std::optional<double> ade_m;  ///< mean over the 30 horizons, then over the cases
  std::optional<double> fde_m;  ///< mean at 3 s
  std::array<std::optional<double>, 3> miss_rate;  ///< ratio of misses at 1, 2, 3 s
  std::optional<double> best_of_k_ade_m;           ///< of the path with the least mean error
  /// Ratio of cases inside the 50, 90, 95 % ellipse (first index) at 1, 2, 3 s (second index), over
  /// the cases with positive definite covariances; none if there are no such cases.
  std::array<std::array<std::optional<double>, 3>, 3> coverage;
  /// Mean of e' C^-1 e over horizons and cases; 2 for a consistent covariance C.
  std::optional<double> nees;
  std::array<double, kHorizons> mean_error_m{};  ///< at each horizon
};

/// Errors by class, and of all.
struct PredictionErrors {
  std::map<ObjectClass, PredictionError> classes;  ///< classes with at least one case
  PredictionError all;
};

/// Accumulates the errors of predictions against the true future.
///
///     PredictionEvaluator evaluator;
///     for (...) evaluator.add(object_class, predictor->predict(history), future);
///     evaluator.errors().all.ade_m;
///
/// @see Alahi et al. 2016, "Social LSTM", Sec. 4 (ADE, FDE); Gupta et al. 2018, "Social GAN"
///      (best of k); Chang et al. 2019, "Argoverse" (miss rate at 2 m); Bar-Shalom et al. 2001,
///      "Estimation with applications to tracking and navigation", Sec. 5.4 (NEES). The p ellipse
///      is e' C^-1 e <= -2 ln(1 - p), the quantile of chi-square with two degrees of freedom
class PredictionEvaluator {
 public:
  /// Adds one case.
  ///
  /// @param paths   of one object, not empty; each with points at all horizons
  /// @param future  true positions
  /// @throws std::invalid_argument if there is no path or a path has other horizons
  void add(ObjectClass object_class, const std::vector<PredictedPath>& paths,
           const HorizonPath& future);

  /// Adds the cases of another evaluator.
  void add(const PredictionEvaluator& other);

  [[nodiscard]] PredictionErrors errors() const;

 private:
  struct Sums {
    std::size_t cases = 0;
    std::size_t with_covariance = 0;
    std::array<double, kHorizons> error{};
    std::array<std::size_t, 3> misses{};
    double best_ade = 0.0;
    std::array<std::array<std::size_t, 3>, 3> inside{};
    double nees = 0.0;

    void add(const std::vector<PredictedPath>& paths, const HorizonPath& future);
    void addCoverage(const PredictedPath& path, const HorizonPath& future);
    void add(const Sums& other);
    [[nodiscard]] PredictionError errors() const;
  };
  std::map<ObjectClass, Sums> classes_;
};

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
