// SPDX-License-Identifier: BSD-3-Clause
// Accuracy of tracks: CLEAR MOT, HOTA and positions.
#pragma once

#include <headway/eval/labelled_frames.h>

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

enum class BoxMetric {
  k2d,  ///< overlap of image boxes
  k3d,  ///< overlap of the volumes of oriented boxes
};

/// How tracks are matched with labels.
struct TrackErrorParams {
  BoxMetric metric = BoxMetric::k3d;
  double min_overlap = 0.25;     ///< minimum intersection over union of a match
  double max_distance_m = 2.0;   ///< maximum ground distance of a correct position (k3d)
  int max_occlusion = 2;         ///< truth with stronger occlusion is ignored
  double max_truncation = 0.0;   ///< truth with stronger truncation is ignored
  double min_height_px = 25.0;   ///< unmatched estimates up to this image height are ignored
  double dont_care_ratio = 0.5;  ///< and those with a greater area ratio in DontCare regions
  std::vector<ObjectClass> classes = {ObjectClass::kCar, ObjectClass::kPedestrian,
                                      ObjectClass::kCyclist};
  bool positions_only = false;  ///< skip the figures that need track ids, for raw detections
};

/// Accuracy at the score threshold that reaches a given recall.
struct RecallPoint {
  double recall = 0.0;           ///< nominal: 1/40, 2/40 .. 1
  double score_threshold = 0.0;  ///< tracks with a lower score are excluded
  double mota = 0.0;
  double smota = 0.0;  ///< MOTA scaled so that 1 is the maximum at this recall; 0..1
};

/// Tracking accuracy of one class. Figures that are undefined, for lack of truth or estimates, are
/// empty.
///
/// Positions: all estimates count, whatever their score. A position is correct if it is matched
/// (one to one; maximum number of pairs, then minimum distance) with truth within `max_distance_m`
/// on the ground, or for k2d with sufficient overlap.
/// Tracks: only tracks whose mean score reaches `score_threshold`, the threshold of maximum MOTA.
struct TrackError {
  std::size_t truth_boxes = 0;                  ///< true boxes that are not ignored
  std::optional<double> rmse_m;                 ///< of matched positions on the ground [m]
  std::optional<double> precision, recall, f1;  ///< 0..1

  std::optional<double> score_threshold;
  std::size_t tp = 0, fp = 0, fn = 0;
  std::size_t idsw = 0;        ///< identity switches: truth matched with another track than before
  std::size_t frag = 0;        ///< fragmentations: truth matched again after frames without match
  std::optional<double> mota;  ///< 1 - (fn + fp + idsw) / truth_boxes
  std::optional<double> motp;  ///< mean overlap of matches, 0..1
  std::optional<double> hota, deta, assa;  ///< 0..1, mean over overlaps 0.05 .. 0.95
  std::optional<double> samota, amota;     ///< means over 40 recalls; 0 for a recall not reached
  std::vector<RecallPoint> curve;          ///< recalls that are reached
};

/// Errors by class, and of all.
struct TrackErrors {
  std::map<ObjectClass, TrackError> classes;
  TrackError all;  ///< counts summed over classes; samota and amota averaged over classes
};

/// Evaluates tracks against labels as the KITTI benchmark does.
///
/// Van is a neighbouring class of Car, and Person_sitting of Pedestrian: estimates matched with a
/// neighbouring class or with ignored truth count neither as true nor as false positives. The
/// identity history of a true object restarts after frames in which it is ignored. Fragmentations
/// are counted as TrackEval does: frames in which the truth is ignored or not labelled interrupt it
/// too, frames without any truth or without any estimate do not.
///
/// @see Bernardin & Stiefelhagen 2008, "Evaluating multiple object tracking performance: the CLEAR
///      MOT metrics", Sec. 2.1 (matches of the previous frame are kept while valid, the rest is
///      assigned at minimum cost); Luiten & Hoffhues 2020, "TrackEval" (fragmentations);
///      Weng et al. 2020, "3D multi-object tracking: a baseline and new evaluation metrics",
///      Sec. IV (sAMOTA, AMOTA over 40 recalls, scores averaged over tracks); Luiten et al. 2021,
///      "HOTA: a higher order metric", Secs. 5-6; Geiger et al. 2012 (ignored labels)
[[nodiscard]] TrackErrors trackErrors(const std::vector<LabelledSequence>& sequences,
                                      const TrackErrorParams& params);

/// Files of truth and tracks, or folders whose files are paired by name.
struct TrackFiles {
  std::string truth;     ///< KITTI tracking labels, or the objects.csv of a simulation
  std::string estimate;  ///< KITTI tracking results, or a tracks.csv
  std::string raw;       ///< detections whose positions are evaluated too; empty: none
};

/// Errors of tracks, with what they were computed from.
struct TrackEvaluation {
  TrackErrorParams params;
  std::vector<LabelledSequence> sequences;
  std::vector<LabelledSequence> raw_sequences;  ///< the detections as estimates
  std::vector<std::string> truth_alone;         ///< recordings without an estimate
  std::map<std::string, std::size_t> dropped;   ///< rows of the estimate, by reason
  TrackErrors tracks;
  std::optional<TrackErrors> raw;  ///< positions of the detections
};

/// Evaluates tracks as `headway-eval tracks` does.
///
/// @throws InputError naming the file that cannot be read, or has no boxes of the metric
[[nodiscard]] TrackEvaluation evaluateTracks(const TrackFiles& files,
                                             const TrackErrorParams& params);

/// The figures of `headway-eval tracks --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const TrackEvaluation& evaluation);

}  // namespace headway::eval
