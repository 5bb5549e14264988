// SPDX-License-Identifier: BSD-3-Clause
#include "bag_file.h"

#include <headway/core/error.h>

#include <algorithm>
#include <filesystem>

namespace headway::bags {

BagFile::BagFile(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path + ": does not exist");
  size_ = std::filesystem::file_size(path, error);
  if (error || !file_) throw InputError(path + ": cannot be opened for reading");
}

void BagFile::goTo(std::uint64_t position) {
  position_ = std::min(position, size_);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position_));
}

std::string_view BagFile::read(std::uint64_t count) {
  if (count > left() || count > kMaxRecordBytes) return {};
  buffer_.resize(static_cast<std::size_t>(count));
  file_.read(buffer_.data(), static_cast<std::streamsize>(count));
  if (!file_) {
    goTo(size_);  // a read error ends the file
    return {};
  }
  position_ += count;
  return buffer_;
}

}  // namespace headway::bags
