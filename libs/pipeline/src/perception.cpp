#include <headway/pipeline/moving_regions.h>
#include <headway/pipeline/perception.h>

namespace headway::pipeline {

void PerceptionParams::describe(Params& params) {
  slam.describe(params.section("slam"));
  objects.describe(params.section("objects"));
}

Perception::Perception(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params)
    : camera_(std::move(camera)), tracker_(params.objects) {
  if (camera_ != nullptr) slam_ = std::make_unique<slam::StereoSlam>(camera_, params.slam);
}

Perception::~Perception() = default;

PerceptionUpdate Perception::process(const RecordedFrame& frame) {
  const auto watch = times_.watch("frame");
  PerceptionUpdate update;
  update.frame = frame.index;
  update.time = frame.time;
  update.camera = localise(frame);
  update.objects = track(frame, update.camera);
  updateMap(update);
  tracks_ = update.objects.tracks;
  return update;
}

slam::SlamUpdate Perception::localise(const RecordedFrame& frame) {
  if (!frame.T_map_robot && frame.stereo && slam_ != nullptr && given_poses_.empty()) {
    const auto moving =
        frame.detections ? movingRegions(*frame.detections, tracks_, *camera_) : MovingRegions();
    return slam_->process(*frame.stereo, moving);
  }
  slam::SlamUpdate given;
  if (frame.T_map_robot) {
    given.status = slam::TrackingStatus::kTracked;
    given.T_map_robot = *frame.T_map_robot;
    given.covariance.setZero();
  } else if (!given_poses_.empty()) {
    given.T_map_robot = given_poses_.back().T_map_robot;
  }
  given_poses_.push_back(
      {frame.index, frame.time, frame.T_map_robot.has_value(), given.T_map_robot});
  return given;
}

objects::TrackUpdate Perception::track(const RecordedFrame& frame, const slam::SlamUpdate& camera) {
  const auto watch = times_.watch("objects");
  if (frame.detections && camera.status == slam::TrackingStatus::kTracked) {
    return tracker_.update(frame.index, {frame.time, camera.T_map_robot}, *frame.detections);
  }
  auto update = tracker_.coast(frame.index, frame.time);
  if (frame.detections && !frame.detections->items.empty()) {
    update.detections_dropped["camera_lost"] += frame.detections->items.size();
  }
  return update;
}

void Perception::updateMap(const PerceptionUpdate& update) {
  const auto watch = times_.watch("map_update");
  if (update.camera.is_keyframe) map_.update(slam_->map());
  map_.update(update.time, update.objects.tracks);
}

std::vector<slam::FrameEstimate> Perception::trajectory() const {
  return slam_ != nullptr && given_poses_.empty() ? slam_->trajectory() : given_poses_;
}

StageTimes Perception::times() const {
  StageTimes all = times_;
  if (slam_ != nullptr) all.merge(slam_->times());
  return all;
}

}  // namespace headway::pipeline
