#include "csv_columns.h"

#include <set>
#include <sstream>

namespace headway::io {
namespace {

std::vector<std::string> namesIn(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream stream(list);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

}  // namespace

CsvColumns::CsvColumns(const TextRows& header, const std::string& required) : size_(header.size()) {
  for (std::size_t i = 0; i < header.size(); ++i) positions_.emplace(header.fields()[i], i);
  for (const auto& name : namesIn(required)) {
    if (positions_.count(name) == 0) {
      header.fail("column '" + name + "' is missing; the header must name " + required);
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
