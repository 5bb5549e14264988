#pragma once

#include <headway/io/dataset.h>

namespace headway::io {

/// A recording in EuRoC's layout (ASL folder): raw stereo images of a drone.
///
/// Reads `FOLDER/mav0/{cam0,cam1}/{sensor.yaml,data.csv,data}`, the inertial samples of
/// `mav0/imu0` where they are, and the truth in `FOLDER/groundtruth.tum` or
/// `mav0/state_groundtruth_estimate0/data.csv` (interpolated at the images' times). Images of the
/// two cameras are paired by equal time stamps.
///
/// The robot frame has its origin at the body's; its axes are turned so that x is the cameras' mean
/// viewing direction and y points from the right camera to the left one. The truth is turned with
/// it and stays in its own world frame.
///
/// @throws InputError naming the file that is missing or cannot be understood
[[nodiscard]] std::unique_ptr<Dataset> openEuroc(const std::string& folder);

}  // namespace headway::io
