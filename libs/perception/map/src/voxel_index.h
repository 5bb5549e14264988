// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace headway::map {

/// Numbers voxels of a tile in the order in which they are first seen: an open hash table, because
/// millions are looked up and std::unordered_map takes several times as long.
class VoxelIndex {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  VoxelIndex() : slots_(1U << (32U - kFirstShift)) {}

  /// The number of a voxel, given if it has none.
  std::uint32_t numberOf(std::uint32_t key) {
    Slot& slot = slots_[find(key)];
    if (slot.number != kNone) return slot.number;
    const auto number = static_cast<std::uint32_t>(keys_.size());
    slot = {key, number};
    keys_.push_back(key);
    if (2 * keys_.size() > slots_.size()) grow();
    return number;
  }

  /// The number of a voxel, kNone if it has none.
  [[nodiscard]] std::uint32_t at(std::uint32_t key) const { return slots_[find(key)].number; }

  /// Keys by number.
  [[nodiscard]] const std::vector<std::uint32_t>& keys() const { return keys_; }

 private:
  struct Slot {
    std::uint32_t key = 0;
    std::uint32_t number = kNone;
  };
  [[nodiscard]] std::size_t find(std::uint32_t key) const {
    std::size_t at = (key * 0x9e3779b1U) >> shift_;  // Knuth's multiplicative hash
    while (slots_[at].number != kNone && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), {});
    --shift_;
    for (std::uint32_t number = 0; number < keys_.size(); ++number) {
      slots_[find(keys_[number])] = {keys_[number], number};
    }
  }

  static constexpr std::uint32_t kFirstShift = 20;

  std::uint32_t shift_ = kFirstShift;  ///< 32 less the binary logarithm of the number of slots
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> keys_;
};

}  // namespace headway::map
