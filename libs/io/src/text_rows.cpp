#include "text_rows.h"

#include <headway/core/error.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

namespace headway::io {
namespace {

constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";  // written by spreadsheet programs

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string trimmed(const std::string& text) {
  std::size_t first = 0;
  std::size_t last = text.size();
  while (first < last && isBlank(text[first])) ++first;
  while (last > first && isBlank(text[last - 1])) --last;
  return text.substr(first, last - first);
}

std::vector<std::string> splitAtCommas(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t start = 0;
  for (std::size_t comma = line.find(','); comma != std::string::npos;
       comma = line.find(',', start)) {
    fields.push_back(trimmed(line.substr(start, comma - start)));
    start = comma + 1;
  }
  fields.push_back(trimmed(line.substr(start)));
  return fields;
}

std::vector<std::string> splitAtBlanks(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && isBlank(line[at])) ++at;
    const std::size_t start = at;
    while (at < line.size() && !isBlank(line[at])) ++at;
    if (at > start) fields.push_back(line.substr(start, at - start));
  }
  return fields;
}

std::vector<std::string> namesIn(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream stream(list);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

}  // namespace

TextRows::TextRows(const std::string& path) : path_(path), file_(path) {
  if (std::filesystem::is_directory(path)) throw InputError(path + ": is a folder, not a file");
  if (!file_) throw InputError(path + ": cannot be opened for reading; does it exist?");
}

bool TextRows::next() {
  std::string line;
  while (std::getline(file_, line)) {
    if (line_ == 0 && line.rfind(kByteOrderMark, 0) == 0) line.erase(0, sizeof(kByteOrderMark) - 1);
    ++line_;
    const std::string content = trimmed(line.substr(0, line.find('#')));
    if (content.empty()) continue;
    is_comma_separated_ = content.find(',') != std::string::npos;
    fields_ = is_comma_separated_ ? splitAtCommas(content) : splitAtBlanks(content);
    return true;
  }
  if (file_.bad()) fail("read error");
  return false;
}

double TextRows::number(std::size_t column) const {
  if (column >= fields_.size()) {
    fail("has " + std::to_string(fields_.size()) + " fields, field " + std::to_string(column + 1) +
         " is missing");
  }
  const auto value = parseNumber(fields_[column]);
  if (!value) {
    fail("'" + fields_[column] + "' in field " + std::to_string(column + 1) + " is not a number");
  }
  return *value;
}

std::int64_t TextRows::integer(std::size_t column) const {
  const double value = number(column);
  if (!(std::abs(value) < 9e15) || value != std::floor(value)) {
    fail("'" + fields_[column] + "' in field " + std::to_string(column + 1) + " is not an integer");
  }
  return static_cast<std::int64_t>(value);
}

std::size_t TextRows::index(std::size_t column) const {
  const auto value = integer(column);
  if (value < 0) fail("'" + fields_[column] + "' is not an index: negative");
  return static_cast<std::size_t>(value);
}

void TextRows::requireSize(std::size_t size, const std::string& meaning) const {
  if (fields_.size() == size) return;
  fail("has " + std::to_string(fields_.size()) + " fields, " + meaning + " has " +
       std::to_string(size));
}

void TextRows::fail(const std::string& reason) const {
  throw InputError(path_ + ":" + std::to_string(line_) + ": " + reason);
}

std::optional<double> parseNumber(const std::string& text) {
  const char* first = text.data();
  const char* last = first + text.size();
  if (first != last && *first == '+') ++first;
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, last, value);
  if (first == last || end != last) return std::nullopt;
  if (error == std::errc::result_out_of_range) return 0.0;  // underflow, e.g. 1e-400
  if (error != std::errc()) return std::nullopt;
  return value;
}

CsvColumns::CsvColumns(const TextRows& header, const std::string& required) : size_(header.size()) {
  for (std::size_t i = 0; i < header.size(); ++i) positions_.emplace(header.fields()[i], i);
  for (const auto& name : namesIn(required)) {
    if (positions_.count(name) == 0) {
      header.fail("column '" + name + "' is missing; required columns: " + required);
    }
  }
}

std::optional<std::size_t> CsvColumns::find(const std::string& name) const {
  const auto position = positions_.find(name);
  if (position == positions_.end()) return std::nullopt;
  return position->second;
}

std::optional<std::string> CsvColumns::unknownTo(const std::string& known) const {
  const auto names = namesIn(known);
  const std::set<std::string> known_names(names.begin(), names.end());
  for (const auto& [name, position] : positions_) {
    if (known_names.count(name) == 0) return name;
  }
  return std::nullopt;
}

void CsvColumns::requireComplete(const TextRows& row) const {
  row.requireSize(size_, "the header");
}

}  // namespace headway::io
