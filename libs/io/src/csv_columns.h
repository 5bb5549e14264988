#pragma once

#include <map>
#include <optional>
#include <string>

#include "text_rows.h"

namespace headway::io {

/// Where the named columns of a CSV file are: its header line decides, in any order.
class CsvColumns {
 public:
  /// @param header    the header row, as read
  /// @param required  comma-separated names that must be there; others may be
  /// @throws InputError naming the first column that is missing
  CsvColumns(const TextRows& header, const std::string& required);

  /// Position of a required column.
  [[nodiscard]] std::size_t at(const std::string& name) const { return positions_.at(name); }
  /// Position of a column that may be there.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  /// Name of the first column that is not in this comma-separated list; nullopt if all are.
  [[nodiscard]] std::optional<std::string> unknownTo(const std::string& known) const;
  /// @throws InputError if the row has another number of fields than the header
  void requireComplete(const TextRows& row) const;

 private:
  std::map<std::string, std::size_t> positions_;
  std::size_t size_;
};

}  // namespace headway::io
