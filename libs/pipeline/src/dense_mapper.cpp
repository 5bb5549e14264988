// SPDX-License-Identifier: BSD-3-Clause
#include "dense_mapper.h"

#include <headway/detect/depth_scanner.h>

#include <algorithm>
#include <utility>

namespace headway::pipeline {
namespace {

constexpr std::chrono::seconds kMinInterval{1};  // between fusions
constexpr int kPauseFactor = 9;                  // of the duration of the last one
constexpr double kRevised_s = 2.0;               // of the past, in which tracks are still smoothed

map::DenseMapParams forRig(map::DenseMapParams params,
                           const std::optional<stereo::RigCapability>& rig) {
  if (!rig) return params;
  params.voxel_m = rig->dense_voxel_m;
  params.reach_m = rig->dense_to_m;
  params.spacing_m = rig->dense_spacing_m;
  return params;
}

double milliseconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

template <typename Result>
bool isReady(const std::future<Result>& result) {
  return result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

map::DenseMap DenseMapper::emptyMap() const { return map::DenseMap(forRig(params_, rig_)); }

DenseMapper::DenseMapper(const map::DenseMapParams& params,
                         const std::optional<stereo::RigCapability>& rig, bool is_live)
    : params_(params),
      used_(params.use && rig),
      is_live_(is_live),
      rig_(rig),
      dense_(forRig(params, rig)) {}

void DenseMapper::scan(const stereo::FrameContext& context, MovingRegions moving,
                       const Pose& T_map_robot) {
  scanned_at_ = dense_.anchored(T_map_robot);
  const auto make = [frame = context.frame(), disparity = context.disparity(),
                     match_ground = context.groundMatching(rig_->dense_to_m),
                     moving = std::move(moving), rig = *rig_] {
    const auto start = Clock::now();
    const auto ground = match_ground ? match_ground() : stereo::DisparityImage();
    Scanned result{detect::scanDepth(frame, disparity, ground, moving, rig)};
    result.elapsed_ms = milliseconds(Clock::now() - start);
    return result;
  };
  scanning_ = scanner_.run(make).share();
}

void DenseMapper::leaveOut(const std::vector<Track>& tracks, Time now) {
  dense_.leaveOut(tracks, now - kRevised_s);
}

void DenseMapper::enterScan(StageTimes& times) {
  if (!scanning_.valid()) return;
  const Scanned scanned = std::exchange(scanning_, {}).get();
  const auto start = Clock::now();
  dense_.add(scanned_at_, scanned.scan);
  times.add("dense_scan", scanned.elapsed_ms + milliseconds(Clock::now() - start));
}

void DenseMapper::update(map::PerceptionMap& map, StageTimes& times) {
  enterScan(times);
  if (!is_live_) return;
  if (fusing_.valid() && isReady(fusing_)) applyFused(map, times);
  if (fusing_.valid() || !dense_.isOutdated() || Clock::now() < next_fusion_) return;
  fusing_ = fuser_.run([fusion = dense_.fusion()] {
    const auto start = Clock::now();
    FusedBeside result{fusion(), {}};
    result.elapsed = Clock::now() - start;
    return result;
  });
}

void DenseMapper::applyFused(map::PerceptionMap& map, StageTimes& times) {
  auto result = fusing_.get();
  times.add("dense_fuse", milliseconds(result.elapsed));
  next_fusion_ =
      Clock::now() + std::max<Clock::duration>(kMinInterval, kPauseFactor * result.elapsed);
  map.update(result.fused.layer);
  dense_.apply(std::move(result.fused));
}

void DenseMapper::publish(map::PerceptionMap& map, StageTimes& times) {
  if (fusing_.valid()) applyFused(map, times);
  if (!dense_.isOutdated()) return;
  const auto start = Clock::now();
  if (const auto layer = dense_.layer()) map.update(layer);
  times.add("dense_fuse", milliseconds(Clock::now() - start));
}

ByteSource DenseMapper::save() const {
  map::DenseMap all = dense_;
  if (scanning_.valid()) all.add(scanned_at_, scanning_.get().scan);
  return all.save();
}

}  // namespace headway::pipeline
