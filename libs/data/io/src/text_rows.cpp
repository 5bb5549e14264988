// SPDX-License-Identifier: BSD-3-Clause
// Rows of text files, by hand because messages name file, line and column, and files may be of any
// length.
#include "text_rows.h"

#include <headway/core/error.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>

namespace headway::io {
namespace {

constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";  // written by spreadsheet programs

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// Fields of a row in strings that are used again for the next one.
class FieldWriter {
 public:
  explicit FieldWriter(std::vector<std::string>& fields) : fields_(fields) {}
  ~FieldWriter() { fields_.resize(count_); }
  FieldWriter(const FieldWriter&) = delete;
  FieldWriter& operator=(const FieldWriter&) = delete;
  void add(std::string_view field) {
    if (count_ == fields_.size()) fields_.emplace_back();
    fields_[count_++].assign(field);
  }

 private:
  std::vector<std::string>& fields_;
  std::size_t count_ = 0;
};

void splitAtCommas(std::string_view line, std::vector<std::string>& fields) {
  FieldWriter writer(fields);
  std::size_t start = 0;
  for (std::size_t comma = line.find(','); comma != std::string_view::npos;
       comma = line.find(',', start)) {
    writer.add(trimmed(line.substr(start, comma - start)));
    start = comma + 1;
  }
  writer.add(trimmed(line.substr(start)));
}

void splitAtBlanks(std::string_view line, std::vector<std::string>& fields) {
  FieldWriter writer(fields);
  std::size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() && isBlank(line[at])) ++at;
    const std::size_t start = at;
    while (at < line.size() && !isBlank(line[at])) ++at;
    if (at > start) writer.add(line.substr(start, at - start));
  }
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
  while (std::getline(file_, text_)) {
    std::string_view line = text_;
    if (line_ == 0 && line.rfind(kByteOrderMark, 0) == 0) {
      line.remove_prefix(sizeof(kByteOrderMark) - 1);
    }
    ++line_;
    const std::string_view content = trimmed(line.substr(0, line.find('#')));
    if (content.empty()) continue;
    is_comma_separated_ = content.find(',') != std::string_view::npos;
    if (is_comma_separated_) {
      splitAtCommas(content, fields_);
    } else {
      splitAtBlanks(content, fields_);
    }
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
