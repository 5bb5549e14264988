// SPDX-License-Identifier: BSD-3-Clause
// Data association: which detections are one object, and which track each of them continues (Sec.
// III-C3).
#include "consistency.h"

#include <headway/core/assignment.h>
#include <headway/core/box_overlap.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace headway::objects {
namespace {

// The two lowest costs of one row or column, including that of no assignment (0).
struct Least {
  double first = 0.0;
  double second = 0.0;

  void add(double cost) {
    if (cost < first) {
      second = first;
      first = cost;
    } else {
      second = std::min(second, cost);
    }
  }
  /// The lowest cost without one of the added costs.
  [[nodiscard]] double without(double cost) const { return cost <= first ? second : first; }
};

// Volume of intersection over volume of union of two upright boxes in the map.
double overlap(const MeasuredBox& a, const MeasuredBox& b) {
  const double reach = 0.5 * (a.size.head<2>().sum() + b.size.head<2>().sum());  // at least
  if ((a.position - b.position).head<2>().squaredNorm() > reach * reach) return 0.0;
  const double bottom =
      std::max(a.position.z() - 0.5 * a.size.z(), b.position.z() - 0.5 * b.size.z());
  const double top = std::min(a.position.z() + 0.5 * a.size.z(), b.position.z() + 0.5 * b.size.z());
  if (!(top > bottom)) return 0.0;
  const Footprint ground_a{a.position.head<2>(), a.size.x(), a.size.y(), a.yaw};
  const Footprint ground_b{b.position.head<2>(), b.size.x(), b.size.y(), b.yaw};
  const double both = intersectionArea(ground_a, ground_b) * (top - bottom);
  return both / (a.size.prod() + b.size.prod() - both);
}

/// Distance from a box's centre beyond which nothing of it lies, of the largest one [m].
[[nodiscard]] double widestReach(const std::vector<MeasuredBox>& boxes) {
  double widest = 0.0;
  for (const MeasuredBox& box : boxes) widest = std::max(widest, 0.5 * box.size.head<2>().sum());
  return widest;
}

/// A network sees a rider as a person where the bicycle is hidden.
bool isPerson(ObjectClass object_class) {
  return object_class == ObjectClass::kPedestrian || object_class == ObjectClass::kCyclist ||
         object_class == ObjectClass::kPersonSitting;
}

}  // namespace

std::vector<CandidatePair> takeObviousPairs(std::vector<CandidatePair>& candidates) {
  std::size_t row_count = 0;
  std::size_t column_count = 0;
  for (const CandidatePair& pair : candidates) {
    row_count = std::max(row_count, pair.row + 1);
    column_count = std::max(column_count, pair.column + 1);
  }
  std::vector<Least> rows(row_count);
  std::vector<Least> columns(column_count);
  for (const CandidatePair& pair : candidates) {
    rows[pair.row].add(pair.cost);
    columns[pair.column].add(pair.cost);
  }
  std::vector<CandidatePair> obvious;
  std::vector<bool> row_taken(row_count, false);
  std::vector<bool> column_taken(column_count, false);
  for (const CandidatePair& pair : candidates) {
    const double others =
        rows[pair.row].without(pair.cost) + columns[pair.column].without(pair.cost);
    if (!(pair.cost < 0.0 && pair.cost < others)) continue;
    obvious.push_back(pair);
    row_taken[pair.row] = true;
    column_taken[pair.column] = true;
  }
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const CandidatePair& pair) {
                                    return row_taken[pair.row] || column_taken[pair.column];
                                  }),
                   candidates.end());
  return obvious;
}

bool compatible(ObjectClass a, ObjectClass b) {
  const MotionGroup group_a = motionGroupOf(a);
  const MotionGroup group_b = motionGroupOf(b);
  return group_a == group_b || group_a == MotionGroup::kOther || group_b == MotionGroup::kOther;
}

bool ConsistencyCheck::sameObject(const MeasuredBox& a, const MeasuredBox& b) const {
  if (!compatible(a.object_class, b.object_class)) return false;
  const double near = params_.duplicate_distance_ratio * std::min(a.size.y(), b.size.y());
  if ((a.position - b.position).squaredNorm() < near * near) return true;
  if (overlap(a, b) > params_.duplicate_iou_3d) return true;
  return a.box2d && b.box2d && overlap2d(*a.box2d, *b.box2d) > params_.duplicate_iou_2d;
}

DistinctBoxes ConsistencyCheck::withoutDuplicates(std::vector<MeasuredBox> boxes) const {
  std::vector<std::size_t> by_score(boxes.size());
  std::iota(by_score.begin(), by_score.end(), std::size_t{0});
  std::stable_sort(by_score.begin(), by_score.end(),
                   [&](std::size_t a, std::size_t b) { return boxes[a].score > boxes[b].score; });
  const double widest = 2.0 * std::max(1.0, params_.duplicate_distance_ratio) * widestReach(boxes);
  const bool in_images = std::any_of(boxes.begin(), boxes.end(),
                                     [](const MeasuredBox& box) { return box.box2d.has_value(); });
  const SpatialGrid grid(boxes, in_images ? std::max(widest, params_.max_gate_m) : widest);
  constexpr std::size_t kUndecided = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> same_as(boxes.size(), kUndecided);  // itself if it is kept
  for (const std::size_t i : by_score) {
    std::size_t first = i;
    // Boxes in the image may overlap at any distance.
    const double radius = boxes[i].box2d ? std::numeric_limits<double>::infinity() : widest;
    grid.visitWithin(boxes[i].position.head<2>(), radius, [&](std::size_t j) {
      const bool better = first == i || boxes[j].score > boxes[first].score;
      if (better && same_as[j] == j && sameObject(boxes[i], boxes[j])) first = j;
    });
    same_as[i] = first;
  }
  DistinctBoxes result;
  result.boxes.reserve(boxes.size());
  std::vector<std::size_t> kept_as(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    kept_as[i] = result.boxes.size();
    if (same_as[i] == i) result.boxes.push_back(std::move(boxes[i]));
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (same_as[i] != i) result.duplicates.emplace_back(kept_as[same_as[i]], std::move(boxes[i]));
  }
  return result;
}

