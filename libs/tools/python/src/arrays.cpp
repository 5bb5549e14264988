// SPDX-License-Identifier: BSD-3-Clause
// Images, poses and boxes as NumPy arrays.
#include "arrays.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace headway::python {

py::array arrayOf(const cv::Mat& image) {
  auto shared = std::make_unique<cv::Mat>(image);
  const cv::Mat& mat = *shared;
  std::vector<py::ssize_t> shape = {mat.rows, mat.cols};
  std::vector<py::ssize_t> strides = {static_cast<py::ssize_t>(mat.step[0]),
                                      static_cast<py::ssize_t>(mat.elemSize())};
  if (mat.channels() > 1) {
    shape.push_back(mat.channels());
    strides.push_back(static_cast<py::ssize_t>(mat.elemSize1()));
  }
  const auto type = mat.depth() == CV_8U ? py::dtype::of<std::uint8_t>() : py::dtype::of<float>();
  const void* data = mat.data;
  const py::capsule owner(shared.release(),
                          [](void* owned) { delete static_cast<cv::Mat*>(owned); });
  py::array array(type, shape, strides, data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

cv::Mat imageFrom(const py::array& array, const std::string& name) {
  const bool is_colour = array.ndim() == 3 && array.shape(2) == 3;
  if (!array.dtype().equal(py::dtype::of<std::uint8_t>()) || (array.ndim() != 2 && !is_colour) ||
      array.size() == 0) {
    throw InputError(name + ": must be an array of uint8, (height, width) or (height, width, 3)");
  }
  using Bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;
  const auto rows = Bytes::ensure(array);
  return cv::Mat(static_cast<int>(rows.shape(0)), static_cast<int>(rows.shape(1)),
                 is_colour ? CV_8UC3 : CV_8UC1, const_cast<std::uint8_t*>(rows.data()))
      .clone();
}

cv::Mat depthFrom(const py::array& array, const std::string& name) {
  if (array.dtype().kind() != 'f' || array.ndim() != 2 || array.size() == 0) {
    throw InputError(name + ": must be an array of floats, (height, width)");
  }
  using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;
  const auto rows = Floats::ensure(array);
  cv::Mat depth = cv::Mat(static_cast<int>(rows.shape(0)), static_cast<int>(rows.shape(1)), CV_32F,
                          const_cast<float*>(rows.data()))
                      .clone();
  std::replace_if(
      depth.begin<float>(), depth.end<float>(),
      [](float value) { return !(std::isfinite(value) && value > 0.0F); }, 0.0F);
  return depth;
}

void requireSize(const std::vector<cv::Mat>& images, const StereoCamera& camera,
                 const std::string& names) {
  for (const auto& image : images) {
    if (image.cols != camera.width || image.rows != camera.height) {
      throw InputError(names + ": must have the camera's size");
    }
  }
}

Pose poseFrom(const Eigen::Matrix4d& matrix) {
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  constexpr double kTolerance = 1e-6;
  const bool is_rigid =
      matrix.allFinite() && (rotation * rotation.transpose()).isIdentity(kTolerance) &&
      rotation.determinant() > 0.0 && matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1));
  if (!is_rigid) throw InputError("pose: the 4x4 matrix is no rotation and translation");
  Pose pose;
  pose.matrix() = matrix;
  return pose;
}

py::array_t<double> rowsOf(const std::vector<Stamped<Pose>>& trajectory) {
  py::array_t<double> rows({static_cast<py::ssize_t>(trajectory.size()), py::ssize_t{8}});
  auto cells = rows.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    const auto& [time, pose] = trajectory[static_cast<std::size_t>(i)];
    const Eigen::Quaterniond turn = quaternionOf(pose);
    const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
    cells(i, 0) = time;
    for (int k = 0; k < 3; ++k) cells(i, 1 + k) = pose.translation()[k];
    for (int k = 0; k < 4; ++k) cells(i, 4 + k) = sign * turn.coeffs()[k];
  }
  return rows;
}

std::vector<Stamped<Pose>> trajectoryFrom(const Rows& rows, const std::string& name) {
  if (rows.ndim() != 2 || rows.shape(1) != 8) {
    throw InputError(name + ": must be an array (n, 8) of rows time x y z qx qy qz qw");
  }
  const auto cells = rows.unchecked<2>();
  std::vector<Stamped<Pose>> trajectory;
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    const Eigen::Quaterniond turn(cells(i, 7), cells(i, 4), cells(i, 5), cells(i, 6));
    if (!(std::abs(turn.norm() - 1.0) < 1e-3)) {
      throw InputError(name + ": row " + std::to_string(i) + ": not a unit quaternion");
    }
    Pose pose = Pose::Identity();
    pose.linear() = turn.normalized().toRotationMatrix();
    pose.translation() << cells(i, 1), cells(i, 2), cells(i, 3);
    trajectory.push_back({cells(i, 0), pose});
  }
  return trajectory;
}

}  // namespace headway::python
