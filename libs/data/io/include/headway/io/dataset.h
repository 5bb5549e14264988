// SPDX-License-Identifier: BSD-3-Clause
// Recordings of public datasets, read frame by frame.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/log.h>
#include <headway/io/rawlog_sink.h>

#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::io {

/// One frame of a dataset.
struct DatasetFrame {
  Time time = 0.0;                          ///< [s]
  cv::Mat left;                             ///< 8-bit grey or BGR; empty: no images
  cv::Mat right;                            ///< as left; empty: a depth camera
  cv::Mat depth;                            ///< of a depth camera, 16-bit; 0: not measured
  std::optional<Pose> T_map_robot;          ///< estimate to use instead of visual SLAM
  std::optional<Pose> truth_T_map_robot;    ///< ground truth
  std::optional<Detections> detections;     ///< input of tracking
  std::optional<Detections> truth_objects;  ///< ground truth, with ids
};

/// One inertial sample in the robot frame.
struct DatasetInertial {
  Time time = 0.0;                                         ///< [s]
  std::optional<Eigen::Vector3d> angular_velocity;         ///< [rad/s]; nullopt: no gyroscope
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s^2], including gravity
};

/// A recording of a public dataset, read frame by frame.
class Dataset {
 public:
  virtual ~Dataset() = default;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// @throws InputError naming the file if an image cannot be read
  [[nodiscard]] virtual DatasetFrame frame(std::size_t index) const = 0;
  /// Camera of all images; nullopt without images.
  [[nodiscard]] virtual std::optional<RawStereoCamera> camera() const = 0;
  /// If the images have depth; camera() is then the left camera alone, without baseline.
  [[nodiscard]] virtual std::optional<RawDepthCamera> depthCamera() const { return std::nullopt; }
  /// In time order; empty if not recorded.
  [[nodiscard]] virtual std::vector<DatasetInertial> inertial() const { return {}; }
  /// In time order; empty if not recorded.
  [[nodiscard]] virtual std::vector<RecordedGnss> gnss() const { return {}; }
  /// Times of images ignored when opening, by reason.
  [[nodiscard]] virtual std::map<std::string, std::vector<Time>> droppedTimes() const { return {}; }
  /// Number of items ignored when opening, by reason: those images, and others.
  [[nodiscard]] virtual std::map<std::string, std::size_t> dropped() const {
    std::map<std::string, std::size_t> counts;
    for (const auto& [reason, times] : droppedTimes()) {
      if (!times.empty()) counts[reason] = times.size();
    }
    return counts;
  }
  /// What was assumed when opening: "times_assumed".
  [[nodiscard]] virtual Warnings warnings() const { return {}; }
};

/// The images of one camera in order: those of a folder, or of a video.
class ImageSequence {
 public:
  virtual ~ImageSequence() = default;
  /// Folder or file, for messages.
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Name of one image, for messages.
  [[nodiscard]] virtual std::string nameOf(std::size_t index) const = 0;
  /// 8-bit grey or BGR. @throws InputError naming the file if it cannot be read
  [[nodiscard]] virtual cv::Mat image(std::size_t index) const = 0;
  /// Of the first images [s]: of all, unless the file of times lacks some; empty if there are none.
  [[nodiscard]] virtual const std::vector<Time>& times() const = 0;
  /// The file of times beside the images, which may lack some; empty: there is none.
  [[nodiscard]] virtual std::string timesFile() const { return ""; }
};

/// Images of a folder (.png .jpg .jpeg .bmp .tif .tiff .pgm .ppm) in the order of their names, with
/// the times of `times.txt` in it or its parent, one a line [s]; without it, of their names, if the
/// last number of each is a Unix time between 2000 and 2100 in s, ms, us or ns, of one unit, and
/// all differ.
///
/// @throws InputError if the folder does not exist
[[nodiscard]] std::unique_ptr<ImageSequence> imagesOfFolder(const std::string& folder);

