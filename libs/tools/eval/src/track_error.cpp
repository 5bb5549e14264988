// SPDX-License-Identifier: BSD-3-Clause
// Accuracy of tracks: CLEAR MOT, HOTA and positions.
#include <headway/core/assignment.h>
#include <headway/core/box_overlap.h>
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/track_error.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace headway::eval {
namespace {

struct TrueBox {
  int track = 0;         ///< index of its object within the sequence
  bool ignored = false;  ///< excluded from true positives and misses
};

struct EstimatedBox {
  int track = 0;                      ///< index of its track within the sequence
  double score = 0.0;                 ///< mean score of its track
  bool ignored_if_unmatched = false;  ///< not a false positive if unmatched
};

/// Boxes of one class in one frame. Rows of pairs are true boxes, columns estimated boxes.
struct ClassFrame {
  std::vector<TrueBox> truth;
  std::vector<EstimatedBox> estimates;
  std::vector<CandidatePair> overlaps;  ///< overlapping pairs; cost: 1 - overlap
  std::vector<CandidatePair>
      positions;  ///< pairs with correct positions; cost: distance or 1 - overlap
  std::vector<std::optional<double>> position_errors_m;  ///< of `positions`, on the ground
};

/// Boxes of one class in one sequence.
struct ClassSequence {
  std::vector<ClassFrame> frames;
  int true_tracks = 0;
  int estimated_tracks = 0;
};

/// Matches of one frame.
struct FrameMatches {
  static constexpr int kNone = -1;
  static constexpr int kExcluded = -2;  ///< score below the threshold
  std::vector<int> estimate_of;         ///< per true box: column or kNone
  std::vector<int> truth_of;            ///< per estimate: row, kNone or kExcluded
};

/// Matches estimates with truth frame by frame (CLEAR MOT).
///
/// Matches of the previous frame are kept while they overlap enough; the rest is assigned with the
/// maximum number of matches and, among these, the maximum overlap.
///
/// @see Bernardin & Stiefelhagen 2008, Sec. 2.1.2
class FrameMatcher {
 public:
  FrameMatcher(const ClassSequence& sequence, double min_overlap, double score_threshold)
      : min_overlap_(min_overlap),
        score_threshold_(score_threshold),
        previous_(static_cast<std::size_t>(sequence.true_tracks), FrameMatches::kNone) {}

  [[nodiscard]] FrameMatches match(const ClassFrame& frame);

 private:
  double min_overlap_;
  double score_threshold_;
  std::vector<int> previous_;  ///< estimated track of each true one in the previous frame, or kNone
};

/// Counts of CLEAR MOT.
struct ClearCounts {
  std::size_t tp = 0, fp = 0, fn = 0, idsw = 0, frag = 0;
  double overlap_sum = 0.0;         ///< of the true positives
  std::vector<double> true_scores;  ///< track scores of the true positives

  [[nodiscard]] std::size_t truth() const { return tp + fn; }
  [[nodiscard]] std::size_t errors() const { return fp + fn + idsw; }
  [[nodiscard]] double mota() const;  ///< requires truth() > 0
  void add(const ClearCounts& other);
};

/// CLEAR MOT over the score thresholds of a class.
struct ClearCurve {
  ClearCounts best;  ///< at the threshold of maximum MOTA
  double best_threshold = 0.0;
  std::vector<RecallPoint> points;
  double samota = 0.0;
  double amota = 0.0;
};

/// Counts of HOTA at the overlaps 0.05, 0.10 .. 0.95.
struct HotaCounts {
  static constexpr std::size_t kLevels = 19;
  struct Level {
    std::size_t tp = 0, fp = 0, fn = 0;
    double association_sum = 0.0;  ///< association score of the true positives, 0..1 each
  };
  std::array<Level, kLevels> levels;

  void add(const HotaCounts& other);
};

/// Means over all levels.
struct Hota {
  double hota = 0.0;
  double deta = 0.0;
  double assa = 0.0;
};

/// Class whose confusion with the given one is not an error.
std::optional<ObjectClass> neighbourOf(ObjectClass object_class) {
  if (object_class == ObjectClass::kCar) return ObjectClass::kVan;
  if (object_class == ObjectClass::kPedestrian) return ObjectClass::kPersonSitting;
  return std::nullopt;
}

bool isIgnored(const LabelledBox& truth, ObjectClass object_class, const TrackErrorParams& params) {
  return truth.object_class != object_class || truth.occlusion > params.max_occlusion ||
         truth.truncation > params.max_truncation;
}

bool isIgnoredIfUnmatched(const LabelledBox& estimate, const std::vector<Box2d>& dont_care,
                          const TrackErrorParams& params) {
  if (!estimate.box2d) return false;
  if (estimate.box2d->height() <= params.min_height_px) return true;
  return std::any_of(dont_care.begin(), dont_care.end(), [&](const Box2d& region) {
    return ratioInside(*estimate.box2d, region) > params.dont_care_ratio;
  });
}

double overlapOf(const LabelledBox& a, const LabelledBox& b, BoxMetric metric) {
  if (metric == BoxMetric::k2d) return a.box2d && b.box2d ? overlap2d(*a.box2d, *b.box2d) : 0.0;
  return a.box3d && b.box3d ? overlap3d(*a.box3d, *b.box3d) : 0.0;
}

std::optional<double> groundDistance(const LabelledBox& a, const LabelledBox& b) {
  if (!a.box3d || !b.box3d) return std::nullopt;
  const Eigen::Vector3d offset = a.box3d->centre - b.box3d->centre;
  return std::hypot(offset.x(), offset.z());
}

/// Indexes ids in ascending order, so that indices do not depend on the order of rows.
class TrackIndices {
 public:
  void add(std::int64_t id) { index_.emplace(id, 0); }
  void assign() {
    int next = 0;
    for (auto& [id, index] : index_) index = next++;
  }
  [[nodiscard]] int of(std::int64_t id) const { return index_.at(id); }
  [[nodiscard]] int count() const { return static_cast<int>(index_.size()); }

 private:
  std::map<std::int64_t, int> index_;
};

void addPairs(ClassFrame& frame, const std::vector<const LabelledBox*>& truth,
              const std::vector<const LabelledBox*>& estimates, const TrackErrorParams& params) {
  for (std::size_t i = 0; i < truth.size(); ++i) {
    for (std::size_t j = 0; j < estimates.size(); ++j) {
      const double overlap = overlapOf(*truth[i], *estimates[j], params.metric);
      if (overlap > 0.0) frame.overlaps.push_back({i, j, 1.0 - overlap});
      const auto distance = groundDistance(*truth[i], *estimates[j]);
      const bool is_3d = params.metric == BoxMetric::k3d;
      const bool is_correct =
          is_3d ? distance && *distance <= params.max_distance_m : overlap >= params.min_overlap;
      if (!is_correct) continue;
      frame.positions.push_back({i, j, is_3d ? *distance : 1.0 - overlap});
      frame.position_errors_m.push_back(distance);
    }
  }
}

struct IndexedTracks {
  TrackIndices truth;
  TrackIndices estimates;
  std::vector<double> mean_score;  ///< of each estimated track
};

IndexedTracks indexedTracks(const LabelledSequence& sequence, ObjectClass object_class) {
  IndexedTracks result;
  std::map<std::int64_t, std::pair<double, double>> scores;  // id -> sum, count
  for (const auto& frame : sequence.frames) {
    for (const auto& box : frame.truth) result.truth.add(box.id);
    for (const auto& box : frame.estimates) {
      if (box.object_class != object_class) continue;
      result.estimates.add(box.id);
      scores[box.id].first += box.score;
      scores[box.id].second += 1.0;
    }
  }
  result.truth.assign();
  result.estimates.assign();
  for (const auto& [id, score] : scores) result.mean_score.push_back(score.first / score.second);
  return result;
}

void addMatch(FrameMatches& matches, const CandidatePair& pair) {
  matches.estimate_of[pair.row] = static_cast<int>(pair.column);
  matches.truth_of[pair.column] = static_cast<int>(pair.row);
}

/// Selects the boxes of one class and its neighbouring class, with the candidate pairs.
ClassSequence classSequence(const LabelledSequence& sequence, ObjectClass object_class,
                            const TrackErrorParams& params) {
  const auto tracks = indexedTracks(sequence, object_class);
  ClassSequence result;
  result.true_tracks = tracks.truth.count();
  result.estimated_tracks = tracks.estimates.count();
  for (const auto& labelled : sequence.frames) {
    ClassFrame frame;
    std::vector<const LabelledBox*> truth;
    std::vector<const LabelledBox*> estimates;
    for (const auto& box : labelled.truth) {
      if (box.object_class != object_class && box.object_class != neighbourOf(object_class)) {
        continue;
      }
      truth.push_back(&box);
      frame.truth.push_back({tracks.truth.of(box.id), isIgnored(box, object_class, params)});
    }
    for (const auto& box : labelled.estimates) {
      if (box.object_class != object_class) continue;
      const int track = tracks.estimates.of(box.id);
      estimates.push_back(&box);
      frame.estimates.push_back({track, tracks.mean_score[static_cast<std::size_t>(track)],
                                 isIgnoredIfUnmatched(box, labelled.dont_care, params)});
    }
    addPairs(frame, truth, estimates, params);
    result.frames.push_back(std::move(frame));
  }
  return result;
}

FrameMatches FrameMatcher::match(const ClassFrame& frame) {
  FrameMatches matches;
  matches.estimate_of.assign(frame.truth.size(), FrameMatches::kNone);
  for (const auto& estimate : frame.estimates) {
    const bool counts = estimate.score >= score_threshold_;
    matches.truth_of.push_back(counts ? FrameMatches::kNone : FrameMatches::kExcluded);
  }
  std::vector<CandidatePair> candidates;
  for (const auto& pair : frame.overlaps) {
    if (1.0 - pair.cost < min_overlap_) continue;
    if (matches.truth_of[pair.column] == FrameMatches::kExcluded) continue;
    candidates.push_back(pair);
  }
  for (const auto& pair : candidates) {
    const bool is_free = matches.estimate_of[pair.row] == FrameMatches::kNone &&
                         matches.truth_of[pair.column] == FrameMatches::kNone;
    const int previous = previous_[static_cast<std::size_t>(frame.truth[pair.row].track)];
    if (is_free && previous == frame.estimates[pair.column].track) addMatch(matches, pair);
  }
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const CandidatePair& pair) {
                                    return matches.estimate_of[pair.row] != FrameMatches::kNone ||
                                           matches.truth_of[pair.column] != FrameMatches::kNone;
                                  }),
                   candidates.end());
  for (const auto& pair : assignPairs(std::move(candidates))) addMatch(matches, pair);
  std::fill(previous_.begin(), previous_.end(), FrameMatches::kNone);
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const int j = matches.estimate_of[i];
    if (j == FrameMatches::kNone) continue;
    previous_[static_cast<std::size_t>(frame.truth[i].track)] =
        frame.estimates[static_cast<std::size_t>(j)].track;
  }
  return matches;
}

