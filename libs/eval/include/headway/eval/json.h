#pragma once

#include <nlohmann/json_fwd.hpp>

namespace headway::eval {

struct PredictionErrors;
struct TrackErrors;
struct TrajectoryError;

/// The figures under the keys that scripts rely on; null where a figure is not defined.
[[nodiscard]] nlohmann::ordered_json toJson(const TrajectoryError& error);
[[nodiscard]] nlohmann::ordered_json toJson(const TrackErrors& errors);
[[nodiscard]] nlohmann::ordered_json toJson(const PredictionErrors& errors);

}  // namespace headway::eval
