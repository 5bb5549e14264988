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
  double score = 0.0;  ///< shared words, each counting the more the rarer it is
};

/// Finds keyframes by the descriptors seen in them, without a vocabulary.
///
/// Words are a few bits of a descriptor, picked at random once (locality-sensitive hashing):
/// nothing to train, load or ship, 20 ms to start a vocabulary of ORB-SLAM's kind becomes none. An
/// inverted list a word makes the cost of a query grow with the words shared, not with the map.
///
/// @see Indyk & Motwani 1998 (LSH); Sivic & Zisserman 2003 (inverted lists)
class PlaceIndex {
 public:
  PlaceIndex();

  void add(KeyframeId keyframe, const std::vector<Descriptor>& descriptors);
  void remove(KeyframeId keyframe);

  /// The keyframes most alike, best first, of those that are wanted.
  [[nodiscard]] std::vector<PlaceMatch> query(const std::vector<Descriptor>& descriptors, int count,
                                              const std::function<bool(KeyframeId)>& wanted) const;

 private:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;
  using Word = std::uint32_t;  ///< table and bits
  [[nodiscard]] std::vector<Word> wordsOf(const std::vector<Descriptor>& descriptors) const;

  std::array<std::array<int, kBits>, kTables> bits_{};
  std::unordered_map<Word, std::vector<KeyframeId>> seen_in_;  ///< ascending ids
  std::map<KeyframeId, std::vector<Word>> words_;              ///< ascending words
};

}  // namespace headway::slam