constexpr int kRecalls = 40;

/// Track of a true object's latest match, or kNone.
using LatestTracks = std::vector<int>;

void countTruth(const TrueBox& truth, int estimated_track, int& latest_track, ClearCounts& counts) {
  if (truth.ignored) {
    latest_track = FrameMatches::kNone;
    return;
  }
  if (estimated_track == FrameMatches::kNone) {
    ++counts.fn;
    return;
  }
  if (latest_track != FrameMatches::kNone && latest_track != estimated_track) ++counts.idsw;
  latest_track = estimated_track;
}

/// Counts fragmentations as TrackEval does: the times that a true object is matched after a frame
/// in which it was not (unmatched, ignored or not labelled), without the first.
///
/// Frames without truth, or without estimates, that are not ignored are passed over.
class FragmentCounter {
 public:
  explicit FragmentCounter(const ClassSequence& sequence)
      : matched_(static_cast<std::size_t>(sequence.true_tracks), false), ever_matched_(matched_) {}

  [[nodiscard]] std::size_t count(const ClassFrame& frame, const FrameMatches& matches) {
    if (!hasTruth(frame) || !hasEstimates(frame, matches)) return 0;
    std::size_t fragmentations = 0;
    std::vector<bool> matched(matched_.size(), false);
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      if (frame.truth[i].ignored || matches.estimate_of[i] == FrameMatches::kNone) continue;
      const auto track = static_cast<std::size_t>(frame.truth[i].track);
      if (!matched_[track] && ever_matched_[track]) ++fragmentations;
      ever_matched_[track] = true;
      matched[track] = true;
    }
    matched_ = std::move(matched);
    return fragmentations;
  }

 private:
  static bool hasTruth(const ClassFrame& frame) {
    return std::any_of(frame.truth.begin(), frame.truth.end(),
                       [](const TrueBox& truth) { return !truth.ignored; });
  }

  static bool hasEstimates(const ClassFrame& frame, const FrameMatches& matches) {
    for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
      const int i = matches.truth_of[j];
      if (i == FrameMatches::kExcluded) continue;
      const bool is_ignored = i == FrameMatches::kNone
                                  ? frame.estimates[j].ignored_if_unmatched
                                  : frame.truth[static_cast<std::size_t>(i)].ignored;
      if (!is_ignored) return true;
    }
    return false;
  }

  std::vector<bool> matched_;  ///< in the latest frame that was not passed over
  std::vector<bool> ever_matched_;
};

