// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/track_error.h>

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval_files {

/// Files of truth and tracks, or folders whose files are paired by name.
struct TrackFiles {
  std::string truth;     ///< KITTI tracking labels, or the objects.csv of a simulation
  std::string estimate;  ///< KITTI tracking results, or a tracks.csv
  std::string raw;       ///< detections whose positions are evaluated too; empty: none
};

/// Errors of tracks, with what they were computed from.
struct TrackEvaluation {
  eval::TrackErrorParams params;
  std::vector<eval::LabelledSequence> sequences;
  std::vector<eval::LabelledSequence> raw_sequences;  ///< the detections as estimates
  std::vector<std::string> truth_alone;               ///< recordings without an estimate
  std::map<std::string, std::size_t> dropped;         ///< rows of the estimate, by reason
  eval::TrackErrors tracks;
  std::optional<eval::TrackErrors> raw;  ///< positions of the detections
};

/// Evaluates tracks as `headway-eval tracks` does.
///
/// @throws InputError naming the file that cannot be read, or has no boxes of the metric
[[nodiscard]] TrackEvaluation evaluateTracks(const TrackFiles& files,
                                             const eval::TrackErrorParams& params);

/// The figures of `headway-eval tracks --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const TrackEvaluation& evaluation);

}  // namespace headway::eval_files
