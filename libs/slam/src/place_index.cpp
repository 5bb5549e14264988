#include "place_index.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <random>

namespace headway::slam {
namespace {

constexpr int kNear = 50;  ///< bits in which two views of one corner differ, at most

int distance(const Descriptor& a, const Descriptor& b) {
  int bits = 0;
  for (std::size_t at = 0; at < a.size(); at += sizeof(std::uint64_t)) {
    std::uint64_t x = 0;
    std::uint64_t y = 0;
    std::memcpy(&x, a.data() + at, sizeof x);
    std::memcpy(&y, b.data() + at, sizeof y);
    bits += __builtin_popcountll(x ^ y);
  }
  return bits;
}

}  // namespace

PlaceIndex::PlaceIndex() {
  std::mt19937 random(20180731);
  for (auto& table : bits_) {
    for (int& bit : table) bit = static_cast<int>(random() % 256U);
  }
}

std::array<PlaceIndex::Word, PlaceIndex::kTables> PlaceIndex::wordsOf(
    const Descriptor& descriptor) const {
  std::array<Word, kTables> words{};
  for (std::size_t table = 0; table < kTables; ++table) {
    Word word = static_cast<Word>(table);
    for (const int bit : bits_[table]) {
      const unsigned byte = descriptor[static_cast<std::size_t>(bit / 8)];
      word = (word << 1U) | ((byte >> static_cast<unsigned>(bit % 8)) & 1U);
    }
    words[table] = word;
  }
  return words;
}

void PlaceIndex::add(KeyframeId keyframe, const std::vector<Descriptor>& descriptors) {
  remove(keyframe);
  auto& kept = descriptors_[keyframe];
  std::copy_if(descriptors.begin(), descriptors.end(), std::back_inserter(kept),
               [](const Descriptor& descriptor) { return descriptor != Descriptor{}; });
  kept.shrink_to_fit();
  for (const Descriptor& descriptor : kept) {
    for (const Word word : wordsOf(descriptor)) seen_in_[word].push_back({keyframe, &descriptor});
  }
}

void PlaceIndex::remove(KeyframeId keyframe) {
  const auto known = descriptors_.find(keyframe);
  if (known == descriptors_.end()) return;
  for (const Descriptor& descriptor : known->second) {
    for (const Word word : wordsOf(descriptor)) {
      const auto list = seen_in_.find(word);
      if (list == seen_in_.end()) continue;  // two descriptors shared the word
      auto& entries = list->second;
      entries.erase(std::remove_if(entries.begin(), entries.end(),
                                   [&](const Entry& entry) { return entry.keyframe == keyframe; }),
                    entries.end());
      if (entries.empty()) seen_in_.erase(list);
    }
  }
  descriptors_.erase(known);
}

std::vector<KeyframeId> PlaceIndex::keyframesWith(const Descriptor& descriptor) const {
  std::vector<KeyframeId> keyframes;
  for (const Word word : wordsOf(descriptor)) {
    const auto list = seen_in_.find(word);
    if (list == seen_in_.end()) continue;
    for (const Entry& entry : list->second) {
      if (distance(descriptor, *entry.descriptor) <= kNear) keyframes.push_back(entry.keyframe);
    }
  }
  std::sort(keyframes.begin(), keyframes.end());
  keyframes.erase(std::unique(keyframes.begin(), keyframes.end()), keyframes.end());
  return keyframes;
}

std::vector<PlaceMatch> PlaceIndex::query(const std::vector<Descriptor>& descriptors, int count,
                                          const std::function<bool(KeyframeId)>& wanted) const {
  std::map<KeyframeId, double> scores;
  for (const Descriptor& descriptor : descriptors) {
    if (descriptor == Descriptor{}) continue;
    const auto keyframes = keyframesWith(descriptor);
    const double weight = std::log1p(static_cast<double>(descriptors_.size()) /
                                     static_cast<double>(keyframes.size() + 1));
    for (const KeyframeId keyframe : keyframes) scores[keyframe] += weight;
  }
  std::vector<PlaceMatch> matches;
  for (const auto& [keyframe, score] : scores) {
    if (wanted(keyframe)) matches.push_back({keyframe, score});
  }
  std::stable_sort(matches.begin(), matches.end(),
                   [](const PlaceMatch& a, const PlaceMatch& b) { return a.score > b.score; });
  if (static_cast<int>(matches.size()) > count) matches.resize(static_cast<std::size_t>(count));
  return matches;
}

}  // namespace headway::slam