void countFrame(const ClassFrame& frame, const FrameMatches& matches, LatestTracks& latest_tracks,
                ClearCounts& counts) {
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const int j = matches.estimate_of[i];
    const bool matched = j != FrameMatches::kNone;
    const int track = matched ? frame.estimates[static_cast<std::size_t>(j)].track : j;
    countTruth(frame.truth[i], track, latest_tracks[static_cast<std::size_t>(frame.truth[i].track)],
               counts);
    if (!matched || frame.truth[i].ignored) continue;
    ++counts.tp;
    counts.true_scores.push_back(frame.estimates[static_cast<std::size_t>(j)].score);
  }
  for (const auto& pair : frame.overlaps) {
    const bool is_match = matches.estimate_of[pair.row] == static_cast<int>(pair.column);
    if (is_match && !frame.truth[pair.row].ignored) counts.overlap_sum += 1.0 - pair.cost;
  }
  for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
    if (matches.truth_of[j] == FrameMatches::kNone && !frame.estimates[j].ignored_if_unmatched)
      ++counts.fp;
  }
}

/// Score threshold at which the given ratio of the truth is matched; nullopt if it cannot be.
std::optional<double> thresholdFor(double recall, std::size_t truth,
                                   const std::vector<double>& descending_scores) {
  const auto needed =
      static_cast<std::size_t>(std::ceil(recall * static_cast<double>(truth) - 1e-9));
  if (needed > descending_scores.size()) return std::nullopt;
  return descending_scores[std::max<std::size_t>(needed, 1) - 1];
}

