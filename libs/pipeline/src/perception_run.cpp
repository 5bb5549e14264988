// SPDX-License-Identifier: BSD-3-Clause
// The parts of Perception that store maps and runs, and continue them.
#include <headway/core/byte_archive.h>
#include <headway/core/error.h>
#include <headway/pipeline/perception.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

namespace headway::pipeline {
namespace {

constexpr std::uint32_t kVersion = 3;

void write(const std::map<std::string, std::size_t>& counts, ByteWriter& out) {
  out.count(counts.size());
  for (const auto& [name, count] : counts) {
    out.text(name);
    out.count(count);
  }
}

void write(const Warnings& warnings, ByteWriter& out) {
  out.count(warnings.size());
  for (const auto& [name, warning] : warnings) {
    out.text(name);
    out.count(warning.count);
    out.count(warning.first_frame);
    out.text(warning.text);
  }
}

void write(const RunState& state, ByteWriter& out) {
  out.value(kVersion);
  out.count(state.extent.last_frame);
  out.value(state.extent.last_time);
  out.count(state.extent.repeat_from);
  out.count(state.grid_frames);
  out.value(state.next_track_id);
  out.count(state.tracks.size());
  for (const auto& [id, position] : state.tracks) {
    out.value(id.value);
    out.matrix(position);
  }
  write(state.warnings, out);
  write(state.laser_counts, out);
}

RunExtent readExtent(ByteReader& in) {
  const auto version = in.value<std::uint32_t>();
  if (version != kVersion) {
    throw InputError("the run in it is of version " + std::to_string(version) +
                     ", this program reads version " + std::to_string(kVersion));
  }
  RunExtent extent;
  extent.last_frame = in.value<std::uint64_t>();
  extent.last_time = in.finiteValue<double>();
  extent.repeat_from = in.value<std::uint64_t>();
  if (extent.repeat_from > extent.last_frame) throw InputError("damaged: no frames to repeat");
  return extent;
}

RunState readState(ByteReader& in) {
  RunState state;
  state.extent = readExtent(in);
  state.grid_frames = in.value<std::uint64_t>();
  state.next_track_id = in.value<std::int64_t>();
  for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
    const TrackId id{in.value<std::int64_t>()};
    if (!id.valid() || id.value >= state.next_track_id) {
      throw InputError("damaged: a track has no valid id");
    }
    state.tracks[id] = in.finiteMatrix<Eigen::Vector3d>();
  }
  for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
    const std::string name = in.text();
    Warning& warning = state.warnings[name];
    warning.count = in.value<std::uint64_t>();
    warning.first_frame = in.value<std::uint64_t>();
    warning.text = in.text();
  }
  for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
    const std::string name = in.text();
    state.laser_counts[name] = in.value<std::uint64_t>();
  }
  return state;
}

/// The frames whose poses were recorded.
void restore(const slam::TrajectoryReader& next, RecordLog<GivenPose>& poses) {
  while (const auto record = next()) {
    if (record->kind != slam::TrajectoryRecord::Kind::kGiven) continue;
    poses.append({record->frame, record->time, record->pose, record->tracked});
  }
}

