// SPDX-License-Identifier: BSD-3-Clause
// Pictures of the map during a run, and the scene at its end.
#include "snapshots.h"

#include <headway/program/picture_files.h>

#include <cstdio>

#include "geo_files.h"

namespace headway::replay {

void Snapshots::add(const pipeline::Perception& perception,
                    const pipeline::PerceptionUpdate& update, const RecordedFrame& frame,
                    double progress) {
  if (slam::isTracked(update.camera.status)) {
    addToPath({update.time, update.camera.T_map_robot});
  }
  last_ = frame;
  T_map_robot_ = update.camera.T_map_robot;
  if (isDue(progress)) draw(perception);
}

/// Keeps every second pose of a path that has become too long, and adds every second one from then
/// on.
void Snapshots::addToPath(const Stamped<Pose>& pose) {
  if (tracked_++ % path_step_ != 0) return;
  path_.push_back(pose);
  if (path_.size() < kMaxKept) return;
  for (std::size_t i = 0; 2 * i < path_.size(); ++i) path_[i] = path_[2 * i];
  path_.resize((path_.size() + 1) / 2);
  path_step_ *= 2;
}

bool Snapshots::isDue(double progress) const {
  const auto done = static_cast<double>(written_.size());
  return done < count_ && progress * count_ >= done + 0.5;
}

scene::SnapshotInput Snapshots::input(const pipeline::Perception& perception) const {
  scene::SnapshotInput input{
      perception.map(), last_->index, last_->time, T_map_robot_, {}, {}, path_, {}, {}};
  if (last_->stereo) {
    const StereoFrame& stereo = *last_->stereo;
    input.camera = stereo.camera;
    input.image = stereo.left_colour.empty() ? stereo.left : stereo.left_colour;
  }
  return input;
}

void Snapshots::draw(const pipeline::Perception& perception) {
  if (renderer_ == nullptr) {
    std::filesystem::create_directories(folder_ / "snapshots");
    renderer_ = std::make_unique<scene::SnapshotRenderer>(look_);
  }
  char name[16];
  std::snprintf(name, sizeof name, "%06zu.png", last_->index);
  const auto path = folder_ / "snapshots" / name;
  program::writePicture(path.string(), renderer_->draw(input(perception)));
  written_.emplace_back(name);
}

void Snapshots::move(const Pose& T_map_run) {
  for (auto& pose : path_) pose.value = T_map_run * pose.value;
  T_map_robot_ = T_map_run * T_map_robot_;
}

void Snapshots::finish(const pipeline::Perception& perception) {
  if (!last_) return;
  if (count_ > 0 && written_.empty()) draw(perception);
  scene::saveScene((folder_ / "scene.3Dscene").string(), input(perception), look_);
}

}  // namespace headway::replay
