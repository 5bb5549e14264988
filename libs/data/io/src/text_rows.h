// SPDX-License-Identifier: BSD-3-Clause
// Rows of text files: fields separated by blanks or commas.
#pragma once

#include <headway/core/text.h>

#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway::io {

/// Reads a text file row by row: fields separated by blanks or commas, without '#' comments and
/// empty lines. A field between two commas may be empty.
///
///     TextRows rows(path);
///     while (rows.next()) x = rows.number(0);
class TextRows {
 public:
  /// @throws InputError if the file cannot be opened
  explicit TextRows(const std::string& path);

  /// Reads the next row; false at the end. @throws InputError on a read error
  bool next();

  [[nodiscard]] std::size_t size() const { return fields_.size(); }
  [[nodiscard]] const std::vector<std::string>& fields() const { return fields_; }
  [[nodiscard]] bool isCommaSeparated() const { return is_comma_separated_; }

  /// @throws InputError naming file, line and column if the field is not a number (NaN is allowed)
  [[nodiscard]] double number(std::size_t column) const;
  /// @throws InputError as number(), and if the number is not an integer
  [[nodiscard]] std::int64_t integer(std::size_t column) const;
  /// A non-negative integer, such as a frame index.
  [[nodiscard]] std::size_t index(std::size_t column) const;
  /// @throws InputError naming file and line unless the row has that many fields
  void requireSize(std::size_t size, const std::string& meaning) const;
  /// @throws InputError "file:line: reason"
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  std::string path_;
  std::ifstream file_;
  std::string text_;  ///< of the line
  std::size_t line_ = 0;
  bool is_comma_separated_ = false;
  std::vector<std::string> fields_;
};

/// The text as a number ("nan" and "inf" included); nullopt if it is not one.
[[nodiscard]] std::optional<double> parseNumber(const std::string& text);

/// Positions of the named columns of a CSV file, in any order.
class CsvColumns {
 public:
  /// @param header    the header row, as read
  /// @param required  comma-separated names of required columns; others are optional
  /// @throws InputError naming the first column that is missing
  CsvColumns(const TextRows& header, const std::string& required);

  /// Position of a required column.
  [[nodiscard]] std::size_t at(const std::string& name) const { return positions_.at(name); }
  /// Position of an optional column.
  [[nodiscard]] std::optional<std::size_t> find(const std::string& name) const;
  /// First column that is not in this comma-separated list; nullopt if all are.
  [[nodiscard]] std::optional<std::string> unknownTo(const std::string& known) const;
  /// @throws InputError unless the row has as many fields as the header
  void requireComplete(const TextRows& row) const;

 private:
  std::map<std::string, std::size_t> positions_;
  std::size_t size_;
};

}  // namespace headway::io
