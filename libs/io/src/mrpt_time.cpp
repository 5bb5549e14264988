#include <headway/io/mrpt_conversions.h>

#include <cmath>

namespace headway::io {
namespace {

constexpr double kTicksPerSecond = 1e7;

mrpt::math::CQuaternionDouble quaternionOf(const Pose& pose) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(pose.linear()).normalized();
  return {turn.w(), turn.x(), turn.y(), turn.z()};
}

}  // namespace

mrpt::poses::CPose3D mrptPose(const Pose& pose) {
  const auto& t = pose.translation();
  return {quaternionOf(pose), t.x(), t.y(), t.z()};
}

mrpt::poses::CPose3DQuat mrptPoseQuat(const Pose& pose) {
  const auto& t = pose.translation();
  return {t.x(), t.y(), t.z(), quaternionOf(pose)};
}

Pose poseFrom(const mrpt::poses::CPose3D& pose) {
  Pose result = Pose::Identity();
  result.linear() = pose.getRotationMatrix().asEigen();
  result.translation() << pose.x(), pose.y(), pose.z();
  return result;
}

Pose poseFrom(const mrpt::poses::CPose3DQuat& pose) {
  Pose result = Pose::Identity();
  const auto& q = pose.quat();
  result.linear() = Eigen::Quaterniond(q.r(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
  result.translation() << pose.x(), pose.y(), pose.z();
  return result;
}

mrpt::Clock::time_point mrptTime(Time time) {
  return mrpt::Clock::fromDouble(0.0) + mrpt::Clock::duration(std::llround(time * kTicksPerSecond));
}

Time timeFrom(mrpt::Clock::time_point time) {
  return static_cast<double>((time - mrpt::Clock::fromDouble(0.0)).count()) / kTicksPerSecond;
}

}  // namespace headway::io
