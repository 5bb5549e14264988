// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_records.h"

#include <headway/core/error.h>

#include <array>
#include <charconv>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

namespace headway::replay {
namespace {

using Kind = slam::TrajectoryRecord::Kind;

template <typename Number>
void append(std::string& row, Number number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  row += ' ';
  row.append(text.data(), end);
}

/// The fields of a row, one after the other.
class Fields {
 public:
  explicit Fields(std::string_view row) : row_(row) {}

  std::string_view word() {
    const auto end = std::min(row_.find(' '), row_.size());
    const auto word = row_.substr(0, end);
    row_.remove_prefix(std::min(end + 1, row_.size()));
    return word;
  }
  template <typename Number>
  Number number() {
    const auto text = word();
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || text.empty()) {
      throw InputError("a row is damaged");
    }
    return number;
  }
  void requireEnd() const {
    if (!row_.empty()) throw InputError("a row is damaged");
  }

 private:
  std::string_view row_;
};

slam::TrajectoryRecord recordOf(std::string_view row) {
  Fields fields(row);
  const auto kind = fields.word();
  slam::TrajectoryRecord record;
  if (kind == "move") {
    record.kind = Kind::kMove;
    record.keyframe.value = fields.number<std::int64_t>();
    record.reference.value = fields.number<std::int64_t>();
  } else if (kind == "frame" || kind == "given") {
    record.frame = fields.number<std::size_t>();
    record.time = fields.number<double>();
    record.tracked = fields.number<int>() != 0;
    if (kind == "frame") record.reference.value = fields.number<std::int64_t>();
    if (kind == "given") record.kind = Kind::kGiven;
  } else {
    throw InputError("a row is damaged");
  }
  for (double& x : record.pose.values) x = fields.number<double>();
  fields.requireEnd();
  return record;
}

}  // namespace

void writeTrajectoryRecord(std::ostream& out, const slam::TrajectoryRecord& record) {
  std::string row;
  if (record.kind == Kind::kMove) {
    row = "move";
    append(row, record.keyframe.value);
    append(row, record.reference.value);
  } else {
    row = record.kind == Kind::kFrame ? "frame" : "given";
    append(row, record.frame);
    append(row, record.time);
    append(row, record.tracked ? 1 : 0);
    if (record.kind == Kind::kFrame) append(row, record.reference.value);
  }
  for (const double x : record.pose.values) append(row, x);
  out << row << '\n';
}

slam::TrajectoryReader readTrajectoryRecords(const std::filesystem::path& path, std::size_t rows) {
  const auto file = std::make_shared<std::ifstream>(path);
  if (!*file && rows > 0) throw InputError(path.string() + ": cannot be read");
  return [path, file, left = rows]() mutable -> std::optional<slam::TrajectoryRecord> {
    if (left == 0) return std::nullopt;
    --left;
    std::string row;
    if (!std::getline(*file, row)) throw InputError(path.string() + ": rows are missing");
    try {
      return recordOf(row);
    } catch (const InputError& error) {
      throw InputError(path.string() + ": " + error.what());
    }
  };
}

}  // namespace headway::replay