/// Times of images that are stated apart from them.
struct ImageTimes {
  double rate_hz = 0.0;  ///< 0: not stated
  std::string file;      ///< one time a line [s]; empty: not stated
};

/// Opens a recording in EuRoC's layout (ASL folder) with raw stereo images.
///
/// Reads `FOLDER/mav0/{cam0,cam1}/{sensor.yaml,data.csv,data}`, the inertial samples of
/// `mav0/imu0` if present, and the truth in `FOLDER/groundtruth.tum` or
/// `mav0/state_groundtruth_estimate0/data.csv` (interpolated at the images' times). Images of the
/// two cameras are paired by equal time stamps.
///
/// The robot frame is at the body's origin, with x along the cameras' mean viewing direction and y
/// from the right to the left camera. The true poses are rotated likewise and remain in the
/// dataset's world frame.
///
/// @throws InputError naming the file that is missing or malformed
[[nodiscard]] std::unique_ptr<Dataset> openEuroc(const std::string& folder);

/// Opens two sequences of images with a calibration file.
///
/// Times are those of `times`, else those that the calibration states (`times`, a file in its
/// folder, or `frame_rate_hz`), else those of the images, else 10 Hz with the warning
/// "times_assumed". Images that have times of their own on both sides are paired by time, at most
/// 10 ms apart, others by order, and then both sides must have the same number.
///
/// @param right        null: the left images contain both, side by side
/// @param calibration  see readStereoCalibration()
/// @throws InputError naming the file that is missing or inconsistent
[[nodiscard]] std::unique_ptr<Dataset> openStereoImages(std::unique_ptr<ImageSequence> left,
                                                        std::unique_ptr<ImageSequence> right,
                                                        const std::string& calibration,
                                                        const ImageTimes& times = {});

/// The same of two folders.
[[nodiscard]] std::unique_ptr<Dataset> openImageFolders(const std::string& left_folder,
                                                        const std::string& right_folder,
                                                        const std::string& calibration,
                                                        const ImageTimes& times = {});

/// Opens two folders: images, and depth images (PNG, 16 bits), with times and pairs as above, at
/// most 20 ms apart.
///
/// @param calibration  of a depth camera (doc/formats.md)
/// @throws InputError naming the file that is missing or inconsistent
[[nodiscard]] std::unique_ptr<Dataset> openDepthFolders(const std::string& left_folder,
                                                        const std::string& depth_folder,
                                                        const std::string& calibration,
                                                        const ImageTimes& times = {});

/// Opens a sequence of the TUM RGB-D benchmark.
///
/// Reads `FOLDER/{rgb.txt,depth.txt}` with the images they list, and the truth in
/// `FOLDER/groundtruth.txt` if present. Each image gets the depth image nearest in time, at most
/// 20 ms away; others are counted. The robot frame is at the camera; true poses remain in the
/// dataset's world frame. The samples of `FOLDER/accelerometer.txt`, if present, are in the axes of
/// the Kinect's accelerometer: x left, y up, z forward.
///
/// @param calibration  of a depth camera; empty: the published one of the camera that the folder is
///                     named after (freiburg1, freiburg2, freiburg3), else f = 525 px
/// @throws InputError naming the file that is missing or malformed
[[nodiscard]] std::unique_ptr<Dataset> openTumRgbd(const std::string& folder,
                                                   const std::string& calibration);

/// Opens a sequence of the KITTI odometry benchmark (rectified).
///
/// Reads `FOLDER/sequences/SEQUENCE/{calib.txt,times.txt,image_0,image_1}`, colour `image_2` and
/// `image_3` if there is no `image_0`, and the truth in `FOLDER/poses/SEQUENCE.txt` or
/// `FOLDER/sequences/SEQUENCE/poses.txt` if present. Without times.txt the frame interval is 0.1 s.
/// Frames with only one image are ignored. The robot frame is at camera 0.
///
/// @throws InputError naming the file that is missing or malformed
[[nodiscard]] std::unique_ptr<Dataset> openKittiOdometry(const std::string& folder,
                                                         const std::string& sequence);

