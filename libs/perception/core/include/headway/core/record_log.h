// SPDX-License-Identifier: BSD-3-Clause
// Records of which the newest are in memory and all others in a temporary file.
#pragma once

#include <headway/core/pose.h>

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <type_traits>
#include <vector>

namespace headway {

/// An unnamed file of bytes in the folder TMPDIR, or /var/tmp; it ends with its owner.
///
/// The file is created by the first append(), so that an unused one costs nothing.
class TemporaryFile {
 public:
  TemporaryFile() = default;
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// @return false, with the file unchanged, if the bytes cannot be written, such as to a full disk
  [[nodiscard]] bool append(const void* bytes, std::size_t count);
  /// @return false if the bytes from `offset` cannot be read. What was appended before may be read
  ///         by any thread, also during append()
  [[nodiscard]] bool read(std::size_t offset, void* bytes, std::size_t count) const;

 private:
  int file_ = -1;  ///< descriptor
  std::size_t size_ = 0;
};

/// A sequence that only grows, in bounded memory: the newest records can be changed, older ones are
/// in a temporary file. Records that the disk cannot take are dropped and counted.
///
///     RecordLog<StoredPose> path(10000);
///     path.append(stored(T_map_robot));
///     path.visit([&](const StoredPose& pose) { write(poseFrom(pose)); });
template <typename Record>
class RecordLog {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  /// @param in_memory  records that stay in memory at least; at most kBlock more do
  explicit RecordLog(std::size_t in_memory) : in_memory_(in_memory) {}

  /// The records so far as they are now, for any thread. It shares the file.
  [[nodiscard]] std::shared_ptr<const RecordLog> snapshot() const {
    return std::shared_ptr<const RecordLog>(new RecordLog(*this));
  }

  void append(const Record& record) {
    recent_.push_back(record);
    if (recent_.size() < in_memory_ + kBlock) return;
    const auto end = recent_.begin() + static_cast<std::ptrdiff_t>(kBlock);
    const std::vector<Record> block(recent_.begin(), end);
    (file_->append(block.data(), kBlock * sizeof(Record)) ? filed_ : dropped_) += kBlock;
    recent_.erase(recent_.begin(), end);
  }

  [[nodiscard]] bool empty() const { return recent_.empty(); }
  [[nodiscard]] const Record& back() const { return recent_.back(); }
  /// Records in memory, oldest first.
  [[nodiscard]] std::deque<Record>& recent() { return recent_; }
  [[nodiscard]] const std::deque<Record>& recent() const { return recent_; }
  /// Number of records in the file.
  [[nodiscard]] std::size_t filed() const { return filed_; }
  [[nodiscard]] std::size_t dropped() const { return dropped_; }

  /// Calls visit(record) with all records, oldest first, apart from unreadable ones.
  template <typename Visitor>
  void visit(Visitor&& visit) const {
    std::vector<Record> block(kBlock);
    for (std::size_t at = 0; at < filed_; at += kBlock) {
      if (!file_->read(at * sizeof(Record), block.data(), kBlock * sizeof(Record))) continue;
      for (const Record& record : block) visit(record);
    }
    for (const Record& record : recent_) visit(record);
  }

 private:
  RecordLog(const RecordLog&) = default;

  static constexpr std::size_t kBlock = 256;  // records written at once

  std::size_t in_memory_;
  std::deque<Record> recent_;
  std::shared_ptr<TemporaryFile> file_ = std::make_shared<TemporaryFile>();
  std::size_t filed_ = 0;
  std::size_t dropped_ = 0;
};

/// A pose as part of a record: the upper 3x4 block of its matrix by columns, bit for bit.
struct StoredPose {
  std::array<double, 12> values;
};

[[nodiscard]] inline StoredPose stored(const Pose& pose) {
  StoredPose result;
  Eigen::Map<Eigen::Matrix<double, 3, 4>>(result.values.data()) = pose.matrix().topRows<3>();
  return result;
}

[[nodiscard]] inline Pose poseFrom(const StoredPose& stored) {
  Pose pose = Pose::Identity();
  pose.matrix().topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4>>(stored.values.data());
  return pose;
}

}  // namespace headway