double scaledMota(const ClearCounts& counts, double recall) {
  const auto truth = static_cast<double>(counts.truth());
  const double avoidable = static_cast<double>(counts.errors()) - (1.0 - recall) * truth;
  return std::clamp(1.0 - avoidable / (recall * truth), 0.0, 1.0);
}

double ClearCounts::mota() const {
  return 1.0 - static_cast<double>(errors()) / static_cast<double>(truth());
}

void ClearCounts::add(const ClearCounts& other) {
  tp += other.tp;
  fp += other.fp;
  fn += other.fn;
  idsw += other.idsw;
  frag += other.frag;
  overlap_sum += other.overlap_sum;
  true_scores.insert(true_scores.end(), other.true_scores.begin(), other.true_scores.end());
}

/// Counts over sequences with the tracks that reach the score threshold.
ClearCounts clearCounts(const std::vector<ClassSequence>& sequences, double min_overlap,
                        double score_threshold) {
  ClearCounts counts;
  for (const auto& sequence : sequences) {
    FrameMatcher matcher(sequence, min_overlap, score_threshold);
    LatestTracks latest_tracks(static_cast<std::size_t>(sequence.true_tracks), FrameMatches::kNone);
    FragmentCounter fragments(sequence);
    for (const auto& frame : sequence.frames) {
      const auto matches = matcher.match(frame);
      countFrame(frame, matches, latest_tracks, counts);
      counts.frag += fragments.count(frame, matches);
    }
  }
  return counts;
}

