// SPDX-License-Identifier: BSD-3-Clause
#include "wire_reader.h"

namespace headway::bags {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;
constexpr std::size_t kMaxPadding = 7;

}  // namespace

WireReader::WireReader(std::string_view message, Encoding encoding) : bytes_(message) {
  if (encoding == Encoding::kOther) throw BrokenData("a message of an unknown encoding");
  if (encoding == Encoding::kRos1) return;
  if (bytes_.size() < kEncapsulationBytes) throw BrokenData("a message without encapsulation");
  const auto kind = static_cast<unsigned char>(bytes_[1]);
  const bool is_version1 = kind <= 1;               // CDR, big and little endian
  const bool is_version2 = kind == 6 || kind == 7;  // the same of PLAIN_CDR2
  if (bytes_[0] != 0 || (!is_version1 && !is_version2)) {
    throw BrokenData("a message of an unknown encapsulation");
  }
  is_big_endian_ = kind % 2 == 0;
  max_alignment_ = is_version1 ? 8 : 4;
  bytes_.remove_prefix(kEncapsulationBytes);
}

std::string WireReader::text() {
  std::string_view value = bytes();
  if (!isRos1() && !value.empty() && value.back() == '\0') value.remove_suffix(1);
  return std::string(value);
}

std::uint32_t WireReader::length(std::size_t min_bytes) {
  const auto count = number<std::uint32_t>();
  if (count > (bytes_.size() - at_) / min_bytes) {
    throw BrokenData("a sequence is longer than its message");
  }
  return count;
}

void WireReader::requireEnd() const {
  if (bytes_.size() - at_ > (isRos1() ? 0 : kMaxPadding)) {
    throw BrokenData("a message is longer than its type");
  }
}

void WireReader::align(std::size_t size) {
  const std::size_t alignment = std::min(size, max_alignment_);
  at_ = (at_ + alignment - 1) / alignment * alignment;
}

std::string_view WireReader::take(std::size_t count) {
  if (at_ > bytes_.size() || count > bytes_.size() - at_) {
    throw BrokenData("a message is shorter than its type");
  }
  const auto result = bytes_.substr(at_, count);
  at_ += count;
  return result;
}

}  // namespace headway::bags
