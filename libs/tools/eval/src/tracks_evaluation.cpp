// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of files of tracks.
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/track_error.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace headway::eval {
namespace {

/// The sequence's truth with raw detections as estimates.
LabelledSequence withRaw(const LabelledSequence& sequence, const std::string& path) {
  LabelledSequence raw{sequence.name, readRaw(sequence.name, path)};
  raw.frames.resize(std::max(raw.frames.size(), sequence.frames.size()));
  for (std::size_t k = 0; k < sequence.frames.size(); ++k) {
    raw.frames[k].truth = sequence.frames[k].truth;
    raw.frames[k].dont_care = sequence.frames[k].dont_care;
  }
  return raw;
}

void readSequences(const TrackFiles& files, TrackEvaluation& evaluation) {
  auto paired = pairedFiles(files.truth, files.estimate);
  evaluation.truth_alone = std::move(paired.truth_alone);
  for (const auto& [name, truth, estimate] : paired.pairs) {
    requireSameFrame(truth, estimate);
    LabelledSequence sequence{name, readLabels(truth)};
    addEstimates(estimate, sequence.frames, evaluation.dropped);
    if (!files.raw.empty()) evaluation.raw_sequences.push_back(withRaw(sequence, files.raw));
    evaluation.sequences.push_back(std::move(sequence));
  }
}

void requireBoxes(const TrackEvaluation& evaluation, const std::string& path) {
  const bool is_2d = evaluation.params.metric == BoxMetric::k2d;
  for (const auto& sequence : evaluation.sequences) {
    for (const auto& frame : sequence.frames) {
      for (const auto& box : frame.estimates) {
        if (is_2d ? box.box2d.has_value() : box.box3d.has_value()) return;
      }
    }
  }
  throw InputError(path + ": contains no " + (is_2d ? "2d" : "3d") +
                   " boxes; is it a tracking result, and is the metric correct?");
}

}  // namespace

TrackEvaluation evaluateTracks(const TrackFiles& files, const TrackErrorParams& params) {
  TrackEvaluation evaluation;
  evaluation.params = params;
  readSequences(files, evaluation);
  requireBoxes(evaluation, files.estimate);
  evaluation.tracks = trackErrors(evaluation.sequences, params);
  if (evaluation.raw_sequences.empty()) return evaluation;
  auto positions = params;
  positions.positions_only = true;
  evaluation.raw = trackErrors(evaluation.raw_sequences, positions);
  return evaluation;
}

nlohmann::ordered_json toJson(const TrackEvaluation& evaluation) {
  auto json = toJson(evaluation.tracks);
  for (const auto& sequence : evaluation.sequences) {
    json["sequences"][sequence.name] = toJson(trackErrors({sequence}, evaluation.params));
  }
  if (evaluation.raw) json["raw"] = toJson(*evaluation.raw);
  json["sequences_without_estimate"] = evaluation.truth_alone;
  json["rows_dropped"] = evaluation.dropped;
  return json;
}

}  // namespace headway::eval
