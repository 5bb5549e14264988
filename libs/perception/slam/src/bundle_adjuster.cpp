// SPDX-License-Identifier: BSD-3-Clause
#include "bundle_adjuster.h"

#include <algorithm>
#include <chrono>

namespace headway::slam {

bool BundleAdjuster::Job::finished() const {
  return solved.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void BundleAdjuster::adjust(SparseMap& map, const std::vector<KeyframeId>& free,
                            int max_iterations) {
  if (!in_background_) {
    free_offset_ = adjustBundle(map, free, camera_, max_iterations, stop_).free_offset;
    return;
  }
  if (job_ != nullptr || held_) return;
  job_ = std::make_unique<Job>(map, free, camera_);
  job_->solved =
      std::async(std::launch::async, [bundle = &job_->bundle, max_iterations, stop = stop_] {
        bundle->solve(max_iterations, stop);
      });
}

void BundleAdjuster::abandon() {
  free_offset_.reset();
  if (job_ == nullptr) return;
  job_->bundle.stop();
  abandoned_.push_back(std::move(job_));
}

std::optional<Pose> BundleAdjuster::applyFinished(SparseMap& map) {
  abandoned_.erase(std::remove_if(abandoned_.begin(), abandoned_.end(),
                                  [](const auto& job) { return job->finished(); }),
                   abandoned_.end());
  if (job_ == nullptr || !job_->finished()) return std::nullopt;
  job_->solved.get();
  const BundleSummary summary = job_->bundle.writeBack(map);
  free_offset_ = summary.free_offset;
  job_.reset();
  return summary.correction;
}

std::optional<Pose> BundleAdjuster::finish(SparseMap& map) {
  if (job_ != nullptr) job_->solved.wait();
  return applyFinished(map);
}

}  // namespace headway::slam
