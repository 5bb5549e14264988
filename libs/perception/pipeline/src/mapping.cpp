// SPDX-License-Identifier: BSD-3-Clause
// The layers of the map: static map, grid, dense points and moving objects, for each submap.
#include "mapping.h"

#include <headway/detect/depth_scanner.h>
#include <headway/pipeline/moving_regions.h>
#include <headway/stereo/rectification.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "laser_evidence.h"

namespace headway::pipeline {
namespace {

constexpr std::size_t kScansMovedPerFrame = 20;  ///< of the grid in live operation; about 10 ms

/// The configured values in place of derived ones.
stereo::RigAssumptions assumptionsOf(const StereoCamera* camera, const PerceptionParams& params) {
  if (camera == nullptr) return {};
  const auto& detect = params.detection.detect;
  (void)params.grid.scan.capabilityOf(*camera);  // refuses obstacles that it cannot see
  auto configured = params.grid.scan.configured();
  configured.nearest_m = detect.disparity.nearest_m;
  configured.vehicles_to_m = detect.stereo_motion.max_range_m;
  configured.segments_to_m = detect.stereo_motion.max_segment_range_m;
  configured.grid_spacing_m = params.grid.map.spacing_m;
  configured.dense_to_m = params.dense.reach_m;
  configured.dense_voxel_m = params.dense.voxel_m;
  configured.dense_spacing_m = params.dense.spacing_m;
  return configured;
}

std::optional<stereo::RigCapability> rigOf(const StereoCamera* camera,
                                           const stereo::RigAssumptions& assumptions) {
  if (camera == nullptr) return std::nullopt;
  return stereo::rigCapability(*camera, assumptions);
}

/// Grid parameters without values to be derived.
GridParams gridFor(const std::optional<stereo::RigCapability>& rig,
                   const PerceptionParams& all_params) {
  GridParams params = all_params.grid;
  if (!all_params.slam.mapping) params.period_s = 0.0;
  params.map.footprint = all_params.robot;
  if (!rig) return params;
  params.map.spacing_m = rig->grid_spacing_m;
  return params;
}

/// The layer of what is blocked now, where it is asked for and there is a camera.
std::optional<map::LocalLayer> localFor(const std::optional<stereo::RigCapability>& rig,
                                        const GridParams& params) {
  if (!rig || !params.local) return std::nullopt;
  return map::LocalLayer(rig->obstacles_to_m, params.map.footprint, rig->nearest_m);
}

/// Number in the name of an attachment of a submap other than the first; nullopt: another name.
std::optional<int> submapOf(const std::string& name, const std::string& attachment) {
  const std::string prefix = attachment + ".";
  if (name.rfind(prefix, 0) != 0) return std::nullopt;
  int submap = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + prefix.size(), end, submap);
  if (error != std::errc() || rest != end || submap <= 0) return std::nullopt;
  return submap;
}

/// The ground of this image; without one, as the camera is mounted; nullopt if that is unknown.
std::optional<RobotGround> groundOf(const stereo::FrameContext& context,
                                    const stereo::RigCapability& rig) {
  const auto& plane = context.ground();
  if (!plane) return rig.camera_height_known ? std::optional(RobotGround{}) : std::nullopt;
  const Pose& T_robot_cam = context.camera().T_robot_cam;
  const Eigen::Vector3d up = T_robot_cam.linear() * plane->up;
  return RobotGround{up, plane->camera_height - up.dot(T_robot_cam.translation())};
}

constexpr double kLocalAhead_m = 3.0;  // where the cells of the local layer are crossed by
constexpr double kLocalColumns = 2.0;  // so many scanned columns

/// Columns of the disparity image from one that is scanned for the local layer to the next.
int columnStep(const map::LocalLayer& layer, const stereo::FrameContext& context) {
  const double columns = context.camera().fx / context.disparity().reduce * layer.cell_m();
  return columns >= 2.0 * kLocalColumns * kLocalAhead_m ? 2 : 1;
}

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
                       const Pose& T_map_robot, const Pose& T_odom_robot) {
  scanned_at_ = dense_.anchored(T_map_robot);
  T_odom_scanned_ = T_odom_robot;
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
  dense_.add(scanned_at_, T_odom_scanned_, scanned.scan);
  times.add("dense_scan", scanned.elapsed_ms + milliseconds(Clock::now() - start));
}

map::DenseMap DenseMapper::exchange(map::DenseMap other, StageTimes& times) {
  enterScan(times);
  if (fusing_.valid()) dense_.apply(fusing_.get().fused);
  return std::exchange(dense_, std::move(other));
}

