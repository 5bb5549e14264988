#include <headway/stereo/stereo_residual.h>

namespace headway::stereo {

Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam,
                               const StereoMeasurement& measurement, const StereoCamera& camera,
                               Eigen::Matrix3d* jacobian) {
  const double inverse_depth = 1.0 / point_cam.z();
  const double x = point_cam.x() * inverse_depth;
  const double y = point_cam.y() * inverse_depth;
  const double disparity = camera.fx * camera.baseline_m * inverse_depth;
  const double weight = 1.0 / measurement.sigma_px;
  const double weight_disparity = measurement.stereo ? 1.0 / measurement.sigma_disparity_px : 0.0;
  if (jacobian != nullptr) {
    const double fx = weight * camera.fx * inverse_depth;
    const double fy = weight * camera.fy * inverse_depth;
    *jacobian << fx, 0.0, -fx * x,  //
        0.0, fy, -fy * y,           //
        0.0, 0.0, -weight_disparity * disparity * inverse_depth;
  }
  return {weight * (camera.fx * x + camera.cx - measurement.uv.x()),
          weight * (camera.fy * y + camera.cy - measurement.uv.y()),
          weight_disparity * (disparity - measurement.disparity)};
}

Eigen::Matrix<double, 3, 6> pointByPose(const Eigen::Vector3d& point_cam) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian.leftCols<3>() = -Eigen::Matrix3d::Identity();
  jacobian.rightCols<3>() << 0.0, -point_cam.z(), point_cam.y(),  //
      point_cam.z(), 0.0, -point_cam.x(),                         //
      -point_cam.y(), point_cam.x(), 0.0;
  return jacobian;
}

Pose retract(const Pose& pose, const Eigen::Matrix<double, 6, 1>& xi) {
  Pose moved = pose;
  moved.translation() += pose.linear() * xi.head<3>();
  moved.linear() = pose.linear() * expSo3(xi.tail<3>());
  return normalized(moved);
}

}  // namespace headway::stereo
