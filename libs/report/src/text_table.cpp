#include "text_table.h"

#include <headway/core/error.h>

#include <charconv>
#include <fstream>
#include <sstream>

namespace headway::report {
namespace {

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

std::ifstream opened(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string() + ": cannot be read");
  return file;
}

}  // namespace

TextTable::TextTable(const std::filesystem::path& path) : name_(path.string()) {
  std::ifstream file = opened(path);
  std::string line;
  std::getline(file, line);
  for (const auto& name : fieldsOf(line)) columns_.emplace(name, columns_.size());
  std::size_t number = 1;
  while (std::getline(file, line)) {
    ++number;
    auto fields = fieldsOf(line);
    if (fields.empty()) continue;
    if (fields.size() != columns_.size()) {
      throw InputError(name_ + ":" + std::to_string(number) + ": has " +
                       std::to_string(fields.size()) + " fields, its header " +
                       std::to_string(columns_.size()));
    }
    rows_.push_back(std::move(fields));
  }
}

const std::string& TextTable::text(std::size_t row, const std::string& column) const {
  const auto found = columns_.find(column);
  if (found == columns_.end()) throw InputError(name_ + ": has no column '" + column + "'");
  return rows_[row][found->second];
}

double TextTable::number(std::size_t row, const std::string& column) const {
  const std::string& field = text(row, column);
  double value = 0.0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) {
    throw InputError(name_ + ": column '" + column + "' holds '" + field + "', not a number");
  }
  return value;
}

std::vector<TimedPlace> readPath(const std::filesystem::path& path) {
  std::ifstream file = opened(path);
  std::vector<TimedPlace> places;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream row(line);
    TimedPlace place;
    if (!(row >> place.time >> place.x >> place.y)) {
      throw InputError(path.string() + ": '" + line + "' is not a pose");
    }
    places.push_back(place);
  }
  return places;
}

}  // namespace headway::report
