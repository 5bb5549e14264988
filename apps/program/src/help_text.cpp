// SPDX-License-Identifier: BSD-3-Clause
#include "help_text.h"

#include <sstream>

namespace headway::program {
namespace {

constexpr std::size_t kWidth = 79;
constexpr std::size_t kMeaningColumn = 29;

/// Prints words in lines of at most kWidth characters; the first one starts at `column`, the
/// others are indented.
void printWords(std::ostream& out, const std::string& text, std::size_t column,
                std::size_t indent) {
  std::istringstream words(text);
  bool first_of_line = true;
  for (std::string word; words >> word; first_of_line = false) {
    if (!first_of_line && column + 1 + word.size() > kWidth) {
      out << "\n" << std::string(indent, ' ');
      column = indent;
      first_of_line = true;
    }
    out << (first_of_line ? "" : " ") << word;
    column += word.size() + (first_of_line ? 0 : 1);
  }
  out << "\n";
}

std::string valueOf(const OptionText& option) {
  return option.type.empty() ? "" : " " + option.type;
}

std::string nameOf(const OptionText& option) {
  const std::string short_name =
      option.short_name == 0 ? "    " : std::string("-") + option.short_name + ", ";
  return short_name + "--" + option.long_name + valueOf(option);
}

std::string usageOf(const HelpText& help) {
  std::string usage = "Usage: " + help.program;
  for (const auto& [name, meaning] : help.arguments) usage += " " + name;
  for (const auto& option : help.options) {
    if (!option.required) continue;
    usage +=
        option.short_name == 0 ? " --" + option.long_name : std::string(" -") + option.short_name;
    usage += valueOf(option);
  }
  return usage + " [OPTION]...";
}

}  // namespace

void printRow(std::ostream& out, const std::string& name, const std::string& meaning) {
  out << "  " << name;
  std::size_t column = name.size() + 2;
  if (column + 2 > kMeaningColumn) {
    out << "\n";
    column = 0;
  }
  out << std::string(kMeaningColumn - column, ' ');
  printWords(out, meaning, kMeaningColumn, kMeaningColumn);
}

std::ostream& operator<<(std::ostream& out, const HelpText& help) {
  const std::string usage = usageOf(help);
  printWords(out, usage, 0, 7);
  out << "\n";
  printWords(out, help.summary, 0, 0);
  if (!help.arguments.empty()) out << "\nArguments:\n";
  for (const auto& [name, meaning] : help.arguments) printRow(out, name, meaning);
  out << "\nOptions:\n";
  for (const auto* options : {&help.options, &help.common_options}) {
    for (const auto& option : *options) printRow(out, nameOf(option), option.meaning);
  }
  return out;
}

}  // namespace headway::program
