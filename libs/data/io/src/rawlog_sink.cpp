// SPDX-License-Identifier: BSD-3-Clause
// Writing rawlogs.
#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/core/output_file.h>
#include <headway/io/detection_observation.h>
#include <headway/io/gnss_fix.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/raw_camera.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/core/exceptions.h>
#include <mrpt/img/CImage.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "text_rows.h"

namespace headway::io {

namespace fs = std::filesystem;

CompressedOutput::CompressedOutput(const std::string& path, std::string name)
    : name_(std::move(name)),
      file_(path, std::ios::binary),
      content_(file_, fs::path(name_).extension() == ".zst" ? Compression::kZstandard
                                                            : Compression::kGzip) {
  if (!file_) {
    throw InputError(name_ + ": cannot be written; check that its folder exists and is writable");
  }
}

size_t CompressedOutput::Write(const void* buffer, size_t count) {
  content_.write({static_cast<const char*>(buffer), count});
  return hasFailed() ? 0 : count;
}

void CompressedOutput::finish() {
  content_.finish();
  file_.close();
}

void CompressedOutput::close() {
  finish();
  if (hasFailed()) throw InputError(name_ + ": not written completely; check the disk space");
}

size_t CompressedOutput::Read(void* /*buffer*/, size_t /*count*/) {
  THROW_EXCEPTION("cannot be read");
}

uint64_t CompressedOutput::Seek(int64_t /*offset*/, TSeekOrigin /*origin*/) {
  THROW_EXCEPTION("has no random access");
}

namespace {

constexpr double kMetresPerSecondPerKnot = 1852.0 / 3600.0;

/// Enables JPEG compression of embedded colour images during its lifetime; MRPT's setting is
/// global.
class JpegSerialization {
 public:
  JpegSerialization(bool enable, int quality)
      : was_disabled_(mrpt::img::CImage::DISABLE_JPEG_COMPRESSION()),
        old_quality_(mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY()) {
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(!enable);
    mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(quality);
  }
  ~JpegSerialization() {
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(was_disabled_);
    mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(old_quality_);
  }
  JpegSerialization(const JpegSerialization&) = delete;
  JpegSerialization& operator=(const JpegSerialization&) = delete;

 private:
  bool was_disabled_;
  int old_quality_;
};

/// The label with characters replaced that are invalid in file names.
std::string fileNameOf(std::string label) {
  for (char& c : label) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-') c = '_';
  }
  return label;
}

/// Images beside a rawlog: LABEL_left_NNNNNN.png and the like.
bool isStoredImage(const fs::path& file) {
  const std::string name = file.stem().string();
  const std::size_t end = name.size() < 7 ? 0 : name.size() - 7;
  const bool is_numbered = end > 0 && name[end] == '_' &&
                           name.find_first_not_of("0123456789", end + 1) == std::string::npos;
  const std::string label = name.substr(0, end);
  const bool is_image = file.extension() == ".png" || file.extension() == ".jpg";
  return is_image && is_numbered && (endsWith(label, "_left") || endsWith(label, "_right"));
}

void writeImage(const fs::path& path, const std::vector<unsigned char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw InputError(path.string() + ": not written completely; check the disk space");
}

}  // namespace

class RawlogSink::Writer {
 public:
  Writer(const std::string& path, ImageStorage storage, int jpeg_quality)
      : path_(path),
        storage_(storage),
        jpeg_quality_(jpeg_quality),
        file_(path),
        content_(file_.temporaryPath().string(), path) {
    registerClasses();
    if (isExternal()) makeImageFolder();
  }

  /// Completes the rawlog unless an exception is the reason.
  ~Writer() {
    try {
      if (std::uncaught_exceptions() == exceptions_) close();
    } catch (const std::exception&) {  // errors are reported by close()
    }
    std::error_code ignored;
    if (!images_while_writing_.empty()) fs::remove_all(images_while_writing_, ignored);
  }

  void write(const mrpt::obs::CObservation& observation) {
    const JpegSerialization jpeg(storage_ == ImageStorage::kEmbedded, jpeg_quality_);
    auto archive = mrpt::serialization::archiveFrom(content_);
    try {
      archive << observation;
    } catch (const std::exception&) {
      if (!content_.hasFailed()) throw;
      throw InputError(path_ + ": write error; check the disk space");
    }
  }

