// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of the readers of public datasets; the first byte selects the file that the
// input replaces in one of the recordings.
#include <headway/core/error.h>
#include <headway/io/dataset.h>

#include <cstddef>
#include <cstdint>

#include "file_tree.h"
#include "yaml_parsers.h"

namespace {

using namespace headway;

constexpr char kDrive[] = "2011_09_26_drive_0001_sync";
const std::string kDrivePath = std::string("2011_09_26/") + kDrive;

/// Two frames of each layout, with images of 16 x 12 pixels.
test::FileTree makeRecordings() {
  test::FileTree tree("dataset_files");
  for (const std::string& name :
       std::vector<std::string>{"euroc/mav0/cam0/sensor.yaml",
                                "euroc/mav0/cam1/sensor.yaml",
                                "euroc/mav0/imu0/sensor.yaml",
                                "euroc/mav0/cam0/data.csv",
                                "euroc/mav0/cam1/data.csv",
                                "euroc/mav0/imu0/data.csv",
                                "euroc/mav0/state_groundtruth_estimate0/data.csv",
                                "odometry/sequences/07/calib.txt",
                                "odometry/sequences/07/times.txt",
                                "odometry/poses/07.txt",
                                "tracking/training/pose_orbslam3/0001.txt",
                                "tracking/training/label_02/0001.txt",
                                "tracking/training/det3d_pointrcnn/Car/0001.txt",
                                "tracking/training/det2d_rrc/Car/0001.txt",
                                "2011_09_26/calib_cam_to_cam.txt",
                                "2011_09_26/calib_velo_to_cam.txt",
                                "2011_09_26/calib_imu_to_velo.txt",
                                kDrivePath + "/image_00/timestamps.txt",
                                kDrivePath + "/oxts/timestamps.txt",
                                kDrivePath + "/oxts/data/0000000001.txt",
                                kDrivePath + "/tracklet_labels.xml",
                                "images/calibration.yaml",
                                "images/times.txt",
                                "tum/rgb.txt",
                                "tum/depth.txt",
                                "tum/groundtruth.txt",
                                "depth/calibration.yaml",
                                "depth/depth/0000000000.png"}) {
    tree.addSeed(name);
  }
  tree.add(kDrivePath + "/oxts/data/0000000000.txt",
           tree.seed(kDrivePath + "/oxts/data/0000000001.txt"));
  const std::string image = "P5\n16 12\n255\n" + std::string(192, 'x');
  for (const std::string& folder :
       std::vector<std::string>{"euroc/mav0/cam0/data/", "euroc/mav0/cam1/data/",
                                "odometry/sequences/07/image_0/", "odometry/sequences/07/image_1/",
                                kDrivePath + "/image_00/data/", kDrivePath + "/image_01/data/",
                                "images/left/", "images/right/", "depth/left/", "tum/rgb/"}) {
    for (const char* name : {"0000000000.png", "0000000001.png"}) tree.add(folder + name, image);
  }
  const std::string depth = tree.seed("depth/depth/0000000000.png");
  for (const char* name :
       {"depth/depth/0000000001.png", "tum/depth/0000000000.png", "tum/depth/0000000001.png"}) {
    tree.add(name, depth);
  }
  return tree;
}

std::unique_ptr<io::Dataset> openFor(const std::string& file, const std::string& root) {
  if (file.rfind("euroc", 0) == 0) return io::openEuroc(root + "/euroc");
  if (file.rfind("odometry", 0) == 0) return io::openKittiOdometry(root + "/odometry", "07");
  if (file.rfind("tracking", 0) == 0) {
    const bool is_flat = file.find("det2d") != file.npos;
    return io::openKittiTracking(root + "/tracking", "0001",
                                 is_flat ? io::KittiBoxes::kRrc2d : io::KittiBoxes::kPointRcnn3d);
  }
  if (file.rfind("images", 0) == 0) {
    return io::openImageFolders(root + "/images/left", root + "/images/right",
                                root + "/images/calibration.yaml");
  }
  const std::string depth_camera = root + "/depth/calibration.yaml";
  if (file.rfind("tum", 0) == 0) return io::openTumRgbd(root + "/tum", depth_camera);
  if (file.rfind("depth", 0) == 0) {
    return io::openDepthFolders(root + "/depth/left", root + "/depth/depth", depth_camera);
  }
  return io::openKittiRaw(root, kDrive, io::OxtsPath::kPositions);
}

void readAll(const io::Dataset& dataset) {
  for (std::size_t i = 0; i < dataset.size(); ++i) (void)dataset.frame(i);
  (void)dataset.camera();
  (void)dataset.depthCamera();
  (void)dataset.inertial();
  (void)dataset.gnss();
  (void)dataset.dropped();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static test::FileTree recordings = makeRecordings();
  const auto replaced = recordings.replace(data[0], data + 1, size - 1);
  try {
    readAll(*openFor(replaced.name(), recordings.path().string()));
  } catch (const InputError&) {  // expected of most inputs
  }
  test::freeYamlParsers();
  return 0;
}
