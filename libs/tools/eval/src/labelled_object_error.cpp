// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/assignment.h>
#include <headway/eval/moving_object_error.h>

#include <algorithm>
#include <cmath>

#include "label_matching.h"

namespace headway::eval {
namespace {

ObjectClass withoutVans(ObjectClass object_class) {
  return object_class == ObjectClass::kVan ? ObjectClass::kCar : object_class;
}

/// Pairs the labels of one frame with its rows.
std::vector<CandidatePair> pairsOf(const std::vector<LabelledBox>& labels,
                                   const std::vector<const TrackRow*>& rows,
                                   const MovingObjectParams& params) {
  std::vector<CandidatePair> candidates;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!labels[i].box3d) continue;
    const Eigen::Vector3d& centre = labels[i].box3d->centre;
    const double gate = matchingDistance(params, groundRange(centre));
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const double distance = groundRange(rows[j]->centre - centre);
      if (distance <= gate) candidates.push_back({i, j, distance});
    }
  }
  return assignPairs(std::move(candidates));
}

}  // namespace

std::optional<double> LabelledObjectCounts::recall() const { return ratioOf(found, labels); }

std::optional<double> LabelledObjectCounts::classRatio() const {
  return ratioOf(found_as_class, found);
}

LabelledObjectError labelledObjectError(const MovingObjectInput& input,
                                        const MovingObjectParams& params) {
  std::map<std::size_t, std::vector<const TrackRow*>> rows_by_frame;
  for (const auto& row : input.rows) {
    if (params.with_coasting || !row.coasting) rows_by_frame[row.frame].push_back(&row);
  }
  LabelledObjectError error;
  const std::size_t end = std::min(input.end_frame, input.labels.size());
  for (std::size_t k = input.first_frame; k < end; ++k) {
    const auto& labels = input.labels[k].truth;
    const auto& rows = rows_by_frame[k];
    std::vector<const TrackRow*> row_of(labels.size(), nullptr);
    for (const auto& pair : pairsOf(labels, rows, params)) row_of[pair.row] = rows[pair.column];
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const LabelledBox& label = labels[i];
      if (!label.box3d || label.occlusion > error.max_occlusion) continue;
      if (groundRange(label.box3d->centre) > error.max_range_m) continue;
      const TrackRow* row = row_of[i];
      const bool as_class =
          row != nullptr && withoutVans(row->object_class) == withoutVans(label.object_class);
      for (auto* counts : {&error.all, &error.classes[std::string(toString(label.object_class))]}) {
        ++counts->labels;
        counts->found += row != nullptr ? 1 : 0;
        counts->found_as_class += as_class ? 1 : 0;
      }
    }
  }
  return error;
}

}  // namespace headway::eval