/// Ids of a repeated run's tracks in the run, by the id in the repetition: nearest pairs first.
std::map<TrackId, TrackId> idsInRun(const std::map<TrackId, Eigen::Vector3d>& repeated,
                                    const std::map<TrackId, Eigen::Vector3d>& in_run) {
  constexpr double kMaxDistance = 2.0;  // [m]
  std::vector<std::tuple<double, TrackId, TrackId>> pairs;
  for (const auto& [a, position] : repeated) {
    for (const auto& [b, position_in_run] : in_run) {
      const double distance = (position - position_in_run).norm();
      if (distance < kMaxDistance) pairs.emplace_back(distance, a, b);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::map<TrackId, TrackId> ids;
  std::set<TrackId> taken;
  for (const auto& [distance, a, b] : pairs) {
    if (ids.count(a) > 0 || !taken.insert(b).second) continue;
    ids[a] = b;
  }
  return ids;
}

}  // namespace

RunExtent extentOf(const std::string& run_state) {
  ByteReader in(run_state);
  return readExtent(in);
}

void Perception::resume(const map::StoredMap& stored) {
  load(stored);
  resumed_ = true;
}

void Perception::load(const map::StoredMap& stored) {
  if (slam_ == nullptr) {
    throw InputError("a map can only be taken up by a stereo camera, and here are poses alone");
  }
  const auto read = stored.attachments.find(map::kSlamAttachment);
  const auto made = stored.made_attachments.find(map::kSlamAttachment);
  if (read != stored.attachments.end()) {
    slam_->load(read->second);
  } else if (made != stored.made_attachments.end()) {
    slam_->load(collected(made->second));
  } else {
    throw InputError("it holds no landmarks that a camera could be localised by");
  }
  stereo_check_.assume(slam_->rightTurn());
  front_end_.setRightTurn({slam_->rightTurn(), *camera_});
  map_.update(slam_->map());
  const auto scans = stored.attachments.find(map::kGridAttachment);
  if (scans != stored.attachments.end()) {
    grid_.load(scans->second);
    if (const auto grid = grid_.grid()) map_.update(grid);
  }
  const auto depths = stored.attachments.find(map::kDenseAttachment);
  if (depths != stored.attachments.end()) dense_.load(depths->second);
  if (const auto& dense = stored.map.dense()) {
    map_.update(std::make_shared<mrpt::maps::CColouredPointsMap>(*dense));
  }
}

map::StoredMap Perception::stored() const {
  map::StoredMap stored;
  stored.map = map_;
  if (const auto grid = grid_.grid()) stored.map.update(grid);  // with the latest corrections
  if (camera_ != nullptr) stored.camera = *camera_;
  if (slam_ != nullptr && given_poses_.empty()) {
    stored.made_attachments[map::kSlamAttachment] = slam_->snapshot();
    stored.attachments[map::kGridAttachment] = grid_.save();
    stored.made_attachments[map::kDenseAttachment] = dense_.save();
  }
  return stored;
}

std::string Perception::runState() const {
  RunState state;
  if (!recent_frames_.empty()) {
    const auto& last = recent_frames_.back();
    state.extent = {last.value, last.time, recent_frames_.front().value};
  }
  state.grid_frames = grid_frames_;
  state.next_track_id = tracker_.nextId();
  state.tracks = tracker_.positions();
  state.warnings = warnings_;
  state.laser_counts = laser_counts_;
  ByteWriter out;
  write(state, out);
  const bool by_slam = slam_ != nullptr && given_poses_.empty();
  out.text(by_slam ? slam_->saveRun() : "");
  out.text(by_slam ? "" : grid_.save());  // the map of a run by SLAM contains these
  out.text(by_slam ? "" : collected(dense_.save()));
  return std::move(out.bytes);
}

void Perception::setTrajectoryLog(const slam::TrajectoryLog& log) {
  trajectory_log_ = log;
  if (slam_ != nullptr) slam_->setTrajectoryLog(log);
}

void Perception::continueRun(const map::StoredMap& stored, const std::string& run_state,
                             const slam::TrajectoryReader& trajectory) {
  ByteReader in(run_state);
  RunState state = readState(in);
  const std::string slam = in.text();
  const std::string grid = in.text();
  const std::string dense = in.text();
  if (!in.atEnd()) throw InputError("damaged: there are data after the end of the run");
  if (slam.empty()) {
    restore(trajectory, given_poses_);
    grid_.load(grid);
    dense_.load(dense);
    if (const auto loaded = grid_.grid()) map_.update(loaded);
  } else {
    load(stored);
    slam_->loadRun(slam, trajectory);
  }
  repeated_ = std::move(state);
}

/// Detectors and tracks remember less than these frames.
void Perception::keepForRepetition(const RecordedFrame& frame) {
  constexpr std::size_t kMinFrames = 40;
  constexpr double kMinTime = 10.0;  // [s]
  if (!recent_frames_.empty() && frame.time <= recent_frames_.back().time) recent_frames_.clear();
  recent_frames_.push_back({frame.time, frame.index});
  while (recent_frames_.size() > kMinFrames &&
         frame.time - recent_frames_.front().time > kMinTime) {
    recent_frames_.pop_front();
  }
}

void Perception::endRepetition() {
  const auto ids =
      tracker_.rename(idsInRun(tracker_.positions(), repeated_->tracks), repeated_->next_track_id);
  for (Track& track : tracks_) track.id = ids.at(track.id);
  for (ExpectedObject& object : expected_) object.track = ids.at(object.track);
  warnings_ = std::move(repeated_->warnings);
  laser_counts_ = std::move(repeated_->laser_counts);
  grid_frames_ = repeated_->grid_frames;
  repeated_.reset();
}

}  // namespace headway::pipeline
