// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
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

/// A read-only array that shares the image's memory and keeps it alive; None if it is empty.
///
/// @param image  8-bit grey (height, width), BGR (height, width, 3), or 32-bit float
[[nodiscard]] py::object arrayOf(const cv::Mat& image);

/// A copy of an image of 8-bit unsigned numbers: (height, width), or (height, width, 3) as BGR.
///
/// @param name  of the argument, for errors
/// @throws InputError for arrays of other types and shapes
[[nodiscard]] cv::Mat imageFrom(const py::array& array, const std::string& name);

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

void bindRecordings(py::module_& module);
void bindTracks(py::module_& module);
void bindMap(py::module_& module);
void bindPerception(py::module_& module);
void bindResults(py::module_& module);

}  // namespace headway::python
