#include <headway/eval/track_error.h>

#include <cmath>
#include <limits>

#include "clear_mot.h"
#include "hota.h"
#include "position_accuracy.h"

namespace headway::eval {
namespace {

/// All that is counted of one class, or of several together.
struct Tally {
  PositionCounts positions;
  ClearCounts clear;
  HotaCounts hota;

  void add(const Tally& other) {
    positions.add(other.positions);
    clear.add(other.clear);
    hota.add(other.hota);
  }
};

std::optional<double> share(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

void fillPositions(const PositionCounts& counts, TrackError& result) {
  result.precision = share(counts.tp, counts.tp + counts.fp);
  result.recall = share(counts.tp, counts.tp + counts.fn);
  result.f1 = share(2 * counts.tp, 2 * counts.tp + counts.fp + counts.fn);
  if (counts.measured > 0) {
    result.rmse_m = std::sqrt(counts.squared_sum_m2 / static_cast<double>(counts.measured));
  }
}

TrackError figuresOf(const Tally& tally) {
  TrackError result;
  fillPositions(tally.positions, result);
  const auto& clear = tally.clear;
  result.truth_boxes = clear.truth();
  result.tp = clear.tp;
  result.fp = clear.fp;
  result.fn = clear.fn;
  result.idsw = clear.idsw;
  result.frag = clear.frag;
  if (clear.tp > 0) result.motp = clear.overlap_sum / static_cast<double>(clear.tp);
  if (clear.truth() == 0) return result;
  result.mota = clear.mota();
  const auto hota = hotaOf(tally.hota);
  result.hota = hota.hota;
  result.deta = hota.deta;
  result.assa = hota.assa;
  return result;
}

/// Judges one class; what it counted is added to `all`.
TrackError classError(const std::vector<LabelledSequence>& sequences, ObjectClass object_class,
                      const TrackErrorParams& params, Tally& all) {
  std::vector<ClassSequence> prepared;
  for (const auto& sequence : sequences) {
    prepared.push_back(classSequence(sequence, object_class, params));
  }
  Tally tally;
  for (const auto& sequence : prepared) tally.positions.add(positionCounts(sequence));
  if (params.positions_only) {
    all.add(tally);
    return figuresOf(tally);
  }
  const auto curve = clearCurve(prepared, params.min_overlap);
  const double threshold = curve ? curve->best_threshold : -std::numeric_limits<double>::infinity();
  tally.clear = curve ? curve->best : clearCounts(prepared, params.min_overlap, threshold);
  for (const auto& sequence : prepared) {
    tally.hota.add(hotaCounts(sequence, params.min_overlap, threshold));
  }
  all.add(tally);
  auto result = figuresOf(tally);
  if (!curve) return result;
  if (std::isfinite(threshold)) result.score_threshold = threshold;
  result.samota = curve->samota;
  result.amota = curve->amota;
  result.curve = curve->points;
  return result;
}

/// Mean over the classes that have truth.
std::optional<double> meanOf(const std::map<ObjectClass, TrackError>& classes,
                             std::optional<double> TrackError::*figure) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [object_class, error] : classes) {
    if (!(error.*figure)) continue;
    sum += *(error.*figure);
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

}  // namespace

TrackErrors trackErrors(const std::vector<LabelledSequence>& sequences,
                        const TrackErrorParams& params) {
  TrackErrors result;
  Tally all;
  for (const auto object_class : params.classes) {
    result.classes[object_class] = classError(sequences, object_class, params, all);
  }
  result.all = figuresOf(all);
  result.all.samota = meanOf(result.classes, &TrackError::samota);
  result.all.amota = meanOf(result.classes, &TrackError::amota);
  return result;
}

}  // namespace headway::eval