void DenseMapper::update(map::PerceptionMap& map, StageTimes& times) {
  enterScan(times);
  if (!is_live_) return;
  if (fusing_.valid() && isReady(fusing_)) applyFused(map, times);
  const bool is_shown = map.dense() != nullptr || dense_.scans() == 0;
  if (fusing_.valid() || (is_shown && !dense_.isOutdated()) || Clock::now() < next_fusion_) return;
  fusing_ = fuser_.run([fusion = dense_.fusion()] {
    const auto start = Clock::now();
    TimedFusion result{fusion(), {}};
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
  const bool is_shown = map.dense() != nullptr || dense_.scans() == 0;
  if (is_shown && !dense_.isOutdated()) return;
  const auto start = Clock::now();
  if (const auto layer = dense_.layer()) map.update(layer);
  times.add("dense_fuse", milliseconds(Clock::now() - start));
}

ByteSource DenseMapper::save() const {
  map::DenseMap all = dense_;
  if (scanning_.valid()) all.add(scanned_at_, T_odom_scanned_, scanning_.get().scan);
  return all.save();
}

Mapping::Mapping(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
                 map::PerceptionMap map)
    : camera_(std::move(camera)),
      assumptions_(assumptionsOf(camera_.get(), params)),
      rig_(rigOf(camera_.get(), assumptions_)),
      grid_params_(gridFor(rig_, params)),
      laser_params_(params.laser),
      is_extended_(params.slam.mapping),
      is_live_(params.slam.adjust_in_background),
      local_(localFor(rig_, grid_params_)),
      grid_(grid_params_.map),
      dense_(params.dense, rig_, is_live_),
      map_(std::move(map)) {}

bool Mapping::takesTurn(const RecordedFrame& frame, const FrameRate& rate) {
  const double period_s = grid_params_.period_s;
  if (camera_ == nullptr || !frame.stereo || !(period_s > 0.0)) return false;
  const double seconds = last_scan_ ? frame.time - *last_scan_ : period_s;
  if (seconds >= 0.0 && !rate.isOver(seconds, period_s)) return false;  // < 0: clock set back
  last_scan_ = frame.time;
  return true;
}

void Mapping::setPeriod(double period_s) {
  if (is_extended_) grid_params_.period_s = period_s;
}

void Mapping::setRate(double rate_hz) {
  if (rate_hz == assumptions_.rate_hz) return;
  assumptions_.rate_hz = rate_hz;
  rig_ = rigOf(camera_.get(), assumptions_);
}

void Mapping::setRightTurn(const Eigen::Vector3d& turn, bool has_moved, StageTimes& times) {
  const double change_px =
      (turn.y() - yaw_of_scans_) / stereo::yawOfOffset(1.0, *camera_);  // of all disparities
  const bool is_wrong = !has_moved && std::abs(change_px) > rig_->sigma_disparity_px;
  if (has_moved || is_wrong) yaw_of_scans_ = turn.y();
  if (is_wrong) discardScans(times);
}

void Mapping::discardScans(StageTimes& times) {
  grid_ = map::StaticGrid(grid_params_.map);
  (void)dense_.exchange(dense_.emptyMap(), times);
  others_.clear();
  map_.removeStaticLayers();
}

void Mapping::remount(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
                      StageTimes& times) {
  camera_ = std::move(camera);
  rig_ = rigOf(camera_.get(), assumptions_);
  const double period_s = grid_params_.period_s;  // may have been changed
  grid_params_ = gridFor(rig_, params);
  grid_params_.period_s = period_s;
  local_ = localFor(rig_, grid_params_);
  dense_.remount(*rig_);
  discardScans(times);
}

void Mapping::update(const FrameState& state, StageTimes& times) {
  {
    const auto watch = times.watch("map_update");
    if (state.static_map) {
      enterSubmap(state.camera.submap, times);
      updateStaticMap(*state.static_map);
      const bool are_joined = state.camera.revision.cause == slam::MapChange::kSubmapJoined;
      joinSubmaps(state.submaps, *state.static_map, are_joined);
    } else {
      grid_.followMore(kScansMovedPerFrame);
    }
    const Pose& T_map_odom = state.camera.T_map_odom;
    const auto tracks = state.scale.enlarged(state.objects.tracks);
    update(state.frame.time, transformed(tracks, T_map_odom), T_map_odom);
  }
  updateGrid(state, times);
  updateDense(state, times);
}

/// The layers of different submaps are never in the map at once.
void Mapping::enterSubmap(int submap, StageTimes& times) {
  if (submap == submap_) return;
  Layers next = std::move(layersOf(submap));
  others_.erase(submap);
  Layers before{std::exchange(grid_, std::move(next.grid)),
                dense_.exchange(std::move(next.dense), times)};
  others_.insert_or_assign(std::exchange(submap_, submap), std::move(before));
  map_.removeStaticLayers();
  if (const auto grid = grid_.grid()) map_.update(grid);
}

/// Removes the layers of submaps that do not exist any more: those that are part of this one now
/// are added to it, those that were given up are not.
void Mapping::joinSubmaps(const std::vector<int>& existing, const slam::MapView& static_map,
                          bool are_joined) {
  for (auto at = others_.begin(); at != others_.end();) {
    if (std::find(existing.begin(), existing.end(), at->first) != existing.end()) {
      ++at;
      continue;
    }
    if (are_joined) {
      auto& [grid, dense] = at->second;
      grid.follow(static_map.keyframes);
      dense.follow(static_map.keyframes);
      grid_.add(grid, 0);
      dense_.add(dense);
    }
    at = others_.erase(at);
  }
}

void Mapping::show(int submap, const slam::StereoSlam& slam, StageTimes& times) {
  enterSubmap(submap, times);
  const auto view = slam.map(submap);
  map_.update(view);
  grid_.follow(view.keyframes);
  dense_.follow(view.keyframes);
  joinSubmaps(slam.submaps(), view, true);
  if (const auto grid = grid_.grid()) map_.update(grid);
}

std::vector<Submap> Mapping::others(const slam::StereoSlam& slam) {
  std::vector<Submap> submaps;
  for (const int number : slam.submaps()) {
    if (number == submap_) continue;
    Submap& submap = submaps.emplace_back();
    submap.number = number;
    auto view = slam.map(number);
    const auto layers = others_.find(number);
    if (layers != others_.end()) {
      auto& [grid, dense] = layers->second;
      grid.follow(view.keyframes);
      dense.follow(view.keyframes);
      if (const auto cells = grid.grid()) submap.map.update(cells);
      if (const auto points = dense.layer()) submap.map.update(points);
    }
    submap.map.update(std::move(view));
  }
  return submaps;
}

void Mapping::updateStaticMap(const slam::MapView& static_map) {
  map_.update(static_map);
  if (is_live_) {
    grid_.follow(static_map.keyframes, kScansMovedPerFrame);
  } else {
    grid_.follow(static_map.keyframes);
  }
  dense_.follow(static_map.keyframes);
}

void Mapping::updateGrid(const FrameState& state, StageTimes& times) {
  if (!state.T_map_robot) grid_.interrupt();
  std::optional<GroundScan> scan;
  if (state.scans_ground && state.T_map_robot && state.T_odom_robot) {
    const auto watch = times.watch("grid");
    scan = scanGround(state);
    addLaser(state, scan);
    if (scan) grid_.add(*state.T_map_robot, *state.T_odom_robot, std::move(*scan));
  } else {
    addLaser(state, scan);
  }
  const bool has_grid = camera_ != nullptr && state.context && grid_params_.period_s > 0.0;
  if (!has_grid || !state.T_map_robot) return;
  grid_.standAt(*state.T_map_robot);
  // A scan may see nothing, such as behind a truck in the first frame.
  if (const auto grid = grid_.grid()) map_.update(grid);
}

void Mapping::updateDense(const FrameState& state, StageTimes& times) {
  dense_.update(map_, times);
  if (!dense_.isUsed() || !state.scans_ground || !state.T_map_robot || !state.T_odom_robot) return;
  dense_.leaveOut(state.objects.tracks, state.frame.time);
  dense_.scan(*state.context, leftOutOfDenseMap(state), *state.T_map_robot, *state.T_odom_robot);
}

void Mapping::updateLocal(const FrameState& state, StageTimes& times) {
  if (!local_ || state.clock == ClockStep::kRepeated) return;
  const auto watch = times.watch("local");
  // A motion that nothing measured: what was seen before may be anywhere.
  const bool is_adrift = !state.camera.is_motion_seen && !state.motion_prior.T_previous_current;
  if (is_adrift) local_ = localFor(rig_, grid_params_);
  GroundScan scan;
  const int step = state.scans_local ? columnStep(*local_, *state.context) : 1;
  if (state.scans_local && state.context->ground()) {
    scan = detect::scanGround(state.context->disparity(), state.context->reducedLeft(), *camera_,
                              *state.context->ground(), {}, grid_params_.scan, step);
  }
  const auto scene =
      laser_params_.use && !state.frame.laser_scans.empty() ? laserScene(state) : std::nullopt;
  if (scene) {
    std::map<std::string, std::size_t> counts;  // those of the grid are reported
    addLaserScans(state.frame.laser_scans, *scene, {}, laser_params_, scan, counts);
  }
  local_->add(state.frame.time, state.camera.T_odom_robot, scan, *camera_, step);
  map_.update(std::make_shared<const map::LocalLayer>(*local_));
}

std::optional<GroundScan> Mapping::scanGround(const FrameState& state) const {
  const auto& ground = state.context->ground();
  if (!ground) return std::nullopt;
  return detect::scanGround(state.context->disparity(), state.context->reducedLeft(), *camera_,
                            *ground, leftOutOfGrid(state), grid_params_.scan);
}

MovingRegions Mapping::leftOutOfGrid(const FrameState& state) const {
  std::vector<Detections> sources;
  if (state.found.fused) sources.push_back(*state.found.fused);
  const auto& tracks = state.objects.tracks;
  auto moving = movingRegions(sources, tracks, state.found.motion, state.frame.time, *camera_);
  append(movingRegions(tracks, *state.T_odom_robot, *camera_), moving);
  return moving;
}

MovingRegions Mapping::leftOutOfDenseMap(const FrameState& state) const {
  auto regions = leftOutOfGrid(state);
  append(movableRegions(state.found.fused.value_or(Detections()), state.objects.tracks,
                        *state.T_odom_robot, *camera_),
         regions);
  return regions;
}

void Mapping::addLaser(const FrameState& state, std::optional<GroundScan>& scan) {
  const auto& scans = state.frame.laser_scans;
  if (scans.empty() || !laser_params_.use) return;
  const auto leave_out = [&](const char* reason) { laser_counts_[reason] += scans.size(); };
  if (!state.T_map_robot) return leave_out("camera_lost");
  if (!state.T_odom_robot) return leave_out("time_repeated");
  if (!state.scans_ground) return leave_out("between_ground_scans");
  const auto scene = laserScene(state);
  if (!scene) return leave_out("ground_unknown");
  if (!scan) scan.emplace();
  addLaserScans(scans, *scene, state.objects.tracks, laser_params_, *scan, laser_counts_);
}

std::optional<LaserScene> Mapping::laserScene(const FrameState& state) const {
  if (!state.context) return std::nullopt;
  const auto ground = groundOf(*state.context, *rig_);
  if (!ground) return std::nullopt;
  LaserScene scene;
  scene.time = state.frame.time;
  scene.T_odom_robot = state.camera.T_odom_robot;
  scene.T_previous_robot = state.T_previous_robot;
  scene.interval_s = state.secondsSincePrevious();
  scene.ground = *ground;
  scene.camera = camera_->T_robot_cam.translation();
  scene.min_obstacle_height_m = rig_->min_obstacle_height_m;
  scene.max_obstacle_height_m = grid_params_.scan.max_obstacle_height_m;
  scene.footprint = grid_params_.map.footprint;
  return scene;
}

void Mapping::finish(StageTimes& times) {
  dense_.update(map_, times);
  updateDensePoints(times);
}

void Mapping::load(const map::StoredMap& stored, slam::MapView static_map) {
  map_.update(std::move(static_map));
  const auto scans = stored.attachments.find(map::kGridAttachment);
  if (scans != stored.attachments.end()) {
    grid_.load(scans->second);
    if (const auto grid = grid_.grid()) map_.update(grid);
  }
  const auto depths = stored.attachments.find(map::kDenseAttachment);
  if (depths != stored.attachments.end()) dense_.load(depths->second);
  for (const auto& [name, bytes] : stored.attachments) {
    if (const auto number = submapOf(name, map::kGridAttachment))
      layersOf(*number).grid.load(bytes);
    if (const auto number = submapOf(name, map::kDenseAttachment)) {
      layersOf(*number).dense.load(bytes);
    }
  }
  if (const auto& dense = stored.map.dense()) {
    map_.update(std::make_shared<mrpt::maps::CColouredPointsMap>(*dense));
  }
}

map::StoredMap Mapping::stored() const {
  map::StoredMap stored;
  stored.map = map_;
  if (const auto grid = grid_.grid()) stored.map.update(grid);
  return stored;
}

void Mapping::attachScans(map::StoredMap& stored) const {
  const auto named = [](const char* attachment, int submap) {
    return submap == 0 ? attachment : std::string(attachment) + "." + std::to_string(submap);
  };
  stored.attachments[named(map::kGridAttachment, submap_)] = grid_.save();
  stored.made_attachments[named(map::kDenseAttachment, submap_)] = dense_.save();
  for (const auto& [submap, layers] : others_) {
    stored.attachments[named(map::kGridAttachment, submap)] = layers.grid.save();
    stored.made_attachments[named(map::kDenseAttachment, submap)] = layers.dense.save();
  }
}

Mapping::Layers& Mapping::layersOf(int submap) {
  const auto layers = others_.find(submap);
  if (layers != others_.end()) return layers->second;
  return others_.emplace(submap, Layers{map::StaticGrid(grid_params_.map), dense_.emptyMap()})
      .first->second;
}

}  // namespace headway::pipeline
