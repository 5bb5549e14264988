// SPDX-License-Identifier: BSD-3-Clause
// Ids of tracks, landmarks and keyframes, which cannot be confused with each other.
#pragma once

#include <cstdint>
#include <functional>

namespace headway {

/// An integer id whose type is distinct for each kind of object.
///
/// Ids start at 0 and are given in order of creation, so ordering by id is deterministic.
template <typename Tag>
struct StrongId {
  std::int64_t value = -1;

  [[nodiscard]] bool valid() const { return value >= 0; }
  friend bool operator==(StrongId a, StrongId b) { return a.value == b.value; }
  friend bool operator!=(StrongId a, StrongId b) { return a.value != b.value; }
  friend bool operator<(StrongId a, StrongId b) { return a.value < b.value; }
};

using TrackId = StrongId<struct TrackTag>;
using LandmarkId = StrongId<struct LandmarkTag>;
using KeyframeId = StrongId<struct KeyframeTag>;

}  // namespace headway
/// Hash of an id's value.
template <typename Tag>
struct std::hash<headway::StrongId<Tag>> {
  std::size_t operator()(headway::StrongId<Tag> id) const noexcept {
    return std::hash<std::int64_t>{}(id.value);
  }
};
