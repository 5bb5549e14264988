// SPDX-License-Identifier: BSD-3-Clause
// Data association: which detections are one object, and which track each of them continues (Sec.
// III-C3).
#pragma once

#include <headway/core/assignment.h>
#include <headway/objects/objects_params.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "measurement_model.h"

namespace headway::objects {

/// Positions on the ground plane sorted into square cells, for neighbour queries.
///
/// A query visits nine cells, so that its cost depends on the local density and not on the total
/// number of positions.
class SpatialGrid {
 public:
  /// @param places   anything with a `position` in the map frame
  /// @param cell_m   edge of a cell, the radius of queries; 1 cm at least
  template <typename Placed>
  SpatialGrid(const std::vector<Placed>& places, double cell_m) : cell_m_(std::max(cell_m, 0.01)) {
    entries_.reserve(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& position = places[i].position;
      entries_.push_back(
          {keyOf(cellOf(position.x()), cellOf(position.y())), i, position.x(), position.y()});
    }
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls `visit(index)` for every position in the cell of `position` and its eight neighbours:
  /// for all positions within `cell_m`, and some beyond.
  template <typename Visit>
  void visitNear(const Eigen::Vector2d& position, Visit visit) const {
    visitEntries(position, [&](const Entry& entry) { visit(entry.index); });
  }

  /// The same for positions within a radius of at most `cell_m`, read where they are side by side.
  template <typename Visit>
  void visitWithin(const Eigen::Vector2d& position, double radius_m, Visit visit) const {
    visitEntries(position, [&](const Entry& entry) {
      const double x = entry.x - position.x();
      const double y = entry.y - position.y();
      if (x * x + y * y <= radius_m * radius_m) visit(entry.index);
    });
  }

 private:
  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 30;  ///< each way

  struct Entry {
    std::int64_t key;  ///< of the cell
    std::size_t index;
    double x, y;  ///< [m]
    bool operator<(const Entry& other) const {
      return std::tie(key, index) < std::tie(other.key, other.index);
    }
  };

  template <typename Visit>
  void visitEntries(const Eigen::Vector2d& position, Visit visit) const {
    const std::int64_t column = cellOf(position.x());
    const std::int64_t row = cellOf(position.y());
    for (std::int64_t i = column - 1; i <= column + 1; ++i) {
      // Cells of one column have consecutive keys.
      const std::int64_t last = keyOf(i, row + 1);
      auto entry =
          std::lower_bound(entries_.begin(), entries_.end(), Entry{keyOf(i, row - 1), 0, 0.0, 0.0});
      for (; entry != entries_.end() && entry->key <= last; ++entry) visit(*entry);
    }
  }

  [[nodiscard]] std::int64_t cellOf(double coordinate) const {
    const double cell = std::floor(coordinate / cell_m_);
    const double limit = static_cast<double>(kMaxCells);
    return static_cast<std::int64_t>(std::clamp(cell, -limit, limit));
  }
  static std::int64_t keyOf(std::int64_t column, std::int64_t row) {
    return column * 4 * kMaxCells + row;
  }

  double cell_m_;
  std::vector<Entry> entries_;
};

/// Removes the pairs that belong to an optimal assignment independently of all others.
///
/// Leaving a row or a column unpaired costs 0. A pair is obvious if it costs no more than the best
/// other pair of its row and the best other pair of its column together: were those chosen
/// instead, exchanging them for it would not cost more. In a crowd that is tracked well nearly all
/// pairs are obvious, which splits one large assignment into many small ones.
///
/// @param candidates  each pair once; reduced to those that neither are obvious nor have a row or
///                    column of an obvious one
/// @return            the obvious pairs, in the order of the candidates
[[nodiscard]] std::vector<CandidatePair> takeObviousPairs(std::vector<CandidatePair>& candidates);

/// Assignment of detections to tracks.
struct Matches {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< (track, detection), by track
  std::vector<std::size_t> unmatched_detections;           ///< each of a new object
};

/// One box for each object, and their duplicates.
struct DistinctBoxes {
  std::vector<MeasuredBox> boxes;
  std::vector<std::pair<std::size_t, MeasuredBox>> duplicates;  ///< index in `boxes`, duplicate

  /// Of a box and its duplicates, the one nearest to the track's prediction.
  [[nodiscard]] const MeasuredBox& likeliest(std::size_t box, const ExpectedPlace& track) const;
};

/// Whether a detector may confuse two classes; Unknown and Misc are compatible with all.
[[nodiscard]] bool compatible(ObjectClass a, ObjectClass b);

/// The consistency check of Sec. III-C3.
///
/// The cost of a pair is -2 log of the likelihood ratio of the detection under the track's
/// predicted Gaussian and as a new object; pairs are assigned at minimum total cost. The result
/// does not depend on the order of tracks or detections.
class ConsistencyCheck {
 public:
  explicit ConsistencyCheck(const ConsistencyParams& params) : params_(params) {}

  /// Keeps the box with the best score of each object.
  [[nodiscard]] DistinctBoxes withoutDuplicates(std::vector<MeasuredBox> boxes) const;

  [[nodiscard]] Matches match(const std::vector<ExpectedPlace>& tracks,
                              const std::vector<MeasuredBox>& detections) const;

 private:
  /// Distance beyond which no detection of such a variance matches a track [m].
  [[nodiscard]] double maxGate(const ExpectedPlace& track, double variance) const;
  [[nodiscard]] bool sameObject(const MeasuredBox& a, const MeasuredBox& b) const;
  /// -2 log of the likelihood ratio against a new object; nullopt outside the gate.
  [[nodiscard]] std::optional<double> cost(const ExpectedPlace& track,
                                           const MeasuredBox& detection) const;

  ConsistencyParams params_;
};

}  // namespace headway::objects
