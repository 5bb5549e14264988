// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/assignment.h>
#include <headway/eval/prediction_cases.h>

#include <cmath>

namespace headway::eval {
namespace {

constexpr std::size_t kHistoryFrames = 20;  // before the current one
constexpr double kHorizonEnd_s = kHorizonStep_s * kHorizons;

bool isMovableClass(ObjectClass object_class) {
  return isVehicle(object_class) || object_class == ObjectClass::kPedestrian ||
         object_class == ObjectClass::kCyclist;
}

/// True positions at all horizons; nullopt if the truth ends earlier or has a gap.
std::optional<HorizonPath> futureOf(const TrueObject& object, Time now, double max_gap_s) {
  HorizonPath future;
  for (std::size_t j = 0; j < kHorizons; ++j) {
    const auto position =
        object.positionAt(now + kHorizonStep_s * static_cast<double>(j + 1), max_gap_s);
    if (!position) return std::nullopt;
    future[j] = position->head<2>();
  }
  return future;
}

/// Whether the path has every frame between its points `first` and `last`.
bool isConsecutive(const TrueObject& object, std::size_t first, std::size_t last) {
  return last < object.path.size() &&
         object.path[last].frame - object.path[first].frame == last - first;
}

/// Whether a track of class `tracked` may be an object; one of unknown class may be any.
bool mayBe(ObjectClass object_class, ObjectClass tracked) {
  return tracked == ObjectClass::kUnknown || tracked == object_class;
}

/// Pairs of predictions and true objects within `max_distance_m` at the first horizon.
std::vector<CandidatePair> nearby(const std::vector<TrueObject>& objects,
                                  const std::vector<TrackPrediction>& predictions,
                                  const std::vector<std::size_t>& rows, double max_distance_m,
                                  double max_gap_s) {
  std::vector<CandidatePair> pairs;
  for (const std::size_t row : rows) {
    const auto& prediction = predictions[row];
    const auto& next = prediction.paths.front().points.front();
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (!mayBe(objects[i].object_class, prediction.object_class)) continue;
      const auto truth = objects[i].positionAt(prediction.time + next.horizon_s, max_gap_s);
      if (!truth) continue;
      const double distance = (next.position - *truth).head<2>().norm();
      if (distance <= max_distance_m) pairs.push_back({row, i, distance});
    }
  }
  return pairs;
}

}  // namespace

std::vector<HistoryCase> historyCases(const std::vector<TrueObject>& objects,
                                      double frame_interval_s) {
  const auto later = static_cast<std::size_t>(std::lround(kHorizonEnd_s / frame_interval_s));
  std::vector<HistoryCase> cases;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto& object = objects[i];
    if (!isMovableClass(object.object_class)) continue;
    for (std::size_t first = 0; first < object.path.size(); ++first) {
      const std::size_t now = first + kHistoryFrames;
      if (!isConsecutive(object, first, now + later)) continue;
      const auto future = futureOf(object, object.path[now].time, 2.0 * frame_interval_s);
      if (!future) continue;
      const auto begin = object.path.begin() + static_cast<std::ptrdiff_t>(first);
      cases.push_back({i, {begin, begin + kHistoryFrames + 1}, *future});
    }
  }
  return cases;
}

TrackCases trackCases(const std::vector<TrueObject>& objects,
                      const std::vector<TrackPrediction>& predictions, double max_distance_m,
                      double max_gap_s) {
  std::map<std::size_t, std::vector<std::size_t>> rows_of_frame;
  for (std::size_t row = 0; row < predictions.size(); ++row) {
    rows_of_frame[predictions[row].frame].push_back(row);
  }
  TrackCases result;
  for (const auto& [frame, rows] : rows_of_frame) {
    const auto pairs = assignPairs(nearby(objects, predictions, rows, max_distance_m, max_gap_s));
    result.unmatched += rows.size() - pairs.size();
    for (const auto& pair : pairs) {
      const auto future = futureOf(objects[pair.column], predictions[pair.row].time, max_gap_s);
      if (future) {
        result.cases.push_back({pair.row, pair.column, *future});
      } else {
        ++result.cut_short;
      }
    }
  }
  return result;
}

}  // namespace headway::eval
