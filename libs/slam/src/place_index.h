#pragma once

#include <headway/core/ids.h>

#include <array>
#include <functional>
#include <map>
#include <unordered_map>
#include <vector>

#include "descriptor.h"

namespace headway::slam {

/// A keyframe that looks like what was asked for.
struct PlaceMatch {
  KeyframeId keyframe;
  double score = 0.0;  ///< descriptors found again, each counting the more the fewer places have it
};

/// Finds keyframes by the descriptors seen in them, without a vocabulary.
///
/// Words are a few bits of a descriptor, picked at random once (locality-sensitive hashing):
/// nothing to train, load or ship. An inverted list a word makes the cost of a query grow with the
/// words shared, not with the map; a shared word counts only if the whole descriptors are near,
/// so that chance matches do not count.
///
/// @see Indyk & Motwani 1998 (LSH); Sivic & Zisserman 2003 (inverted lists)
class PlaceIndex {
 public:
  PlaceIndex();
  PlaceIndex(const PlaceIndex&) = delete;
  PlaceIndex& operator=(const PlaceIndex&) = delete;

  void add(KeyframeId keyframe, const std::vector<Descriptor>& descriptors);
  void remove(KeyframeId keyframe);

  /// The keyframes most alike, best first, of those that are wanted.
  [[nodiscard]] std::vector<PlaceMatch> query(const std::vector<Descriptor>& descriptors, int count,
                                              const std::function<bool(KeyframeId)>& wanted) const;

 private:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;
  using Word = std::uint32_t;  ///< table and bits
  /// One descriptor of one keyframe.
  struct Entry {
    KeyframeId keyframe;
    const Descriptor* descriptor = nullptr;  ///< one of descriptors_, which stay in place
  };
  [[nodiscard]] std::array<Word, kTables> wordsOf(const Descriptor& descriptor) const;
  /// Keyframes that have seen (nearly) this descriptor, ascending.
  [[nodiscard]] std::vector<KeyframeId> keyframesWith(const Descriptor& descriptor) const;

  std::array<std::array<int, kBits>, kTables> bits_{};
  std::unordered_map<Word, std::vector<Entry>> seen_in_;
  std::map<KeyframeId, std::vector<Descriptor>> descriptors_;
};

}  // namespace headway::slam
