#include <headway/core/mrpt_pose.h>
#include <headway/io/observation_calibration.h>

#include <algorithm>

namespace headway::io {
mrpt::img::TCamera mrptCamera(const RawCamera& camera, const std::string& name) {
  mrpt::img::TCamera result;
  result.ncols = static_cast<uint32_t>(camera.width);
  result.nrows = static_cast<uint32_t>(camera.height);
  result.cameraName = name;
  result.setIntrinsicParamsFromValues(camera.fx, camera.fy, camera.cx, camera.cy);
  const auto is_set = [](double k) { return k != 0.0; };
  const auto& d = camera.distortion;
  const auto& more = camera.rational;
  if (camera.is_fisheye) {
    result.setDistortionKannalaBrandt(d[0], d[1], d[2], d[3]);
  } else if (std::any_of(d.begin(), d.end(), is_set) ||
             std::any_of(more.begin(), more.end(), is_set)) {
    result.setDistortionPlumbBob(d[0], d[1], d[2], d[3], d[4]);
    std::copy(more.begin(), more.end(), result.dist.begin() + d.size());
  }
  return result;
}

void setCalibration(const RawStereoCamera& camera,
                    mrpt::obs::CObservationStereoImages& observation) {
  observation.leftCamera = mrptCamera(camera.left, "left");
  observation.rightCamera = mrptCamera(camera.right, "right");
  observation.cameraPose = toMrptQuat(camera.T_robot_left);
  observation.rightCameraPose = toMrptQuat(camera.T_left_right);
  // MRPT's driver for image folders does not set it.
  observation.hasImageRight = observation.hasImageRight || !observation.imageRight.isEmpty();
}

void setCalibration(const RawStereoCamera& camera, bool is_left,
                    mrpt::obs::CObservationImage& observation) {
  observation.cameraParams =
      is_left ? mrptCamera(camera.left, "left") : mrptCamera(camera.right, "right");
  observation.cameraPose =
      toMrpt(is_left ? camera.T_robot_left : Pose(camera.T_robot_left * camera.T_left_right));
}

}  // namespace headway::io