/// Evaluates without a threshold and at the thresholds that reach the recalls 1/40, 2/40 .. 1.
///
/// @return nullopt if there is no truth
/// @see    Weng et al. 2020, Sec. IV, eqs. 5-8
std::optional<ClearCurve> clearCurve(const std::vector<ClassSequence>& sequences,
                                     double min_overlap) {
  ClearCurve curve;
  curve.best_threshold = -std::numeric_limits<double>::infinity();
  curve.best = clearCounts(sequences, min_overlap, curve.best_threshold);
  const std::size_t truth = curve.best.truth();
  if (truth == 0) return std::nullopt;
  auto scores = curve.best.true_scores;
  std::sort(scores.begin(), scores.end(), std::greater<>());
  for (int k = 1; k <= kRecalls; ++k) {
    const double recall = static_cast<double>(k) / kRecalls;
    const auto threshold = thresholdFor(recall, truth, scores);
    if (!threshold) break;
    auto counts = clearCounts(sequences, min_overlap, *threshold);
    const RecallPoint point{recall, *threshold, counts.mota(), scaledMota(counts, recall)};
    curve.points.push_back(point);
    curve.amota += point.mota / kRecalls;
    curve.samota += point.smota / kRecalls;
    if (point.mota > curve.best.mota()) {
      curve.best = std::move(counts);
      curve.best_threshold = *threshold;
    }
  }
  return curve;
}

constexpr double kOverlapWeight = 1e-4;  // breaks ties between equal associations only

struct OverlappingPair {
  std::size_t row = 0;
  std::size_t column = 0;
  double overlap = 0.0;
};

/// A frame without ignored boxes.
struct CountedFrame {
  std::vector<int> truth;      ///< track of each row; -1 excluded
  std::vector<int> estimates;  ///< track of each column; -1 excluded
  std::vector<OverlappingPair> pairs;
};

CountedFrame withoutIgnored(const ClassFrame& frame, const FrameMatches& matches) {
  CountedFrame result;
  for (const auto& truth : frame.truth) result.truth.push_back(truth.ignored ? -1 : truth.track);
  for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
    const int row = matches.truth_of[j];
    const bool matched = row >= 0;
    const bool ignored_if_unmatched =
        row == FrameMatches::kNone && frame.estimates[j].ignored_if_unmatched;
    const bool with_ignored = matched && frame.truth[static_cast<std::size_t>(row)].ignored;
    const bool excluded = row == FrameMatches::kExcluded || ignored_if_unmatched || with_ignored;
    result.estimates.push_back(excluded ? -1 : frame.estimates[j].track);
  }
  for (const auto& pair : frame.overlaps) {
    if (result.truth[pair.row] < 0 || result.estimates[pair.column] < 0) continue;
    result.pairs.push_back({pair.row, pair.column, 1.0 - pair.cost});
  }
  return result;
}

/// Frames in which each track appears.
Eigen::VectorXd appearances(const std::vector<CountedFrame>& frames,
                            std::vector<int> CountedFrame::*which, int tracks) {
  Eigen::VectorXd count = Eigen::VectorXd::Zero(tracks);
  for (const auto& frame : frames) {
    for (const int track : frame.*which) {
      if (track >= 0) count[track] += 1.0;
    }
  }
  return count;
}

/// Association scores between the true and estimated tracks of one sequence.
class Association {
 public:
  Association(const std::vector<CountedFrame>& frames, const ClassSequence& sequence)
      : frames_(frames),
        truth_frames_(appearances(frames, &CountedFrame::truth, sequence.true_tracks)),
        estimate_frames_(appearances(frames, &CountedFrame::estimates, sequence.estimated_tracks)) {
  }

  [[nodiscard]] HotaCounts::Level countsAt(double level) const {
    const Eigen::MatrixXd potential = agreement(togetherAt(level));
    Eigen::MatrixXd together = noPairs();
    HotaCounts::Level counts;
    for (const auto& frame : frames_) {
      std::vector<CandidatePair> candidates;
      for (const auto& pair : frame.pairs) {
        if (pair.overlap < level - 1e-9) continue;
        const auto [i, j] = tracksOf(frame, pair);
        candidates.push_back(
            {pair.row, pair.column, -potential(i, j) - kOverlapWeight * pair.overlap});
      }
      for (const auto& pair : assignPairs(std::move(candidates))) {
        const auto [i, j] = tracksOf(frame, pair);
        together(i, j) += 1.0;
        ++counts.tp;
      }
    }
    counts.fn = static_cast<std::size_t>(std::lround(truth_frames_.sum())) - counts.tp;
    counts.fp = static_cast<std::size_t>(std::lround(estimate_frames_.sum())) - counts.tp;
    counts.association_sum = together.cwiseProduct(agreement(together)).sum();
    return counts;
  }

