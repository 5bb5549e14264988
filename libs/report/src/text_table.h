#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace headway::report {

/// A CSV file with a header line, by the names of its columns.
class TextTable {
 public:
  /// @throws InputError if the file cannot be read, or a row has not as many fields as the header
  explicit TextTable(const std::filesystem::path& path);

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// @throws InputError if there is no such column
  [[nodiscard]] const std::string& text(std::size_t row, const std::string& column) const;
  /// @throws InputError if the field is not a number
  [[nodiscard]] double number(std::size_t row, const std::string& column) const;

 private:
  std::string name_;
  std::map<std::string, std::size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// One row of a `t x y z qx qy qz qw` file: what a plot needs of it.
struct TimedPlace {
  double time = 0.0;  ///< [s]
  double x = 0.0;     ///< [m]
  double y = 0.0;     ///< [m]
};

/// @throws InputError if the file cannot be read
[[nodiscard]] std::vector<TimedPlace> readPath(const std::filesystem::path& path);

}  // namespace headway::report
