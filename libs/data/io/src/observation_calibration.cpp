// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/mrpt_pose.h>
#include <headway/io/observation_calibration.h>

#include <algorithm>

namespace headway::io {

RawStereoCamera rawFrom(const StereoCamera& camera) {
  RawStereoCamera raw;
  raw.left.width = camera.width;
  raw.left.height = camera.height;
  raw.left.fx = camera.fx;
  raw.left.fy = camera.fy;
  raw.left.cx = camera.cx;
  raw.left.cy = camera.cy;
  raw.right = raw.left;
  raw.T_robot_left = camera.T_robot_cam;
  raw.T_left_right.translation().x() = camera.baseline_m;
  return raw;
}

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

mrpt::obs::CObservation3DRangeScan::Ptr depthObservation(const mrpt::img::CImage& image,
                                                         const cv::Mat& depth,
                                                         const RawDepthCamera& camera) {
  auto scan = mrpt::obs::CObservation3DRangeScan::Create();
  // MRPT's sensor has x forward, and stands in the depth camera; its cameras have optical axes.
  const Pose T_sensor_color = robotFromOptical() * camera.T_color_depth.inverse();
  scan->sensorPose = toMrpt(Pose(camera.T_robot_color * T_sensor_color.inverse()));
  scan->relativePoseIntensityWRTDepth = toMrpt(T_sensor_color);
  scan->cameraParams = mrptCamera(camera.depth, "depth");
  scan->cameraParamsIntensity = mrptCamera(camera.color, "color");
  scan->hasIntensityImage = true;
  scan->intensityImage = image;
  scan->hasRangeImage = true;
  scan->range_is_depth = camera.ranges_are_depths;
  scan->rangeUnits = static_cast<float>(camera.metres_per_unit);
  scan->maxRange = static_cast<float>(camera.max_range_m);
  scan->rangeImage_setSize(depth.rows, depth.cols);
  for (int row = 0; row < depth.rows; ++row) {
    const auto* ranges = depth.ptr<std::uint16_t>(row);
    std::copy(ranges, ranges + depth.cols, &scan->rangeImage(row, 0));
  }
  return scan;
}

}  // namespace headway::io
