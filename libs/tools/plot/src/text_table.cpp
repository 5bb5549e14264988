// SPDX-License-Identifier: BSD-3-Clause
// Tables as text.
#include <headway/core/text.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace headway::plot {
namespace {

/// Number of code points of UTF-8 text: its width on a terminal.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

std::vector<std::size_t> columnWidths(const TextTable& table) {
  std::vector<std::size_t> widths;
  for (const auto& row : table) {
    widths.resize(std::max(widths.size(), row.size()), 3);
    for (std::size_t i = 0; i < row.size(); ++i)
      widths[i] = std::max(widths[i], widthOf(printable(row[i])));
  }
  return widths;
}

void writeRow(std::ostream& out, const std::vector<std::string>& row,
              const std::vector<std::size_t>& widths) {
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const std::string cell = i < row.size() ? printable(row[i]) : "—";
    const std::string blank(widths[i] - widthOf(cell), ' ');
    out << "| " << (i == 0 ? cell + blank : blank + cell) << " ";
  }
  out << "|\n";
}

}  // namespace

void writeTable(std::ostream& out, const TextTable& table) {
  const auto widths = columnWidths(table);
  for (std::size_t r = 0; r < table.size(); ++r) {
    writeRow(out, table[r], widths);
    if (r > 0) continue;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      out << "| " << std::string(widths[i] - 1, '-') << (i == 0 ? "- " : ": ");
    }
    out << "|\n";
  }
}

std::string fixedText(std::optional<double> value, int decimals) {
  if (!value || !std::isfinite(*value)) return "—";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, *value);
  return text.data();
}

std::string percentText(std::optional<double> ratio, int decimals) {
  if (ratio) ratio = 100.0 * *ratio;
  return fixedText(ratio, decimals);
}

}  // namespace headway::plot
