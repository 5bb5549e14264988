// SPDX-License-Identifier: BSD-3-Clause
// Errors as JSON and as tables.
#pragma once

#include <headway/plot/text_table.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace headway::eval {

struct LabelledObjectError;
struct MovingObjectError;
struct ObjectMotionErrors;
struct PredictionErrors;
struct TrackErrors;
struct TrajectoryError;

/// Ratio of a part; nullopt of an empty whole.
[[nodiscard]] std::optional<double> ratioOf(std::size_t part, std::size_t whole);
/// A figure as JSON, null if it is undefined.
[[nodiscard]] nlohmann::ordered_json orNull(const std::optional<double>& value);

// The errors as JSON under the keys of doc/formats.md; undefined figures are null.
[[nodiscard]] nlohmann::ordered_json toJson(const TrajectoryError& error);
[[nodiscard]] nlohmann::ordered_json toJson(const TrackErrors& errors);
[[nodiscard]] nlohmann::ordered_json toJson(const PredictionErrors& errors);
[[nodiscard]] nlohmann::ordered_json toJson(const MovingObjectError& error);
[[nodiscard]] nlohmann::ordered_json toJson(const LabelledObjectError& error);
[[nodiscard]] nlohmann::ordered_json toJson(const ObjectMotionErrors& errors);

/// One row per figure: name, value, unit.
[[nodiscard]] plot::TextTable tableOf(const TrajectoryError& error);
/// One row per class and one for all classes; ratios in percent.
[[nodiscard]] plot::TextTable tableOf(const PredictionErrors& errors);
[[nodiscard]] plot::TextTable tableOf(const TrackErrors& errors);

/// One row for all labels, and one per class, range and occlusion.
[[nodiscard]] plot::TextTable tableOf(const MovingObjectError& error);
/// One row for all labels within the range and occlusion, and one per class.
[[nodiscard]] plot::TextTable tableOf(const LabelledObjectError& error);
/// One row per object, and one for their means.
[[nodiscard]] plot::TextTable tableOf(const ObjectMotionErrors& errors);

/// Position errors of raw detections and of the tracks estimated from them, one row per class.
[[nodiscard]] plot::TextTable positionTable(const TrackErrors& raw, const TrackErrors& tracks);

}  // namespace headway::eval
