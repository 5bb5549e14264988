// SPDX-License-Identifier: BSD-3-Clause
// Tables as text.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace headway::plot {

/// Rows of cells; the first row contains the column headings.
using TextTable = std::vector<std::vector<std::string>>;

/// Writes the table as Markdown with aligned columns: the first left-aligned, the others
/// right-aligned. Cells missing at the end of a row are written as an em dash.
void writeTable(std::ostream& out, const TextTable& table);

/// The number with fixed decimals; an em dash if there is no value or it is not finite.
[[nodiscard]] std::string fixedText(std::optional<double> value, int decimals);

/// A ratio in percent, without the unit; an em dash if there is no value.
[[nodiscard]] std::string percentText(std::optional<double> ratio, int decimals);

}  // namespace headway::plot
