#include "place_index.h"

#include <algorithm>
#include <random>

namespace headway::slam {

PlaceIndex::PlaceIndex() {
  std::mt19937 random(20180731);
  for (auto& table : bits_) {
    for (int& bit : table) bit = static_cast<int>(random() % 256U);
  }
}

std::vector<PlaceIndex::Word> PlaceIndex::wordsOf(
    const std::vector<Descriptor>& descriptors) const {
  std::vector<Word> words;
  words.reserve(descriptors.size() * kTables);
  for (const Descriptor& descriptor : descriptors) {
    if (descriptor == Descriptor{}) continue;
    for (int table = 0; table < kTables; ++table) {
      Word word = static_cast<Word>(table);
      for (const int bit : bits_[static_cast<std::size_t>(table)]) {
        const unsigned byte = descriptor[static_cast<std::size_t>(bit / 8)];
        word = (word << 1U) | ((byte >> static_cast<unsigned>(bit % 8)) & 1U);
      }
      words.push_back(word);
    }
  }
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

void PlaceIndex::add(KeyframeId keyframe, const std::vector<Descriptor>& descriptors) {
  remove(keyframe);
  auto& words = words_[keyframe];
  words = wordsOf(descriptors);
  for (const Word word : words) {
    auto& keyframes = seen_in_[word];
    keyframes.insert(std::lower_bound(keyframes.begin(), keyframes.end(), keyframe), keyframe);
  }
}

void PlaceIndex::remove(KeyframeId keyframe) {
  const auto known = words_.find(keyframe);
  if (known == words_.end()) return;
  for (const Word word : known->second) {
    const auto list = seen_in_.find(word);
    auto& keyframes = list->second;
    keyframes.erase(std::find(keyframes.begin(), keyframes.end(), keyframe));
    if (keyframes.empty()) seen_in_.erase(list);
  }
  words_.erase(known);
}

std::vector<PlaceMatch> PlaceIndex::query(const std::vector<Descriptor>& descriptors, int count,
                                          const std::function<bool(KeyframeId)>& wanted) const {
  std::map<KeyframeId, double> scores;
  for (const Word word : wordsOf(descriptors)) {
    const auto list = seen_in_.find(word);
    if (list == seen_in_.end()) continue;
    const double weight = 1.0 / static_cast<double>(list->second.size());
    for (const KeyframeId keyframe : list->second) scores[keyframe] += weight;
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