/// Source of the true path of a KITTI raw drive.
enum class OxtsPath {
  kPositions,   ///< positions of the GNSS and inertial unit; locally they deviate by up to 0.5 m
  kVelocities,  ///< its integrated velocities, without those jumps
};

/// Parses "positions" or "velocities". @throws InputError for other names
[[nodiscard]] OxtsPath oxtsPathFrom(const std::string& name);

/// Opens a rectified ("sync") drive of the KITTI raw data.
///
/// Reads `FOLDER/DATE/DRIVE/{image_00,image_01}/{data,timestamps.txt}` and
/// `FOLDER/DATE/calib_{cam_to_cam,velo_to_cam,imu_to_velo}.txt`, DATE being the first 10 characters
/// of DRIVE; if present, `oxts` (true poses at the images' times, GNSS and inertial samples) and
/// `tracklet_labels.xml` (true objects, in rectified camera 0). Images of the two cameras are
/// paired by their numbers. The robot frame is at camera 0; the map is level, its origin and
/// heading are those of the first frame.
///
/// @throws InputError naming the file that is missing or malformed
[[nodiscard]] std::unique_ptr<Dataset> openKittiRaw(const std::string& folder,
                                                    const std::string& drive, OxtsPath path);

/// Source of the boxes of a KITTI tracking sequence.
enum class KittiBoxes {
  kLabels,       ///< `label_02`: ground truth
  kPointRcnn3d,  ///< `det3d_pointrcnn/CLASS`: 3D boxes of a lidar network
  kRrc2d,        ///< `det2d_rrc/CLASS`: 2D boxes of an image network
};

/// Parses "label_02", "det3d_pointrcnn" or "det2d_rrc". @throws InputError for other names
[[nodiscard]] KittiBoxes kittiBoxesFrom(const std::string& name);

/// Opens a sequence of the KITTI tracking benchmark without images, 0.1 s per frame.
///
/// Reads `FOLDER/training/{pose_orbslam3,label_02}/SEQUENCE.txt` and the boxes. The poses of
/// camera 0 are estimates of a stereo system, therefore `pose` and not truth. 3D boxes are in
/// rectified camera 0, which is also the origin of the robot frame; 2D boxes are in camera 2's
/// image. The truth is `label_02` without DontCare.
///
/// @throws InputError naming the file that is missing or malformed
[[nodiscard]] std::unique_ptr<Dataset> openKittiTracking(const std::string& folder,
                                                         const std::string& sequence,
                                                         KittiBoxes boxes);

/// Opens a sequence of the KITTI tracking benchmark with the images of its raw drive.
///
/// The frames are those of the drive, as openKittiRaw() reads it, with `truth_pose` and without
/// `pose`; labels and boxes belong to the image of their number. 2D boxes of labels and boxes with
/// a 3D box are moved from camera 2's image to that of camera 0.
///
/// @param drive  folder of the drive, in the folder with its calibration
/// @param boxes  nullopt: no `detections`
/// @throws InputError as openKittiRaw(), or if the drive's camera is not that of
///         `training/calib/SEQUENCE.txt`, or an image is missing before the last one
[[nodiscard]] std::unique_ptr<Dataset> openKittiTracking(const std::string& folder,
                                                         const std::string& sequence,
                                                         std::optional<KittiBoxes> boxes,
                                                         const std::string& drive, OxtsPath path);

/// The matrices of a KITTI calibration file ("P0: " and 12 numbers, row-major), by name.
///
/// @throws InputError naming file and line of an error
[[nodiscard]] std::map<std::string, Eigen::Matrix<double, 3, 4>> readKittiProjections(
    const std::string& path);

}  // namespace headway::io
