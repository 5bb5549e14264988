// SPDX-License-Identifier: BSD-3-Clause
// Opening a bag: its format by its first bytes, and recordings of several files.
#include <headway/bags/bag_reader.h>
#include <headway/core/compression.h>
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <utility>

#include "bag_formats.h"

namespace headway::bags {
namespace {

namespace fs = std::filesystem;

/// The files of a recording that was split, one after the other.
class SplitBag : public BagReader {
 public:
  explicit SplitBag(std::vector<std::string> paths) : paths_(std::move(paths)) {
    for (const auto& path : paths_) {
      const auto bag = openBag(path);
      for (const BagTopic& topic : bag->topics())
        topics_[indexOf(topic)].messages += topic.messages;
    }
  }

  double progress() const override {
    const double whole = static_cast<double>(next_) - (bag_ ? 1.0 - bag_->progress() : 0.0);
    return whole / static_cast<double>(paths_.size());
  }

  std::optional<BagMessage> next() override {
    while (bag_ || next_ < paths_.size()) {
      if (!bag_) bag_ = openBag(paths_[next_++]);
      if (auto message = bag_->next()) {
        message->topic = indexOf(bag_->topics()[message->topic]);
        return message;
      }
      close();
    }
    return std::nullopt;
  }

 private:
  void close() {
    if (bag_->truncation()) truncation_ = paths_[next_ - 1] + " " + *bag_->truncation();
    for (const auto& [reason, count] : bag_->skipped()) skipped_[reason] += count;
    bag_.reset();
  }

  std::vector<std::string> paths_;
  std::size_t next_ = 0;
  std::unique_ptr<BagReader> bag_;
};

std::unique_ptr<BagReader> openFolder(const std::string& path) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    const auto ending = entry.path().extension();
    if (ending == ".mcap" || ending == ".db3") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end(), isNaturallyBefore);
  if (files.empty()) {
    throw InputError(path +
                     ": contains no .mcap and no .db3 file; is it the folder of a ROS 2 bag?");
  }
  if (files.size() == 1) return openBag(files.front());
  return std::make_unique<SplitBag>(files);
}

}  // namespace

std::size_t BagReader::indexOf(const BagTopic& topic) {
  const auto same = std::find_if(topics_.begin(), topics_.end(), [&](const BagTopic& other) {
    return other.name == topic.name && other.type == topic.type && other.encoding == topic.encoding;
  });
  const auto index = static_cast<std::size_t>(same - topics_.begin());
  if (same == topics_.end()) topics_.push_back({topic.name, topic.type, topic.encoding, 0});
  return index;
}

void BagReader::requireTopics(const std::string& path, const char* what) const {
  if (!topics_.empty()) return;
  throw InputError(path + ": contains no " + what + (truncation_ ? "; it " + *truncation_ : ""));
}

std::unique_ptr<BagReader> openBag(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return openFolder(path);
  if (!fs::is_regular_file(path, ignored)) throw InputError(path + ": does not exist");
  std::array<char, 16> first{};
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), first.size());
  const std::string_view magic(first.data(), static_cast<std::size_t>(file.gcount()));
  const auto begins_with = [magic](std::string_view start) {
    return magic.substr(0, start.size()) == start;
  };
  if (begins_with("#ROSBAG")) return openRos1Bag(path);
  if (begins_with(kMcapMagic)) return openMcapBag(path);
  if (begins_with(std::string_view("SQLite format 3\0", 16))) return openSqliteBag(path);
  if (isZstandard(magic)) {
    throw InputError(path + ": is compressed as a whole; `zstd -d` decompresses it");
  }
  const std::string pointer = io::lfsPointerFault(path);
  throw InputError(
      path + ": " +
      (pointer.empty() ? "is no bag of ROS 1 (.bag) or ROS 2 (.mcap, .db3)" : pointer));
}

}  // namespace headway::bags
