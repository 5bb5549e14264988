// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_poses.h"

namespace headway::io {
namespace {

mrpt::poses::CPose3DQuat quaternionPose(ObjectReader& in) {
  mrpt::poses::CPose3DQuat pose;
  for (unsigned i = 0; i < 7; ++i) pose[i] = in.value<double>();
  return pose;
}

/// Versions 0 and 1: a homogeneous matrix.
mrpt::poses::CPose3D matrixPose(ObjectReader& in) {
  const auto values = in.matrix(4, 4);
  mrpt::math::CMatrixDouble44 matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = values[static_cast<std::size_t>(i)];
  return mrpt::poses::CPose3D(matrix);
}

/// Version 3: position, then the rotation matrix.
mrpt::poses::CPose3D rotationPose(ObjectReader& in) {
  auto matrix = mrpt::math::CMatrixDouble44::Identity();
  for (int row = 0; row < 3; ++row) matrix(row, 3) = in.value<double>();
  for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = in.value<double>();
  return mrpt::poses::CPose3D(matrix);
}

}  // namespace

mrpt::poses::CPose2D readPose2D(ObjectReader& in) {
  const auto version = in.enter("CPose2D", 1);
  double values[3];
  for (double& one : values) {
    one = version == 0 ? static_cast<double>(in.value<float>()) : in.value<double>();
  }
  in.leave();
  return {values[0], values[1], values[2]};
}

mrpt::poses::CPose3D readPose3D(ObjectReader& in) {
  const auto version = in.enter("CPose3D", 3);
  mrpt::poses::CPose3D pose = version <= 1   ? matrixPose(in)
                              : version == 2 ? mrpt::poses::CPose3D(quaternionPose(in))
                                             : rotationPose(in);
  in.leave();
  return pose;
}

mrpt::poses::CPose3DQuat readPoseQuat(ObjectReader& in) {
  (void)in.enter("CPose3DQuat", 0);
  const auto pose = quaternionPose(in);
  in.leave();
  return pose;
}

/// The covariance follows the mean: its diagonal, then the upper triangle by rows.
mrpt::poses::CPose3DPDFGaussian readPosePdf(ObjectReader& in) {
  const int version = in.enter({"CPose3DPDFGaussian"});
  if (version != 1) throw UnknownVersion("CPose3DPDFGaussian", version);
  mrpt::poses::CPose3DPDFGaussian pdf;
  pdf.mean = readPose3D(in);
  for (int i = 0; i < 6; ++i) pdf.cov(i, i) = in.value<double>();
  for (int row = 0; row < 5; ++row) {
    for (int column = row + 1; column < 6; ++column) {
      pdf.cov(row, column) = pdf.cov(column, row) = in.value<double>();
    }
  }
  in.leave();
  return pdf;
}

void setIntrinsics(mrpt::img::TCamera& camera, const std::vector<double>& matrix) {
  camera.setIntrinsicParamsFromValues(matrix[0], matrix[4], matrix[2], matrix[5]);
}

mrpt::img::TCamera readCamera(ObjectReader& in) {
  const auto version = in.enter("TCamera", 6);
  mrpt::img::TCamera camera;
  camera.focalLengthMeters = in.value<double>();
  camera.dist.fill(0.0);
  const std::size_t coefficients = version >= 3 ? 8 : 5;
  for (std::size_t i = 0; i < coefficients; ++i) camera.dist[i] = in.value<double>();
  if (version >= 4) {
    double values[4];
    for (double& one : values) one = in.value<double>();
    camera.setIntrinsicParamsFromValues(values[0], values[1], values[2], values[3]);
  } else {
    setIntrinsics(camera, in.matrix(3, 3));
  }
  if (version == 0) (void)in.matrix(1, 5);
  camera.nrows = 480;  // versions 0 and 1 do not store the size
  camera.ncols = 640;
  if (version >= 2) {
    camera.nrows = in.value<std::uint32_t>();
    camera.ncols = in.value<std::uint32_t>();
  }
  if (version >= 5) camera.cameraName = in.text();
  camera.distortion = mrpt::img::DistortionModel::plumb_bob;
  if (version >= 6) {
    const auto model = in.value<std::uint8_t>();
    if (model > static_cast<std::uint8_t>(mrpt::img::DistortionModel::kannala_brandt)) {
      throw BrokenObject("a camera has an unknown distortion model");
    }
    camera.distortion = static_cast<mrpt::img::DistortionModel>(model);
  }
  in.leave();
  return camera;
}

}  // namespace headway::io
