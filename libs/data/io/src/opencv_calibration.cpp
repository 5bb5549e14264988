// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/camera_info.h>

#include <algorithm>

#include "foreign_calibration.h"

namespace headway::io {
namespace {

/// Names that programs give to the same matrix.
using Names = std::vector<std::string>;

/// Keys in one or several files.
class OpenCvKeys {
 public:
  explicit OpenCvKeys(const std::vector<YamlFile>& files) : files_(files) {}

  struct Found {
    const YamlFile* file = nullptr;
    std::string key;
  };

  [[nodiscard]] std::optional<Found> find(const Names& names) const {
    for (const YamlFile& file : files_) {
      for (const auto& name : names) {
        if (file.has(name)) return Found{&file, name};
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<double> numbers(const Names& names, std::size_t min_size,
                                            std::size_t max_size) const {
    const auto found = find(names);
    if (!found) {
      files_.back().fail("key '" + names.front() + "' is missing" +
                         (files_.size() == 1
                              ? "; if intrinsics and extrinsics are in two files, give both: "
                                "INTRINSICS.yml,EXTRINSICS.yml"
                              : ""));
    }
    return found->file->numbers(found->key, min_size, max_size);
  }

 private:
  const std::vector<YamlFile>& files_;
};

const Names kLeftMatrix = {"M1", "K1", "cameraMatrix1", "camera_matrix_1", "camera_matrix_left"};
const Names kRightMatrix = {"M2", "K2", "cameraMatrix2", "camera_matrix_2", "camera_matrix_right"};
const Names kLeftDistortion = {"D1", "distCoeffs1", "dist_coeffs_1", "distortion_left"};
const Names kRightDistortion = {"D2", "distCoeffs2", "dist_coeffs_2", "distortion_right"};
const Names kTranslation = {"T", "translation"};
const Names kRotation = {"R", "rotation"};
const Names kSize = {"image_size", "imageSize", "img_size", "size"};

RawCamera openCvLens(const OpenCvKeys& keys, const Names& matrix, const Names& distortion,
                     std::array<int, 2> size) {
  CameraInfo info;
  info.width = size[0];
  info.height = size[1];
  const auto K = keys.numbers(matrix, 9, 9);
  std::copy(K.begin(), K.end(), info.K.begin());
  info.D = keys.numbers(distortion, 1, 14);
  const auto fisheye = keys.find({"fisheye_model", "fisheye"});
  const bool is_fisheye = fisheye && fisheye->file->number(fisheye->key) != 0.0;
  info.distortion_model = is_fisheye ? "fisheye" : "rational_polynomial";
  const auto found = keys.find(distortion);
  try {
    return lensFrom(info, ImageKind::kRaw);
  } catch (const InputError& error) {
    found->file->fail("key '" + found->key + "': " + error.what());
  }
}

std::array<int, 2> sizeFrom(const OpenCvKeys& keys, const YamlFile& file,
                            std::array<int, 2> of_images) {
  std::vector<double> values;
  if (const auto size = keys.find(kSize)) {
    values = size->file->numbers(size->key, 2, 2);
  } else if (keys.find({"image_width"})) {
    values = {keys.numbers({"image_width"}, 1, 1)[0], keys.numbers({"image_height"}, 1, 1)[0]};
  } else if (of_images[0] > 0) {
    return of_images;
  }
  if (values.empty())
    file.fail("the size of the images is missing: add image_size: [width, height]");
  if (!(values[0] >= 1.0 && values[0] <= 1e5 && values[1] >= 1.0 && values[1] <= 1e5)) {
    file.fail("key 'image_size' is not a number of pixels");
  }
  return {static_cast<int>(values[0]), static_cast<int>(values[1])};
}

}  // namespace

std::optional<StereoCalibrationFile> readOpenCv(const std::vector<YamlFile>& files,
                                                std::array<int, 2> image_size) {
  const OpenCvKeys keys(files);
  const auto left = keys.find(kLeftMatrix);
  const auto translation = keys.find(kTranslation);
  if (!left && !(translation && keys.find(kRotation))) return std::nullopt;
  StereoCalibrationFile result;
  result.format = "OpenCV";
  const auto size = sizeFrom(keys, files[0], image_size);
  result.camera.left = openCvLens(keys, kLeftMatrix, kLeftDistortion, size);
  result.camera.right = openCvLens(keys, kRightMatrix, kRightDistortion, size);
  const auto right = keys.find(kRightMatrix);
  requireLens(result.camera.left, *left->file, left->key);
  requireLens(result.camera.right, *right->file, right->key);
  const auto R = keys.numbers(kRotation, 9, 9);
  const auto T = keys.numbers(kTranslation, 3, 3);
  Pose T_right_left = Pose::Identity();
  T_right_left.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  T_right_left.translation() = Eigen::Vector3d(T[0], T[1], T[2]);
  const Eigen::Matrix3d turn = T_right_left.linear();
  if (!turn.allFinite() || !(turn * turn.transpose()).isIdentity(1e-3) || turn.determinant() < 0) {
    translation->file->fail("key 'R' is not a rotation");
  }
  requireBaseline(T_right_left, *translation->file, translation->key);
  result.camera.T_left_right = T_right_left.inverse();
  return result;
}

}  // namespace headway::io