 private:
  [[nodiscard]] Eigen::MatrixXd noPairs() const {
    return Eigen::MatrixXd::Zero(truth_frames_.size(), estimate_frames_.size());
  }

  template <typename Pair>
  static std::pair<int, int> tracksOf(const CountedFrame& frame, const Pair& pair) {
    return {frame.truth[pair.row], frame.estimates[pair.column]};
  }

  /// Frames in which each pair of tracks overlaps at least this much.
  [[nodiscard]] Eigen::MatrixXd togetherAt(double level) const {
    Eigen::MatrixXd together = noPairs();
    for (const auto& frame : frames_) {
      for (const auto& pair : frame.pairs) {
        const auto [i, j] = tracksOf(frame, pair);
        if (pair.overlap >= level - 1e-9) together(i, j) += 1.0;
      }
    }
    return together;
  }

  /// Frames together over frames of either, for each pair of tracks (0..1).
  [[nodiscard]] Eigen::MatrixXd agreement(const Eigen::MatrixXd& together) const {
    Eigen::MatrixXd result = noPairs();
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
      for (Eigen::Index j = 0; j < result.cols(); ++j) {
        if (!(together(i, j) > 0.0)) continue;
        result(i, j) = together(i, j) / (truth_frames_[i] + estimate_frames_[j] - together(i, j));
      }
    }
    return result;
  }

  const std::vector<CountedFrame>& frames_;
  Eigen::VectorXd truth_frames_;
  Eigen::VectorXd estimate_frames_;
};

void HotaCounts::add(const HotaCounts& other) {
  for (std::size_t k = 0; k < kLevels; ++k) {
    levels[k].tp += other.levels[k].tp;
    levels[k].fp += other.levels[k].fp;
    levels[k].fn += other.levels[k].fn;
    levels[k].association_sum += other.levels[k].association_sum;
  }
}

/// Counts over one sequence with the tracks that reach the score threshold.
///
/// Ignored truth, estimates that CLEAR MOT matches with it, and unmatched estimates that are not
/// false positives are excluded.
///
/// @see Luiten et al. 2021, Sec. 5 and Sec. 6 (matching: maximum number, then association, then
///      overlap)
HotaCounts hotaCounts(const ClassSequence& sequence, double min_overlap, double score_threshold) {
  FrameMatcher matcher(sequence, min_overlap, score_threshold);
  std::vector<CountedFrame> frames;
  for (const auto& frame : sequence.frames) {
    frames.push_back(withoutIgnored(frame, matcher.match(frame)));
  }
  const Association association(frames, sequence);
  HotaCounts counts;
  for (std::size_t k = 0; k < HotaCounts::kLevels; ++k) {
    counts.levels[k] = association.countsAt(0.05 * static_cast<double>(k + 1));
  }
  return counts;
}

/// @see Luiten et al. 2021, eqs. 14-16 and 27
Hota hotaOf(const HotaCounts& counts) {
  Hota result;
  for (const auto& level : counts.levels) {
    if (level.tp == 0) continue;
    const double det =
        static_cast<double>(level.tp) / static_cast<double>(level.tp + level.fp + level.fn);
    const double ass = level.association_sum / static_cast<double>(level.tp);
    result.deta += det / HotaCounts::kLevels;
    result.assa += ass / HotaCounts::kLevels;
    result.hota += std::sqrt(det * ass) / HotaCounts::kLevels;
  }
  return result;
}

/// Correct and wrong positions, whatever the score.
struct PositionCounts {
  std::size_t tp = 0, fp = 0, fn = 0;
  std::size_t measured = 0;     ///< true positives with a known distance
  double squared_sum_m2 = 0.0;  ///< of their distances on the ground

  void add(const PositionCounts& other) {
    tp += other.tp;
    fp += other.fp;
    fn += other.fn;
    measured += other.measured;
    squared_sum_m2 += other.squared_sum_m2;
  }
};

std::optional<double> errorOf(const ClassFrame& frame, const CandidatePair& pair) {
  for (std::size_t k = 0; k < frame.positions.size(); ++k) {
    const auto& candidate = frame.positions[k];
    if (candidate.row == pair.row && candidate.column == pair.column) {
      return frame.position_errors_m[k];
    }
  }
  return std::nullopt;
}

