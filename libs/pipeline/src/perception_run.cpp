// SPDX-License-Identifier: BSD-3-Clause
// The parts of Perception that store maps and load them.
#include <headway/core/error.h>
#include <headway/pipeline/perception.h>

namespace headway::pipeline {

void Perception::resume(const map::StoredMap& stored) {
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
  resumed_ = true;
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

}  // namespace headway::pipeline
