// SPDX-License-Identifier: BSD-3-Clause
// Prediction of the next pose, and the composition of its covariance.
#include "motion_model.h"

#include <algorithm>
#include <cmath>

namespace headway::slam {

PoseCovariance composedCovariance(const PoseCovariance& of_ab, const Pose& T_b_c,
                                  const PoseCovariance& of_bc) {
  const Eigen::Matrix3d R = T_b_c.linear().transpose();
  const Eigen::Vector3d& t = T_b_c.translation();
  PoseCovariance adjoint = PoseCovariance::Zero();
  adjoint.topLeftCorner<3, 3>() = R;
  adjoint.topRightCorner<3, 3>() = -R * crossMatrix(t);
  adjoint.bottomRightCorner<3, 3>() = R;
  return adjoint * of_ab * adjoint.transpose() + of_bc;
}

PoseCovariance calibrationCovariance(const Pose& T_origin_cam, double offset_ratio) {
  constexpr double kSigma = 0.003;  ///< of focal lengths, baselines and scales of depth, relative
  const Eigen::Vector3d& way = T_origin_cam.translation();
  const Eigen::Vector3d turn = logSo3(T_origin_cam.linear());
  const Eigen::Matrix3d R_cam_origin = T_origin_cam.linear().transpose();
  Eigen::Matrix<double, 6, 2> errors;
  errors.col(0) << R_cam_origin * turn.cross(way), turn;
  errors.col(1) << R_cam_origin * way, Eigen::Vector3d::Zero();
  const Eigen::Vector2d variances(square(kSigma), 2.0 * square(kSigma) + square(offset_ratio));
  return errors * variances.asDiagonal() * errors.transpose();
}

double positionSigma(const PoseCovariance& covariance) {
  return std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3.0);
}

double rotationSigma(const PoseCovariance& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace() / 3.0);
}

namespace {

/// Turn of the robot that leaves its yaw at 0 and has its z axis against gravity.
Eigen::Matrix3d levelled(const Eigen::Vector3d& up_robot) {
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(up_robot, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return expSo3({0.0, 0.0, -yawOf(pose)}) * pose.linear();
}

}  // namespace

void MotionModel::initialise(Time time, const Eigen::Vector3d& up_robot) {
  Pose T_map_robot = Pose::Identity();
  T_map_robot.linear() = levelled(up_robot);
  reset(time, T_map_robot * T_robot_cam_);
}

Pose MotionModel::predict(const StereoFrame& frame) const {
  if (!started_) return last_.value;
  const MotionPrior& prior = frame.motion_prior;
  if (params_.use_odometry && prior.T_previous_current) {
    const Pose T_previous_current =
        T_robot_cam_.inverse(Eigen::Isometry) * *prior.T_previous_current * T_robot_cam_;
    return normalized(last_.value * T_previous_current);
  }
  const double gap = frame.time - last_.time;
  Pose step = Pose::Identity();
  if (gap > 0.0 && gap <= kMaxGap_s) {
    step.translation() = gap * velocity_;
    step.linear() = expSo3(gap * angular_velocity_);
  }
  if (params_.use_imu && prior.R_previous_current) {
    const Eigen::Matrix3d R_robot_cam = T_robot_cam_.linear();
    step.linear() = R_robot_cam.transpose() * *prior.R_previous_current * R_robot_cam;
  }
  return normalized(last_.value * step);
}

void MotionModel::update(Time time, const Pose& T_map_cam) {
  const double gap = time - last_.time;
  velocity_.setZero();
  angular_velocity_.setZero();
  if (started_ && gap > 0.0 && gap <= kMaxGap_s) {
    const Pose step = last_.value.inverse(Eigen::Isometry) * T_map_cam;
    velocity_ = step.translation() / gap;
    angular_velocity_ = logSo3(step.linear()) / gap;
  }
  last_ = {time, T_map_cam};
  measured_ = time;
  started_ = true;
}

void MotionModel::coast(Time time, const Pose& T_map_cam) {
  // 1 - (t / kMaxGap_s)^2 of the velocity is left at t.
  const auto left = [this](Time at) {
    const double passed = std::clamp((at - measured_) / kMaxGap_s, 0.0, 1.0);
    return 1.0 - passed * passed;
  };
  const double ratio = left(last_.time) > 0.0 ? std::min(1.0, left(time) / left(last_.time)) : 0.0;
  velocity_ *= ratio;
  angular_velocity_ *= ratio;
  last_ = {time, T_map_cam};
  started_ = true;
}

void MotionModel::reset(Time time, const Pose& T_map_cam) {
  velocity_.setZero();
  angular_velocity_.setZero();
  last_ = {time, T_map_cam};
  measured_ = time;
  started_ = true;
}

}  // namespace headway::slam