  void close() {
    if (is_closed_) return;
    is_closed_ = true;
    content_.close();
    if (isExternal()) replaceFiles(images_while_writing_, image_folder_, isStoredImage);
    file_.commit();
  }

  /// Leaves all files under their temporary names, which their owners remove.
  void discard() { is_closed_ = true; }

  /// The image to store in the rawlog: embedded, or a reference to an external file.
  mrpt::img::CImage stored(const cv::Mat& image, const std::string& label, const char* side) {
    if (!isExternal()) return {image, mrpt::img::SHALLOW_COPY};
    const bool is_png = storage_ == ImageStorage::kExternalPng;
    const std::string name =
        fileNameOf(label) + "_" + side + formatted("_%06zu", pairs_) + (is_png ? ".png" : ".jpg");
    std::vector<unsigned char> bytes;
    cv::imencode(is_png ? ".png" : ".jpg", image, bytes,
                 is_png ? std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 1}
                        : std::vector<int>{cv::IMWRITE_JPEG_QUALITY, jpeg_quality_});
    writeImage(images_while_writing_ / name, bytes);
    mrpt::img::CImage result;
    result.setExternalStorage(name);
    return result;
  }

  void countPair() { ++pairs_; }

 private:
  [[nodiscard]] bool isExternal() const {
    return storage_ == ImageStorage::kExternalPng || storage_ == ImageStorage::kExternalJpeg;
  }

  void makeImageFolder() {
    const fs::path parent = fs::path(path_).parent_path();
    const std::string name = fs::path(rawlogStem(path_)).filename().string() + "_Images";
    image_folder_ = parent / name;
    if (fs::exists(image_folder_) && !fs::is_directory(image_folder_)) {
      throw InputError(image_folder_.string() + ": cannot be made: a file of that name exists");
    }
    std::string folder = parent / (".partial-" + name + "-XXXXXX");
    if (mkdtemp(folder.data()) == nullptr) {  // new, and for its owner alone
      const std::string cause = std::generic_category().message(errno);
      throw InputError(image_folder_.string() + ": cannot be made: " + cause);
    }
    images_while_writing_ = folder;
  }

  std::string path_;
  ImageStorage storage_;
  int jpeg_quality_;
  OutputFile file_;
  CompressedOutput content_;  ///< of file_
  fs::path image_folder_;
  fs::path images_while_writing_;
  std::size_t pairs_ = 0;
  bool is_closed_ = false;
  int exceptions_ = std::uncaught_exceptions();
};

RawlogSink::RawlogSink(const std::string& path, ImageStorage storage, int jpeg_quality)
    : writer_(std::make_unique<Writer>(path, storage, jpeg_quality)) {}

RawlogSink::~RawlogSink() = default;

void RawlogSink::writeStereo(Time time, const cv::Mat& left, const cv::Mat& right,
                             const RawStereoCamera& camera, const std::string& label) {
  mrpt::obs::CObservationStereoImages observation;
  observation.timestamp = mrptTime(time);
  observation.sensorLabel = label;
  observation.imageLeft = writer_->stored(left, label, "left");
  observation.imageRight = writer_->stored(right, label, "right");
  observation.hasImageRight = true;
  setCalibration(camera, observation);
  writer_->write(observation);
  writer_->countPair();
}

void RawlogSink::writeDepth(Time time, const cv::Mat& image, const cv::Mat& depth,
                            const RawDepthCamera& camera, const std::string& label) {
  auto observation = depthObservation(writer_->stored(image, label, "left"), depth, camera);
  observation->timestamp = mrptTime(time);
  observation->sensorLabel = label;
  writer_->write(*observation);
  writer_->countPair();
}

void RawlogSink::writeDetections(const std::string& label, const Detections& detections) {
  writer_->write(*observationFrom(label, detections));
}

void RawlogSink::writePose(const std::string& label, Time time, const Pose& T_map_robot) {
  mrpt::obs::CObservationRobotPose observation;
  observation.timestamp = mrptTime(time);
  observation.sensorLabel = label;
  observation.pose.mean = toMrpt(T_map_robot);
  writer_->write(observation);
}

void RawlogSink::writeOdometry(Time time, double x, double y, double yaw) {
  mrpt::obs::CObservationOdometry observation;
  observation.timestamp = mrptTime(time);
  observation.sensorLabel = "odometry";
  observation.odometry = mrpt::poses::CPose2D(x, y, yaw);
  writer_->write(observation);
}

