#pragma once

#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace headway::io {

/// Reads a text file row by row: words split at blanks or commas, '#' comments and empty lines
/// left out. A field between two commas may be empty.
///
///     TextRows rows(path);
///     while (rows.next()) x = rows.number(0);
class TextRows {
 public:
  /// @throws InputError if the file cannot be opened
  explicit TextRows(const std::string& path);

  /// Goes on to the next row; false at the end. @throws InputError if the file breaks off
  bool next();

  [[nodiscard]] std::size_t size() const { return fields_.size(); }
  [[nodiscard]] const std::vector<std::string>& fields() const { return fields_; }
  [[nodiscard]] bool isCommaSeparated() const { return is_comma_separated_; }

  /// @throws InputError naming file, line and column if the field is not a number (NaN is one)
  [[nodiscard]] double number(std::size_t column) const;
  /// @throws InputError likewise; also if the number is not a whole one
  [[nodiscard]] std::int64_t integer(std::size_t column) const;
  /// A whole number that is not negative, such as a frame index.
  [[nodiscard]] std::size_t index(std::size_t column) const;
  /// @throws InputError naming file and line unless the row has that many fields
  void requireSize(std::size_t size, const std::string& meaning) const;
  /// @throws InputError "file:line: reason"
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  std::string path_;
  std::ifstream file_;
  std::size_t line_ = 0;
  bool is_comma_separated_ = false;
  std::vector<std::string> fields_;
};

/// The text as a number ("nan" and "inf" are numbers); nullopt if it is none.
[[nodiscard]] std::optional<double> parseNumber(const std::string& text);

/// printf-like, for numbers: independent of the locale of streams.
[[nodiscard]] std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// Opens a text file for writing. @throws InputError if it cannot be written
[[nodiscard]] std::ofstream openForWriting(const std::string& path);
/// Flushes and closes. @throws InputError if something could not be written (a full disk)
void closeWritten(std::ofstream& file, const std::string& path);

}  // namespace headway::io
