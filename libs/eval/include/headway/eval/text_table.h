#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

struct PredictionErrors;
struct TrackErrors;
struct TrajectoryError;

/// Rows of text, the first being the headings.
using TextTable = std::vector<std::vector<std::string>>;

/// Writes the table as Markdown with aligned columns: the first to the left, others to the right;
/// a dash stands where a row is shorter than the headings.
void writeTable(std::ostream& out, const TextTable& table);

/// The number with fixed decimals; an em dash if there is none or it is not finite.
[[nodiscard]] std::string fixedText(std::optional<double> value, int decimals);

/// The figures of a trajectory, named and with units.
[[nodiscard]] TextTable tableOf(const TrajectoryError& error);

/// One row a class, shares in percent.
[[nodiscard]] TextTable tableOf(const PredictionErrors& errors);
[[nodiscard]] TextTable tableOf(const TrackErrors& errors);

/// Positions of raw detections and of the tracks made from them, one row a class.
[[nodiscard]] TextTable positionTable(const TrackErrors& raw, const TrackErrors& tracks);

}  // namespace headway::eval
