// SPDX-License-Identifier: BSD-3-Clause
// KITTI's raw data: a drive's images, true path, sensors and labelled objects.
#pragma once

#include <headway/io/dataset.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kitti_odometry.h"

namespace headway::io {

/// Contents of a KITTI raw drive, without pixels and labelled objects.
struct KittiRawDrive {
  struct Frame {
    Time time = 0.0;  ///< of the left image
    KittiImagePair images;
    std::optional<Pose> truth_T_map_robot;

    /// Time, pixels and true pose. @throws InputError naming an image that cannot be read
    [[nodiscard]] DatasetFrame load() const;
  };
  std::vector<Frame> frames;
  RawStereoCamera camera;
  std::vector<DatasetInertial> inertial;
  std::vector<RecordedGnss> gnss;
  Pose T_cam_velo = Pose::Identity();  ///< lidar frame in rectified camera 0
  std::map<std::string, std::size_t> dropped;
};

/// Reads `image_00`, `image_01` and `oxts` of a drive's folder, and the calibration in its parent
/// folder.
///
/// @throws InputError naming the file that is missing or malformed
[[nodiscard]] KittiRawDrive readKittiRawDrive(const std::filesystem::path& folder, OxtsPath path);

}  // namespace headway::io
