// SPDX-License-Identifier: BSD-3-Clause
// Images, poses and boxes as NumPy arrays.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::python {

namespace py = pybind11;

/// Rows of numbers, such as a trajectory.
using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A read-only array that shares the image's memory and keeps it alive.
///
/// @param image  8-bit grey (height, width), BGR (height, width, 3), or 32-bit float; not empty
[[nodiscard]] py::array arrayOf(const cv::Mat& image);

/// A copy of an image of 8-bit unsigned numbers: (height, width), or (height, width, 3) as BGR.
///
/// @param name  of the argument, for errors
/// @throws InputError for arrays of other types and shapes
[[nodiscard]] cv::Mat imageFrom(const py::array& array, const std::string& name);

/// A copy of a depth image of floats (height, width) [m] as 32-bit, 0 where nothing was measured:
/// at numbers that are not finite or not positive.
///
/// @param name  of the argument, for errors
/// @throws InputError for arrays of other types and shapes
[[nodiscard]] cv::Mat depthFrom(const py::array& array, const std::string& name);

/// @param names  of the arguments, for errors
/// @throws InputError if an image has another size than the camera's
void requireSize(const std::vector<cv::Mat>& images, const StereoCamera& camera,
                 const std::string& names);

/// A pose from a 4x4 matrix.
///
/// @throws InputError if it is no rigid motion
[[nodiscard]] Pose poseFrom(const Eigen::Matrix4d& matrix);

/// Rows `time x y z qx qy qz qw`, as in a TUM file.
[[nodiscard]] py::array_t<double> rowsOf(const std::vector<Stamped<Pose>>& trajectory);

/// The inverse of rowsOf().
///
/// @throws InputError for arrays of another shape and rotations that are none
[[nodiscard]] std::vector<Stamped<Pose>> trajectoryFrom(const Rows& rows, const std::string& name);

void bindFrames(py::module_& module);
void bindRecordings(py::module_& module);
void bindTracks(py::module_& module);
void bindMap(py::module_& module);
void bindPerception(py::module_& module);
void bindResults(py::module_& module);
void bindEvaluation(py::module_& module);

}  // namespace headway::python
