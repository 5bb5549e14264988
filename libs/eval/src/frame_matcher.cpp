#include "frame_matcher.h"

#include <algorithm>

namespace headway::eval {
namespace {

void connect(FrameMatches& matches, const CandidatePair& pair) {
  matches.estimate_of[pair.row] = static_cast<int>(pair.column);
  matches.truth_of[pair.column] = static_cast<int>(pair.row);
}

}  // namespace

FrameMatches FrameMatcher::match(const ClassFrame& frame) {
  FrameMatches matches;
  matches.estimate_of.assign(frame.truth.size(), FrameMatches::kNone);
  for (const auto& estimate : frame.estimates) {
    const bool counts = estimate.score >= score_threshold_;
    matches.truth_of.push_back(counts ? FrameMatches::kNone : FrameMatches::kLeftOut);
  }
  std::vector<CandidatePair> possible;
  for (const auto& pair : frame.overlaps) {
    if (1.0 - pair.cost < min_overlap_) continue;
    if (matches.truth_of[pair.column] == FrameMatches::kLeftOut) continue;
    possible.push_back(pair);
  }
  for (const auto& pair : possible) {
    const bool is_free = matches.estimate_of[pair.row] == FrameMatches::kNone &&
                         matches.truth_of[pair.column] == FrameMatches::kNone;
    const int before = previous_[static_cast<std::size_t>(frame.truth[pair.row].track)];
    if (is_free && before == frame.estimates[pair.column].track) connect(matches, pair);
  }
  possible.erase(std::remove_if(possible.begin(), possible.end(),
                                [&](const CandidatePair& pair) {
                                  return matches.estimate_of[pair.row] != FrameMatches::kNone ||
                                         matches.truth_of[pair.column] != FrameMatches::kNone;
                                }),
                 possible.end());
  for (const auto& pair : assignPairs(std::move(possible))) connect(matches, pair);
  std::fill(previous_.begin(), previous_.end(), FrameMatches::kNone);
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const int j = matches.estimate_of[i];
    if (j == FrameMatches::kNone) continue;
    previous_[static_cast<std::size_t>(frame.truth[i].track)] =
        frame.estimates[static_cast<std::size_t>(j)].track;
  }
  return matches;
}

}  // namespace headway::eval
