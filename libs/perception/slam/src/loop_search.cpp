// SPDX-License-Identifier: BSD-3-Clause
// The search for loops beside the tracking: the steps of LoopCloser::close(), one after the other.
#include <algorithm>
#include <chrono>
#include <future>

#include "loop_closer.h"

namespace headway::slam {

/// A running search. One step at a time runs in another thread, on the data in here alone.
struct LoopCloser::Search {
  enum class Step { kDescribe, kVerify, kCorrect, kAdjust };

  Step step = Step::kDescribe;
  bool abandoned = false;
  TrackingFrame frame;
  KeyframeId newest;                         ///< made of the frame
  std::vector<KeyframeId> old;               ///< keyframes that may show the same place
  std::vector<DescribedPoint> points;        ///< of the frame
  std::vector<KeyframeId> candidates;        ///< to be verified, best first
  LoopCandidate candidate;                   ///< that is being verified
  SparseMap landmarks;                       ///< copies, of its surroundings
  std::vector<LoopAttempt> attempts;         ///< candidates tested
  std::optional<ClosedLoop> loop;            ///< the verified one
  std::map<KeyframeId, Keyframe> keyframes;  ///< copies, of the whole map
  std::map<KeyframeId, Pose> corrected;
  std::future<void> running;
  WorkerThread& worker;

  explicit Search(WorkerThread& in) : worker(in) {}
  template <typename Work>
  void start(Step next, Work work) {
    step = next;
    running = worker.run(std::move(work));
  }
  [[nodiscard]] bool finished() const {
    return running.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
};

LoopCloser::LoopCloser(const StereoCamera& camera, const SlamParams& params,
                       BundleAdjuster& adjuster)
    : camera_(camera), params_(params), adjuster_(adjuster), tracker_(camera, params) {}

LoopCloser::~LoopCloser() = default;

void LoopCloser::search(const TrackingFrame& frame, KeyframeId newest, const SparseMap& map) {
  if (search_ != nullptr || newest.value % kSpacing != 0) return;
  auto old = findLoopCandidates(newest, map);
  if (old.empty()) return;
  search_ = std::make_unique<Search>(worker_);
  search_->frame = frame;
  search_->newest = newest;
  search_->old = std::move(old);
  search_->start(Search::Step::kDescribe,
                 [search = search_.get()] { search->points = describe(search->frame); });
}

std::vector<LoopAttempt> LoopCloser::closeOrSearch(const TrackingFrame& frame, KeyframeId newest,
                                                   SparseMap& map) {
  if (!params_.adjust_in_background) return close(frame, newest, map);
  search(frame, newest, map);
  return {};
}

LoopProgress LoopCloser::advance(SparseMap& map) {
  LoopProgress progress;
  if (search_ == nullptr || !search_->finished()) return progress;
  search_->running.get();
  const bool in_vain = search_->abandoned || map.keyframes().count(search_->newest) == 0;
  if (in_vain && search_->step != Search::Step::kAdjust) {
    endSearch();
    return progress;
  }
  switch (search_->step) {
    case Search::Step::kDescribe:
      search_->candidates = mostAlike(search_->points, search_->old);
      if (!verifyNext(map)) endSearch();
      break;
    case Search::Step::kVerify:
      if (map.keyframes().count(search_->candidate.attempt.candidate) == 0) {
        search_->loop.reset();  // culled meanwhile
      } else {
        search_->attempts.push_back(search_->candidate.attempt);
      }
      if (search_->loop) {
        startCorrection(map);  // the loop is reported with the correction of the map
      } else if (!verifyNext(map)) {
        progress.attempts = std::move(search_->attempts);
        endSearch();
      }
      break;
    case Search::Step::kCorrect:
      progress.attempts = std::move(search_->attempts);
      progress.correction = correct(map);
      search_->start(Search::Step::kAdjust, [] {});
      break;
    case Search::Step::kAdjust:
      adjuster_.hold(false);
      adjustAll(*search_->loop, map);
      endSearch();
      break;
  }
  return progress;
}

LoopProgress LoopCloser::finish(SparseMap& map) {
  LoopProgress progress;
  while (search_ != nullptr) {
    search_->running.wait();
    LoopProgress step = advance(map);
    if (!step.attempts.empty() || step.correction) progress = std::move(step);
  }
  return progress;
}

void LoopCloser::abandon() {
  if (search_ != nullptr) search_->abandoned = true;
}

void LoopCloser::endSearch() {
  search_.reset();
  adjuster_.hold(false);
}

/// Starts the verification of the next candidate; false if there is none.
///
/// One at a time, because the copies of its landmarks delay the frame.
bool LoopCloser::verifyNext(const SparseMap& map) {
  while (!search_->candidates.empty()) {
    const KeyframeId old = search_->candidates.front();
    search_->candidates.erase(search_->candidates.begin());
    if (map.keyframes().count(old) == 0) continue;
    search_->candidate = candidateOf(search_->newest, old, map);
    search_->landmarks = map.landmarksOnly(search_->candidate.among);
    search_->start(Search::Step::kVerify, [this, search = search_.get()] {
      search->loop = verify(search->frame, search->points, search->candidate, search->landmarks);
    });
    return true;
  }
  return false;
}

/// The map must not be adjusted until the correction is applied.
void LoopCloser::startCorrection(const SparseMap& map) {
  adjuster_.abandon();
  adjuster_.hold(true);
  search_->keyframes = keyframesOfLoop(search_->newest, search_->candidate.attempt.candidate, map);
  search_->start(Search::Step::kCorrect, [search = search_.get(), stop = params_.stop] {
    search->corrected = posesWithLoop(search->keyframes, *search->loop, stop);
  });
}

/// Applies the corrected poses; the adjustment follows with the next frame. Keyframes added
/// meanwhile move with the newest one that took part.
///
/// @return  the motion of the newest keyframe
Pose LoopCloser::correct(SparseMap& map) {
  std::map<KeyframeId, Pose> poses;
  Pose correction = Pose::Identity();
  const int newest = map.submapOf(search_->newest);
  for (const auto& [id, keyframe] : map.keyframes()) {
    const auto corrected = search_->corrected.find(id);
    if (corrected != search_->corrected.end()) {
      poses[id] = corrected->second;
      correction =
          normalized(Pose(corrected->second * keyframe.T_map_cam.inverse(Eigen::Isometry)));
    } else if (keyframe.submap == newest) {
      poses[id] = normalized(Pose(correction * keyframe.T_map_cam));
    }
  }
  applyCorrection(poses, map);
  const auto old = map.keyframes().find(search_->loop->old);
  if (old != map.keyframes().end()) map.joinSubmaps(newest, old->second.submap);
  return correction;
}

}  // namespace headway::slam
