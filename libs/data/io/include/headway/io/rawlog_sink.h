// SPDX-License-Identifier: BSD-3-Clause
// Writing rawlogs.
#pragma once

#include <headway/core/compression.h>
#include <headway/core/detection.h>
#include <headway/io/raw_camera.h>
#include <mrpt/io/CStream.h>

#include <fstream>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace mrpt::obs {
class CObservation;
class CObservation2DRangeScan;
}  // namespace mrpt::obs

namespace headway::io {

/// Warning of recordings whose images had no times: its name, and the text of a comment in the
/// rawlog.
inline constexpr char kTimesAssumed[] = "times_assumed";
inline constexpr char kTimesAssumedText[] =
    "the images came without times: 10 a second are assumed, so that speeds are guessed; import "
    "them again with --rate HZ or --times FILE";

/// Storage of images.
enum class ImageStorage {
  kEmbedded,      ///< in the rawlog: colour as JPEG, grey raw
  kEmbeddedRaw,   ///< in the rawlog: colour and grey raw
  kExternalPng,   ///< in `X_Images/`, as PNG
  kExternalJpeg,  ///< in `X_Images/`, as JPEG
};

/// A 2D laser scan to record.
struct RecordedScan {
  Time time = 0.0;
  Pose T_robot_laser = Pose::Identity();  ///< x forward, scanning in its xy plane
  double aperture_rad = 0.0;              ///< from the first ray, at the right, to the last
  double max_range_m = 0.0;
  double sigma_m = 0.0;       ///< standard deviation of the ranges
  std::vector<float> ranges;  ///< [m]; 0 where nothing was measured
};

/// The scan as an observation.
[[nodiscard]] std::shared_ptr<mrpt::obs::CObservation2DRangeScan> laserObservation(
    const RecordedScan& scan, const std::string& label);

/// A position and velocity of a satellite receiver to record.
struct RecordedGnss {
  Time time = 0.0;
  Pose T_robot_antenna = Pose::Identity();
  double latitude_deg = 0.0;   ///< WGS 84, north positive
  double longitude_deg = 0.0;  ///< WGS 84, east positive
  double altitude_m = 0.0;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< east, north, up [m/s]
  int satellites = 0;
  double sigma_m = 0.0;  ///< of each horizontal axis; 0: unknown
};

/// Compressed output that reports all write errors, including those of the final flush, which
/// MRPT's CFileGZOutputStream ignores.
class CompressedOutput : public mrpt::io::CStream {
 public:
  /// @param name  of the file in messages; it decides on the compression
  /// @throws InputError if the file cannot be written
  CompressedOutput(const std::string& path, std::string name);

  /// Returns fewer bytes than given only on a write error; hasFailed() is then true.
  size_t Write(const void* buffer, size_t count) override;
  [[nodiscard]] bool hasFailed() const { return file_.fail(); }
  /// Ends the data and the file; hasFailed() then tells whether all was written.
  void finish();
  /// The same. @throws InputError if the data could not be written
  void close();

  size_t Read(void* buffer, size_t count) override;            ///< @throws std::exception always
  uint64_t Seek(int64_t offset, TSeekOrigin origin) override;  ///< @throws std::exception always
  uint64_t getTotalBytesCount() const override { return getPosition(); }
  uint64_t getPosition() const override { return content_.plainSize(); }

 private:
  std::string name_;
  std::ofstream file_;
  Compressor content_;
};

/// Writes an observation-only rawlog, gz-compressed, in the order of the calls.
///
/// The file and its images have temporary names until close() or the destructor, and then replace
/// older ones. After an exception the older ones remain.
///
///     RawlogSink sink("out.rawlog", ImageStorage::kEmbedded);
///     sink.writeStereo(time, left, right, rawFrom(camera));
///     sink.writeDetections("detections", boxes);
class RawlogSink {
 public:
  /// @throws InputError if the file (or its image folder) cannot be written
  RawlogSink(const std::string& path, ImageStorage storage, int jpeg_quality = 90);
  ~RawlogSink();
  RawlogSink(const RawlogSink&) = delete;
  RawlogSink& operator=(const RawlogSink&) = delete;

  /// @param left, right  8-bit grey or BGR, of the camera's sizes
  /// @throws InputError  on a write error such as a full disk
  void writeStereo(Time time, const cv::Mat& left, const cv::Mat& right,
                   const RawStereoCamera& camera, const std::string& label = "stereo");
  /// The intensity image is stored as a pair's images are, the depth image inside the rawlog.
  ///
  /// @param image  8-bit grey or BGR
  /// @param depth  16-bit, 0 where nothing was measured
  void writeDepth(Time time, const cv::Mat& image, const cv::Mat& depth,
                  const RawDepthCamera& camera, const std::string& label = "rgbd");
  /// @param label  `detections` (input of tracking) or `truth_objects`
  void writeDetections(const std::string& label, const Detections& detections);
  /// @param label  `pose` (used instead of SLAM) or `truth_pose`
  void writePose(const std::string& label, Time time, const Pose& T_map_robot);
  /// Wheel odometry: planar robot pose in the odometry frame (x [m], y [m], yaw [rad]).
  void writeOdometry(Time time, double x, double y, double yaw);
  /// Inertial sample in the robot frame.
  void writeImu(Time time, const Eigen::Vector3d& angular_velocity,  // [rad/s]
                const Eigen::Vector3d& acceleration);                // [m/s^2], including gravity
  /// The same of an accelerometer alone.
  void writeAcceleration(Time time, const Eigen::Vector3d& acceleration);
  /// NMEA messages GGA (position) and RMC (speed and course).
  void writeGnss(const RecordedGnss& sample);
  /// Marks the times as assumed: readers warn of it.
  void writeTimesAssumed(Time time);
  void writeLaser(const RecordedScan& scan, const std::string& label = "laser");
  /// Any other observation, as it is: its images are stored inside the rawlog.
  void write(const mrpt::obs::CObservation& observation);
  /// Flushes and closes. @throws InputError on a write error.
  void close();
  /// Removes what was written, as after an exception; older files remain.
  void discard();

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

}  // namespace headway::io