namespace {

mrpt::obs::CObservationIMU accelerationAt(Time time, const Eigen::Vector3d& acceleration) {
  mrpt::obs::CObservationIMU observation;
  observation.timestamp = mrptTime(time);
  observation.sensorLabel = "imu";
  observation.set(mrpt::obs::IMU_X_ACC, acceleration.x());
  observation.set(mrpt::obs::IMU_Y_ACC, acceleration.y());
  observation.set(mrpt::obs::IMU_Z_ACC, acceleration.z());
  return observation;
}

}  // namespace

void RawlogSink::writeImu(Time time, const Eigen::Vector3d& angular_velocity,
                          const Eigen::Vector3d& acceleration) {
  auto observation = accelerationAt(time, acceleration);
  observation.set(mrpt::obs::IMU_WX, angular_velocity.x());
  observation.set(mrpt::obs::IMU_WY, angular_velocity.y());
  observation.set(mrpt::obs::IMU_WZ, angular_velocity.z());
  writer_->write(observation);
}

void RawlogSink::writeAcceleration(Time time, const Eigen::Vector3d& acceleration) {
  writer_->write(accelerationAt(time, acceleration));
}

void RawlogSink::writeTimesAssumed(Time time) {
  mrpt::obs::CObservationComment observation;
  observation.timestamp = mrptTime(time);
  observation.text = kTimesAssumedText;
  writer_->write(observation);
}

void RawlogSink::writeGnss(const RecordedGnss& sample) {
  mrpt::obs::CObservationGPS observation;
  observation.timestamp = mrptTime(sample.time);
  observation.sensorLabel = "gnss";
  observation.sensorPose = toMrpt(sample.T_robot_antenna);
  mrpt::obs::gnss::Message_NMEA_GGA position;
  position.fields.latitude_degrees = sample.latitude_deg;
  position.fields.longitude_degrees = sample.longitude_deg;
  position.fields.altitude_meters = sample.altitude_m;
  position.fields.fix_quality = 1;
  position.fields.satellitesUsed = static_cast<uint32_t>(std::max(sample.satellites, 0));
  position.fields.thereis_HDOP = sample.sigma_m > 0.0;
  position.fields.HDOP = static_cast<float>(hdopOf(1, sample.sigma_m).value_or(0.0));
  observation.setMsg(position);
  mrpt::obs::gnss::Message_NMEA_RMC motion;
  motion.fields.validity_char = 'A';
  motion.fields.latitude_degrees = sample.latitude_deg;
  motion.fields.longitude_degrees = sample.longitude_deg;
  const auto& v = sample.velocity;
  motion.fields.speed_knots = std::hypot(v.x(), v.y()) / kMetresPerSecondPerKnot;
  const double course = std::atan2(v.x(), v.y()) * 180.0 / M_PI;  // clockwise from north
  motion.fields.direction_degrees = course < 0.0 ? course + 360.0 : course;
  observation.setMsg(motion);
  writer_->write(observation);
}

void RawlogSink::writeLaser(const RecordedScan& scan, const std::string& label) {
  writer_->write(*laserObservation(scan, label));
}

std::shared_ptr<mrpt::obs::CObservation2DRangeScan> laserObservation(const RecordedScan& scan,
                                                                     const std::string& label) {
  auto observation = mrpt::obs::CObservation2DRangeScan::Create();
  observation->timestamp = mrptTime(scan.time);
  observation->sensorLabel = label;
  observation->sensorPose = toMrpt(scan.T_robot_laser);
  observation->aperture = static_cast<float>(scan.aperture_rad);
  observation->rightToLeft = true;
  observation->maxRange = static_cast<float>(scan.max_range_m);
  observation->stdError = static_cast<float>(scan.sigma_m);
  observation->resizeScan(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    observation->setScanRange(i, scan.ranges[i]);
    observation->setScanRangeValidity(i, scan.ranges[i] > 0.0F);
  }
  return observation;
}

void RawlogSink::write(const mrpt::obs::CObservation& observation) { writer_->write(observation); }

void RawlogSink::close() { writer_->close(); }

void RawlogSink::discard() { writer_->discard(); }

}  // namespace headway::io
