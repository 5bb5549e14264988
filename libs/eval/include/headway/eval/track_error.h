#pragma once

#include <headway/eval/labelled_frames.h>

#include <map>
#include <optional>
#include <vector>

namespace headway::eval {

enum class BoxMetric {
  k2d,  ///< overlap of image boxes
  k3d,  ///< overlap of the volumes of turned boxes
};

struct TrackErrorParams {
  BoxMetric metric = BoxMetric::k3d;
  double min_overlap = 0.25;     ///< intersection over union that makes a match
  double max_distance_m = 2.0;   ///< on the ground: what makes a position right (k3d)
  int max_occlusion = 2;         ///< truth more occluded is ignored
  double max_truncation = 0.0;   ///< truth more truncated is ignored
  double min_height_px = 25.0;   ///< unmatched estimates not higher in the image are ignored
  double dont_care_share = 0.5;  ///< and those with more of their area in a DontCare region
  std::vector<ObjectClass> classes = {ObjectClass::kCar, ObjectClass::kPedestrian,
                                      ObjectClass::kCyclist};
  bool positions_only = false;  ///< leave out what needs tracks: raw detections have none
};

/// Accuracy over tracks chosen so that a share of the truth is found.
struct RecallPoint {
  double recall = 0.0;           ///< asked for: 1/40, 2/40 .. 1
  double score_threshold = 0.0;  ///< tracks scoring less are left out
  double mota = 0.0;
  double smota = 0.0;  ///< scaled: 1 is the best that this recall allows; 0..1
};

/// How good tracks of one class are. Figures without a truth (or an estimate) to rest on are none.
///
/// Positions: every estimate counts, whatever its score, and is right if paired (one to one, most
/// pairs, then least distance) with truth within `max_distance_m` on the ground; with k2d, if it
/// overlaps it enough.
/// Tracks: estimates of tracks whose mean score reaches `score_threshold`, the one of best MOTA.
struct TrackError {
  std::size_t truth_boxes = 0;                  ///< that are not ignored
  std::optional<double> rmse_m;                 ///< of paired positions on the ground [m]
  std::optional<double> precision, recall, f1;  ///< 0..1

  std::optional<double> score_threshold;
  std::size_t tp = 0, fp = 0, fn = 0;
  std::size_t idsw = 0;  ///< identity switches: truth found by another track than the last time
  std::size_t frag = 0;  ///< fragmentations: truth found again after it was lost
  std::optional<double> mota;              ///< 1 - (fn + fp + idsw) / truth_boxes
  std::optional<double> motp;              ///< mean overlap of what was found, 0..1
  std::optional<double> hota, deta, assa;  ///< 0..1, mean over overlaps 0.05 .. 0.95
  std::optional<double> samota, amota;     ///< means over 40 recalls; 0 where one is not reached
  std::vector<RecallPoint> curve;          ///< the recalls that are reached
};

struct TrackErrors {
  std::map<ObjectClass, TrackError> classes;
  TrackError all;  ///< counts of all classes together; samota and amota are means over classes
};

/// Judges tracks against labels as the KITTI benchmark does.
///
/// Van is a neighbour of Car, and Person_sitting of Pedestrian: estimates matched with a
/// neighbour, or with truth that is ignored, are neither right nor wrong. Where truth is ignored,
/// its history of identities starts anew.
///
/// @see Bernardin & Stiefelhagen 2008, "Evaluating multiple object tracking performance: the CLEAR
///      MOT metrics", Sec. 2.1 (matches of the last frame are kept where they still hold, the rest
///      is assigned at the least cost); Milan et al. 2016, "MOT16", Sec. 4.1.4 (fragmentations);
///      Weng et al. 2020, "3D multi-object tracking: a baseline and new evaluation metrics",
///      Sec. IV (sAMOTA, AMOTA over 40 recalls, scores averaged over tracks); Luiten et al. 2021,
///      "HOTA: a higher order metric", Secs. 5-6; Geiger et al. 2012 (what is ignored)
[[nodiscard]] TrackErrors trackErrors(const std::vector<LabelledSequence>& sequences,
                                      const TrackErrorParams& params);

}  // namespace headway::eval