/// Pairs estimates with truth by position, frame by frame.
PositionCounts positionCounts(const ClassSequence& sequence) {
  PositionCounts counts;
  for (const auto& frame : sequence.frames) {
    std::vector<bool> paired(frame.estimates.size(), false);
    std::size_t found = 0;
    for (const auto& pair : assignPairs(frame.positions)) {
      paired[pair.column] = true;
      if (frame.truth[pair.row].ignored) continue;
      ++found;
      const auto error = errorOf(frame, pair);
      if (!error) continue;
      ++counts.measured;
      counts.squared_sum_m2 += *error * *error;
    }
    counts.tp += found;
    counts.fn += static_cast<std::size_t>(std::count_if(frame.truth.begin(), frame.truth.end(),
                                                        [](const auto& t) { return !t.ignored; })) -
                 found;
    for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
      if (!paired[j] && !frame.estimates[j].ignored_if_unmatched) ++counts.fp;
    }
  }
  return counts;
}

/// All counts of one class, or of several classes together.
struct ClassCounts {
  PositionCounts positions;
  ClearCounts clear;
  HotaCounts hota;

  void add(const ClassCounts& other) {
    positions.add(other.positions);
    clear.add(other.clear);
    hota.add(other.hota);
  }
};

void fillPositions(const PositionCounts& counts, TrackError& result) {
  result.precision = ratioOf(counts.tp, counts.tp + counts.fp);
  result.recall = ratioOf(counts.tp, counts.tp + counts.fn);
  result.f1 = ratioOf(2 * counts.tp, 2 * counts.tp + counts.fp + counts.fn);
  if (counts.measured > 0) {
    result.rmse_m = std::sqrt(counts.squared_sum_m2 / static_cast<double>(counts.measured));
  }
}

TrackError figuresOf(const ClassCounts& counts) {
  TrackError result;
  fillPositions(counts.positions, result);
  const auto& clear = counts.clear;
  result.truth_boxes = clear.truth();
  result.tp = clear.tp;
  result.fp = clear.fp;
  result.fn = clear.fn;
  result.idsw = clear.idsw;
  result.frag = clear.frag;
  if (clear.tp > 0) result.motp = clear.overlap_sum / static_cast<double>(clear.tp);
  if (clear.truth() == 0) return result;
  result.mota = clear.mota();
  const auto hota = hotaOf(counts.hota);
  result.hota = hota.hota;
  result.deta = hota.deta;
  result.assa = hota.assa;
  return result;
}

/// Evaluates one class and adds its counts to `all`.
TrackError classError(const std::vector<LabelledSequence>& sequences, ObjectClass object_class,
                      const TrackErrorParams& params, ClassCounts& all) {
  std::vector<ClassSequence> prepared;
  for (const auto& sequence : sequences) {
    prepared.push_back(classSequence(sequence, object_class, params));
  }
  ClassCounts counts;
  for (const auto& sequence : prepared) counts.positions.add(positionCounts(sequence));
  if (params.positions_only) {
    all.add(counts);
    return figuresOf(counts);
  }
  const auto curve = clearCurve(prepared, params.min_overlap);
  const double threshold = curve ? curve->best_threshold : -std::numeric_limits<double>::infinity();
  counts.clear = curve ? curve->best : clearCounts(prepared, params.min_overlap, threshold);
  for (const auto& sequence : prepared) {
    counts.hota.add(hotaCounts(sequence, params.min_overlap, threshold));
  }
  all.add(counts);
  auto result = figuresOf(counts);
  if (!curve) return result;
  if (std::isfinite(threshold)) result.score_threshold = threshold;
  result.samota = curve->samota;
  result.amota = curve->amota;
  result.curve = curve->points;
  return result;
}

/// Mean over the classes with a value.
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
  ClassCounts all;
  for (const auto object_class : params.classes) {
    result.classes[object_class] = classError(sequences, object_class, params, all);
  }
  result.all = figuresOf(all);
  result.all.samota = meanOf(result.classes, &TrackError::samota);
  result.all.amota = meanOf(result.classes, &TrackError::amota);
  return result;
}

}  // namespace headway::eval
