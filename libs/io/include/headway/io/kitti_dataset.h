#pragma once

#include <headway/io/dataset.h>

namespace headway::io {

/// A sequence of KITTI's odometry benchmark (rectified).
///
/// Reads `FOLDER/sequences/SEQUENCE/{calib.txt,times.txt,image_0,image_1}`, colour `image_2` and
/// `image_3` where there is no `image_0`, and the truth in `FOLDER/poses/SEQUENCE.txt` or
/// `FOLDER/sequences/SEQUENCE/poses.txt` where there is one. Without times.txt a frame takes 0.1 s.
/// Frames are those whose two images are there. The robot frame stands in camera 0.
///
/// @throws InputError naming the file that is missing or cannot be understood
[[nodiscard]] std::unique_ptr<Dataset> openKittiOdometry(const std::string& folder,
                                                         const std::string& sequence);

/// Where the boxes of a KITTI tracking sequence come from.
enum class KittiBoxes {
  kLabels,       ///< `label_02`: ground truth
  kPointRcnn3d,  ///< `det3d_pointrcnn/CLASS`: a lidar network
  kRrc2d,        ///< `det2d_rrc/CLASS`: an image network, no 3D
};

/// "label_02", "det3d_pointrcnn" or "det2d_rrc". @throws InputError naming them for any other word
[[nodiscard]] KittiBoxes kittiBoxesFrom(const std::string& name);

/// A sequence of KITTI's tracking benchmark, without its images, 0.1 s a frame.
///
/// Reads `FOLDER/training/{pose_orbslam3,label_02}/SEQUENCE.txt` and the boxes. The poses are those
/// of camera 0 as a stereo system estimated them, so they are `pose` and not truth. 3D boxes are in
/// rectified camera 0, where the robot frame stands with turned axes; 2D boxes are in camera 2's
/// image. Objects of `label_02` are the truth, DontCare left out.
///
/// @throws InputError naming the file that is missing or cannot be understood
[[nodiscard]] std::unique_ptr<Dataset> openKittiTracking(const std::string& folder,
                                                         const std::string& sequence,
                                                         KittiBoxes boxes);

/// The matrices of a KITTI calibration file ("P0: " and 12 numbers, row by row), by name.
///
/// @throws InputError naming file and line of what cannot be read
[[nodiscard]] std::map<std::string, Eigen::Matrix<double, 3, 4>> readKittiProjections(
    const std::string& path);

}  // namespace headway::io
