// The parts of StereoSlam that store a run and continue it.
#include <headway/core/byte_archive.h>
#include <headway/core/error.h>

#include "pose_covariance.h"
#include "stereo_slam_implementation.h"

namespace headway::slam {
namespace {

constexpr std::uint32_t kRunVersion = 2;
constexpr std::size_t kMeasuredFrames = 2;  ///< at the end of a run, in which landmarks are tracked

}  // namespace

std::string StereoSlam::Implementation::saveRun() const {
  ByteWriter out;
  out.value(kRunVersion);
  out.matrix(covariance_);
  return std::move(out.bytes);
}

void StereoSlam::Implementation::loadRun(const std::string& bytes,
                                         const TrajectoryReader& trajectory) {
  ByteReader in(bytes);
  const auto version = in.value<std::uint32_t>();
  if (version != kRunVersion) {
    throw InputError("the run in it is of version " + std::to_string(version) +
                     ", this program reads version " + std::to_string(kRunVersion));
  }
  covariance_ = covariance_when_tracked_ = in.finiteMatrix<PoseCovariance>();
  if (!in.atEnd()) throw InputError("damaged: there are data after the end of the run");
  trajectory_.restore(trajectory, map_);
  const auto last = trajectory_.lastFrame();
  if (!last) return;
  const auto camera = trajectory_.find(*last, map_);
  motion_.reset(camera->time, camera->T_map_cam);
  if (camera->reference.valid()) setReferenceKeyframe(camera->reference);
  lost_in_a_row_ = 1;  // until a frame is repeated or tracked
}

SlamUpdate StereoSlam::Implementation::repeat(const stereo::FrameContext& context,
                                              const MovingRegions& moving) {
  const StereoFrame& frame = context.frame();
  SlamUpdate update;
  update.T_map_robot = normalized(motion_.last() * T_cam_robot_);
  update.covariance = composedCovariance(covariance_, T_cam_robot_, PoseCovariance::Zero());
  const auto camera = trajectory_.find(frame.index, map_);
  if (!camera) return update;
  update.T_map_robot = normalized(camera->T_map_cam * T_cam_robot_);
  if (!camera->tracked || !camera->reference.valid()) {
    ++lost_in_a_row_;
    motion_.coast(frame.time, camera->T_map_cam);
    return update;
  }
  if (lost_in_a_row_ > 0) {
    motion_.reset(frame.time, camera->T_map_cam);
  } else {
    motion_.update(frame.time, camera->T_map_cam);
  }
  lost_in_a_row_ = 0;
  update.status = TrackingStatus::kTracked;
  if (frame.index + kMeasuredFrames <= *trajectory_.lastFrame()) return update;
  setReferenceKeyframe(camera->reference);
  TrackingFrame current = makeTrackingFrame(context, moving, *camera_, params_);
  auto tracked = tracker_.measureLocalMap(current, camera->T_map_cam, local_landmarks_, map_,
                                          params_.min_inliers);
  if (!tracked) return update;
  update.inliers = update.features = static_cast<int>(tracked->landmarks.size());
  seen_before_ = std::move(tracked->landmarks);
  previous_ = std::move(current);
  return update;
}

void StereoSlam::setTrajectoryLog(TrajectoryLog log) {
  implementation_->setTrajectoryLog(std::move(log));
}

std::string StereoSlam::saveRun() const { return implementation_->saveRun(); }

void StereoSlam::loadRun(const std::string& bytes, const TrajectoryReader& trajectory) {
  implementation_->loadRun(bytes, trajectory);
}

SlamUpdate StereoSlam::repeat(const stereo::FrameContext& frame, const MovingRegions& moving) {
  return implementation_->repeat(frame, moving);
}

}  // namespace headway::slam