const MeasuredBox& DistinctBoxes::likeliest(std::size_t box, const ExpectedPlace& track) const {
  const auto squaredDistance = [&](const MeasuredBox& measured) {
    const Eigen::Vector2d offset = (measured.position - track.position).head<2>();
    return offset.dot((track.covariance + measured.covariance).inverse() * offset);
  };
  const MeasuredBox* best = &boxes[box];
  for (const auto& [same, duplicate] : duplicates) {
    if (same == box && squaredDistance(duplicate) < squaredDistance(*best)) best = &duplicate;
  }
  return *best;
}

std::optional<double> ConsistencyCheck::cost(const ExpectedPlace& track,
                                             const MeasuredBox& detection) const {
  constexpr double kProvisionalClassCost = 2.0;  // a provisional class is wrong in 1 of 3 cases
  const bool same_kind = compatible(track.object_class, detection.object_class);
  const bool may_ride = detection.evidence.classifier_tested && isPerson(track.object_class) &&
                        isPerson(detection.object_class);
  if (!same_kind && !may_ride && !detection.classIsProvisional()) return std::nullopt;
  const Eigen::Vector3d offset = detection.position - track.position;
  if (offset.head<2>().squaredNorm() > params_.max_gate_m * params_.max_gate_m) return std::nullopt;
  const double blur = params_.gate_blur_m * params_.gate_blur_m;
  const Eigen::Matrix2d S =
      track.covariance + detection.covariance + blur * Eigen::Matrix2d::Identity();
  const double determinant = S.determinant();
  const double squared_distance =
      (S(1, 1) * offset.x() * offset.x() - 2.0 * S(0, 1) * offset.x() * offset.y() +
       S(0, 0) * offset.y() * offset.y()) /
      determinant;
  const double vertical =
      offset.z() * offset.z() / (track.vertical_variance + detection.vertical_variance + blur);
  const double gate = params_.gate_sigma * params_.gate_sigma;
  if (squared_distance > gate || vertical > gate) return std::nullopt;
  const double spread = 2.0 * M_PI * params_.new_object_density_per_m2;
  const bool hinted = (track.detector_id && track.detector_id == detection.detector_id) ||
                      detection.searched_track == track.track;
  return squared_distance + vertical + std::log(spread * spread * determinant) -
         (hinted ? params_.detector_id_bonus : 0.0) + (same_kind ? 0.0 : kProvisionalClassCost);
}

// A pair is made if its cost is negative: within the gate, and nearer than where a new object is
// likelier, which is nearer the less certain the track's place. The determinant of a sum of
// covariances is at least that of one; the trace is at least the largest eigenvalue.
double ConsistencyCheck::maxGate(const ExpectedPlace& track, double variance) const {
  constexpr double kMargin = 1.0 + 1e-6;
  constexpr double kRounding = 1e-2;
  const double blur = params_.gate_blur_m * params_.gate_blur_m;
  const Eigen::Matrix2d own = track.covariance + blur * Eigen::Matrix2d::Identity();
  const double spread = 2.0 * M_PI * params_.new_object_density_per_m2;
  const double likelier =
      params_.detector_id_bonus - std::log(spread * spread * own.determinant()) + kRounding;
  const double gate = std::min(params_.gate_sigma * params_.gate_sigma, likelier);
  if (!(gate > 0.0)) return 0.0;
  const double largest =
      0.5 * own.trace() + std::hypot(0.5 * (own(0, 0) - own(1, 1)), own(0, 1)) + variance;
  return std::min(params_.max_gate_m, kMargin * std::sqrt(gate * largest));
}

Matches ConsistencyCheck::match(const std::vector<ExpectedPlace>& tracks,
                                const std::vector<MeasuredBox>& detections) const {
  double widest = 0.0;  // variance of a detection
  for (const MeasuredBox& box : detections) widest = std::max(widest, box.covariance.trace());
  std::vector<double> gates(tracks.size());
  std::transform(tracks.begin(), tracks.end(), gates.begin(),
                 [&](const ExpectedPlace& track) { return maxGate(track, widest); });
  const SpatialGrid grid(detections,
                         gates.empty() ? 0.0 : *std::max_element(gates.begin(), gates.end()));
  std::vector<CandidatePair> candidates;
  candidates.reserve(4 * tracks.size());  // usual in a crowd
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    grid.visitWithin(tracks[i].position.head<2>(), gates[i], [&](std::size_t j) {
      const auto pair_cost = cost(tracks[i], detections[j]);
      if (pair_cost && *pair_cost < 0.0) candidates.push_back({i, j, *pair_cost});
    });
  }
  Matches matches;
  // A detection that starts a track costs 0.
  for (const CandidatePair& pair : takeObviousPairs(candidates)) {
    matches.pairs.emplace_back(pair.row, pair.column);
  }
  for (const CandidatePair& pair : assignPairs(std::move(candidates), 0.0)) {
    matches.pairs.emplace_back(pair.row, pair.column);
  }
  std::sort(matches.pairs.begin(), matches.pairs.end());
  std::vector<bool> matched(detections.size(), false);
  for (const auto& pair : matches.pairs) matched[pair.second] = true;
  for (std::size_t j = 0; j < detections.size(); ++j) {
    if (!matched[j]) matches.unmatched_detections.push_back(j);
  }
  return matches;
}

}  // namespace headway::objects
