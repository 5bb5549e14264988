// SPDX-License-Identifier: BSD-3-Clause
// Reading the observations of a rawlog within bounds, which is why 890 mutated rawlogs cost no
// memory and no crash.
#include "observation_stream.h"

#include <headway/core/error.h>
#include <headway/core/worker_thread.h>
#include <headway/io/detection_observation.h>
#include <headway/io/gnss_fix.h>
#include <headway/io/rawlog_sink.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/rtti/CObject.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <string>
#include <unordered_set>

#include "image_files.h"
#include "object_reader.h"
#include "recorded_depth.h"

namespace headway::io {
namespace {

// See ObjectReader: each class is read here as MRPT 2.5.8 reads it, and not by MRPT, which
// allocates what a length asks for.

constexpr std::size_t kMaxBeams = 1 << 20;       // of a laser scan
constexpr std::size_t kMaxDetections = 1 << 16;  // in one image
constexpr double kDefaultFocalLengthM = 0.002;   // of cameras that do not store it

using mrpt::obs::gnss::Message_NMEA_GGA;
using Version = std::uint8_t;
using Observation = mrpt::obs::CObservation::Ptr;

Version versionUpTo(Version max_version, ObjectReader& in) {
  const auto version = in.value<Version>();
  if (version > max_version) throw UnknownVersion("", version);
  return version;
}

mrpt::poses::CPose3DQuat readStereoPose(Version version, ObjectReader& in) {
  return version >= 5 ? readPoseQuat(in) : mrpt::poses::CPose3DQuat(readPose3D(in));
}

Observation readStereoImages(ObjectReader& in) {
  const Version version = versionUpTo(6, in);
  auto stereo = mrpt::obs::CObservationStereoImages::Create();
  stereo->cameraPose = readStereoPose(version, in);
  if (version >= 5) {
    stereo->leftCamera = readCamera(in);
    stereo->rightCamera = readCamera(in);
  } else {
    setIntrinsics(stereo->leftCamera, in.matrix(3, 3));
    stereo->rightCamera = stereo->leftCamera;
  }
  const RecordedImage left = readImage(in);
  stereo->hasImageDisparity = version >= 6 && in.flag();
  stereo->hasImageRight = version < 6 || in.flag();
  RecordedImage right;
  if (stereo->hasImageRight) right = readImage(in);
  if (stereo->hasImageDisparity) (void)readImage(in);  // not used
  stereo->hasImageDisparity = false;
  stereo->timestamp = version >= 1 ? in.time() : INVALID_TIMESTAMP;
  stereo->rightCameraPose.x(0.1);  // version 0 and 1
  if (version >= 2) stereo->rightCameraPose = readStereoPose(version, in);
  if (version < 5) {
    const double focal = version >= 3 ? in.value<double>() : kDefaultFocalLengthM;
    stereo->leftCamera.focalLengthMeters = stereo->rightCamera.focalLengthMeters = focal;
  }
  if (version >= 4) stereo->sensorLabel = in.text();
  in.leave();
  stereo->imageLeft = mrptImage(left, in);
  stereo->imageRight = mrptImage(right, in);
  return stereo;
}

/// Camera parameters of versions 0 to 3: matrices of distortion and of intrinsic parameters. MRPT
/// 2.5.8 reads the former, but leaves the distortion model at none.
mrpt::img::TCamera oldCamera(ObjectReader& in) {
  mrpt::img::TCamera camera;
  const auto distortion = in.matrix(0, 0);
  if (distortion.size() == 5) {
    camera.setDistortionPlumbBob(distortion[0], distortion[1], distortion[2], distortion[3],
                                 distortion[4]);
  }
  setIntrinsics(camera, in.matrix(3, 3));
  return camera;
}

Observation readSingleImage(ObjectReader& in) {
  const Version version = versionUpTo(4, in);
  auto single = mrpt::obs::CObservationImage::Create();
  single->cameraPose = readPose3D(in);
  single->cameraParams = version >= 4 ? readCamera(in) : oldCamera(in);
  const RecordedImage image = readImage(in);
  single->timestamp = version >= 1 ? in.time() : INVALID_TIMESTAMP;
  if (version < 2) single->cameraParams.focalLengthMeters = kDefaultFocalLengthM;
  if (version == 2 || version == 3) single->cameraParams.focalLengthMeters = in.value<double>();
  if (version >= 3) single->sensorLabel = in.text();
  in.leave();
  single->image = mrptImage(image, in);
  return single;
}

Observation readImu(ObjectReader& in) {
  const Version version = versionUpTo(4, in);
  auto imu = mrpt::obs::CObservationIMU::Create();
  imu->sensorPose = readPose3D(in);
  const std::size_t size = imu->rawMeasurements.size();
  const auto present =
      version >= 4 ? in.values<std::uint8_t>(size, size) : in.vector<std::uint8_t>(size);
  imu->timestamp = in.time();
  std::vector<double> values;
  if (version == 0) {
    const auto floats = in.vector<float>(size);
    values.assign(floats.begin(), floats.end());
  } else {
    values = version >= 4 ? in.values<double>(size, size) : in.vector<double>(size);
  }
  imu->dataIsPresent.fill(false);
  imu->rawMeasurements.fill(0.0);
  if (present.size() != values.size()) throw BrokenObject("an IMU's vectors differ in size");
  for (std::size_t i = 0; i < values.size(); ++i) {
    imu->dataIsPresent[i] = present[i] != 0;
    imu->rawMeasurements[i] = values[i];
  }
  if (version < 2) {  // stored in the wrong order
    std::swap(imu->rawMeasurements[mrpt::obs::IMU_YAW_VEL],
              imu->rawMeasurements[mrpt::obs::IMU_ROLL_VEL]);
  }
  imu->sensorLabel = in.text();
  in.leave();
  return imu;
}

Observation readOdometry(ObjectReader& in) {
  const Version version = versionUpTo(2, in);
  auto odometry = mrpt::obs::CObservationOdometry::Create();
  odometry->odometry = readPose2D(in);
  odometry->sensorLabel = in.text();
  odometry->timestamp = in.time();
  if (version >= 1) {
    odometry->hasEncodersInfo = in.flag();
    if (odometry->hasEncodersInfo || version == 1) {
      odometry->encoderLeftTicks = in.value<std::int32_t>();
      odometry->encoderRightTicks = in.value<std::int32_t>();
    }
    odometry->hasVelocities = in.flag();
    auto& velocity = odometry->velocityLocal;
    if (version == 1) {
      velocity.vx = static_cast<double>(in.value<float>());
      velocity.omega = static_cast<double>(in.value<float>());
    } else if (odometry->hasVelocities) {
      velocity.vx = in.value<double>();
      velocity.vy = in.value<double>();
      velocity.omega = in.value<double>();
    }
  }
  in.leave();
  return odometry;
}

void readBeams(Version version, mrpt::obs::CObservation2DRangeScan& scan, ObjectReader& in) {
  const auto ranges = in.vector<float>(kMaxBeams);
  std::vector<char> valid;
  if (version >= 1) valid = in.values<char>(ranges.size(), kMaxBeams);
  scan.resizeScan(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    scan.setScanRange(i, ranges[i]);
    scan.setScanRangeValidity(i, version >= 1 ? valid[i] != 0 : ranges[i] < scan.maxRange);
  }
}

Observation readLaserScan(ObjectReader& in) {
  const Version version = versionUpTo(8, in);  // 8: MRPT 3
  auto scan = mrpt::obs::CObservation2DRangeScan::Create();
  scan->aperture = in.value<float>();
  scan->rightToLeft = in.flag();
  scan->maxRange = in.value<float>();
  scan->sensorPose = readPose3D(in);
  if (version < 6) (void)in.matrix(0, 0);  // covariance of the pose
  readBeams(version, *scan, in);
  scan->stdError = version >= 2 ? in.value<float>() : 0.01F;
  scan->timestamp = version >= 3 ? in.time() : INVALID_TIMESTAMP;
  scan->beamAperture = version >= 4 ? in.value<float>() : mrpt::DEG2RAD(0.25F);
  if (version >= 5) {
    scan->sensorLabel = in.text();
    scan->deltaPitch = in.value<double>();
  }
  if (version >= 7 && in.flag()) {
    const auto intensities = in.values<std::int32_t>(scan->getScanSize(), kMaxBeams);
    scan->setScanHasIntensity(true);
    for (std::size_t i = 0; i < intensities.size(); ++i) scan->setScanIntensity(i, intensities[i]);
  }
  if (version >= 8) (void)in.value<float>();  // duration of the sweep
  in.leave();
  return scan;
}

Observation readRobotPose(ObjectReader& in) {
  const Version version = versionUpTo(1, in);
  auto pose = mrpt::obs::CObservationRobotPose::Create();
  pose->pose = readPosePdf(in);
  pose->sensorLabel = in.text();
  pose->timestamp = in.time();
  if (version >= 1) pose->sensorPose = readPose3D(in);
  in.leave();
  return pose;
}

constexpr std::size_t kMaxMessages = 100;          // of a receiver
constexpr std::size_t kMaxMessageBytes = 1 << 16;  // of one of them

void readTimeOfDay(mrpt::obs::gnss::UTC_time& time, ObjectReader& in) {
  time.hour = in.value<std::uint8_t>();
  time.minute = in.value<std::uint8_t>();
  time.sec = in.value<double>();
}

/// The values one by one, because a flag of arbitrary bytes must not become a bool.
Message_NMEA_GGA readGga(ObjectReader& in) {
  Message_NMEA_GGA message;
  auto& fields = message.fields;
  readTimeOfDay(fields.UTCTime, in);
  fields.latitude_degrees = in.value<double>();
  fields.longitude_degrees = in.value<double>();
  fields.fix_quality = in.value<std::uint8_t>();
  fields.altitude_meters = in.value<double>();
  fields.geoidal_distance = in.value<double>();
  fields.orthometric_altitude = in.value<double>();
  fields.corrected_orthometric_altitude = in.value<double>();
  fields.satellitesUsed = in.value<std::uint32_t>();
  fields.thereis_HDOP = in.flag();
  fields.HDOP = in.value<float>();
  return message;
}

/// Standard deviation of each horizontal axis [m] by the covariance (east, north, up), which
/// version 12 may contain.
std::optional<double> readSigma(ObjectReader& in) {
  if (in.text() != "std::optional") throw BrokenObject("a covariance has another type");
  (void)in.text();  // the type of the matrix
  if (!in.flag()) return std::nullopt;
  const auto covariance = in.matrix(3, 3);
  const double variance = 0.5 * (covariance[0] + covariance[4]);
  return variance > 0.0 && std::isfinite(variance) ? std::optional(std::sqrt(variance))
                                                   : std::nullopt;
}

/// States an accuracy as the dilution of precision that gives it.
void setSigma(double sigma_m, Message_NMEA_GGA& message) {
  const auto hdop = hdopOf(message.fields.fix_quality, sigma_m);
  if (!hdop) return;
  message.fields.thereis_HDOP = true;
  message.fields.HDOP = static_cast<float>(*hdop);
}

/// Of the messages of a receiver, GGA is kept.
Observation readGnss(ObjectReader& in) {
  const auto version = in.value<Version>();
  if (version < 10 || version > 12) throw UnknownVersion("", version);
  auto observation = mrpt::obs::CObservationGPS::Create();
  observation->timestamp = in.time();
  observation->originalReceivedTimestamp = in.time();
  observation->sensorLabel = in.text();
  observation->sensorPose = readPose3D(in);
  if (version >= 11) observation->has_satellite_timestamp = in.flag();
  const auto sigma = version >= 12 ? readSigma(in) : std::nullopt;
  const auto count = in.value<std::uint32_t>();
  if (count > kMaxMessages) throw BrokenObject("too many messages of a receiver");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto type = in.value<std::int32_t>();
    const auto bytes = in.value<std::uint32_t>();
    if (bytes > kMaxMessageBytes) throw BrokenObject("a message of a receiver is too long");
    if (type == Message_NMEA_GGA::msg_type && bytes == sizeof(Message_NMEA_GGA::content_t)) {
      Message_NMEA_GGA message = readGga(in);
      if (sigma) setSigma(*sigma, message);
      observation->setMsg(message);
    } else {
      (void)in.skip(bytes);
    }
  }
  in.leave();
  return observation;
}

/// Comments have no label of their own: that of the marks that headway writes is made of the text.
Observation readComment(ObjectReader& in) {
  (void)versionUpTo(0, in);
  auto comment = mrpt::obs::CObservationComment::Create();
  const auto text = in.vector<char>(kMaxMessageBytes);
  comment->text.assign(text.begin(), text.end());
  if (comment->text == kTimesAssumedText) comment->sensorLabel = kTimesAssumed;
  comment->timestamp = in.time();
  in.leave();
  return comment;
}

Box2d readBox2d(ObjectReader& in) {
  Box2d box;
  for (double* value : {&box.left, &box.top, &box.right, &box.bottom}) *value = in.value<double>();
  return box;
}

Box3d readBox3d(ObjectReader& in) {
  Box3d box;
  for (int i = 0; i < 3; ++i) box.centre[i] = in.value<double>();
  for (double* value : {&box.length, &box.width, &box.height, &box.yaw}) {
    *value = in.value<double>();
  }
  return box;
}

Eigen::Matrix3d readSymmetric(ObjectReader& in) {
  Eigen::Matrix3d matrix;
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      matrix(row, column) = matrix(column, row) = in.value<double>();
    }
  }
  return matrix;
}

Observation readDetections(ObjectReader& in) {
  (void)versionUpTo(0, in);
  auto detections = CObservationObjectDetections::Create();
  detections->sensorLabel = in.text();
  detections->timestamp = in.time();
  detections->sensor_pose = readPose3D(in);
  detections->image_width = in.value<std::uint32_t>();
  detections->image_height = in.value<std::uint32_t>();
  const auto count = in.value<std::uint32_t>();
  if (count > kMaxDetections) throw BrokenObject("too many detections");
  for (std::uint32_t i = 0; i < count; ++i) {
    CObservationObjectDetections::Item item;
    item.class_name = in.text();
    item.score = in.value<double>();
    item.detector_id = in.value<std::int64_t>();
    if (in.flag()) item.box2d = readBox2d(in);
    if (in.flag()) item.box3d = readBox3d(in);
    if (in.flag()) item.centre_covariance = readSymmetric(in);
    detections->items.push_back(std::move(item));
  }
  in.leave();
  return detections;
}

using Reader = Observation (*)(ObjectReader&);

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> result = {
      {"CObservationStereoImages", readStereoImages},
      {"CObservationImage", readSingleImage},
      {"CObservation3DRangeScan", readDepthScan},
      {"CObservationIMU", readImu},
      {"CObservationOdometry", readOdometry},
      {"CObservation2DRangeScan", readLaserScan},
      {"CObservationGPS", readGnss},
      {"CObservationComment", readComment},
      {"CObservationRobotPose", readRobotPose},
      {"CObservationObjectDetections", readDetections}};
  return result;
}

/// Whether observations of this class (without namespace) are read. All others are skipped: MRPT
/// would read them without limits of size and nesting.
bool isReadClass(const std::string& class_name) { return readers().count(class_name) > 0; }

/// Reads the values of an observation after its class name: version, values and end mark. Embedded
/// images are decoded; those that are broken are empty. @throws BrokenObject
Observation readObservation(const std::string& class_name, ObjectReader& in) {
  return readers().at(class_name)(in);
}

/// Reads the values of a CActionRobotMovement2D, versions 2 to 7, after its class name.
///
/// @return the increment of odometry; nullopt if the movement was estimated in another way, and the
///         end mark is then not read
std::optional<mrpt::poses::CPose2D> readMovement(ObjectReader& in) {
  const Version version = versionUpTo(7, in);
  if (version < 2) throw BrokenObject("a movement has an unknown version");
  if (in.value<std::int32_t>() != 0) return std::nullopt;  // 0: by odometry
  const auto increment = readPose2D(in);
  // The motion model, whose parameters are not used.
  constexpr std::size_t kModelBytes[] = {44, 4 + 5 * 4 + 5 * 4, 4 + 6 * 4 + 5 * 4,
                                         4 + 6 * 4 + 7 * 4};
  (void)in.skip(kModelBytes[std::min<std::size_t>(version, 5) - 2]);
  if (version < 7) {
    // All values are stored; MRPT left the flags before them uninitialised where it had none.
    (void)in.skip(1 + 2 * sizeof(float));         // velocities
    (void)in.skip(1 + 2 * sizeof(std::int32_t));  // encoders
  } else {
    if (in.flag()) (void)in.skip(3 * sizeof(double));
    if (in.flag()) (void)in.skip(2 * sizeof(std::int32_t));
  }
  if (version >= 6) (void)in.time();
  in.leave();
  return increment;
}

// An end mark would also be the header of a class with a name of 8 letters, which no class in a
// rawlog has.
constexpr std::size_t kMinNameLength = 3;    // of a class
constexpr std::size_t kMaxNameLength = 120;  // of the 127 that a header can state
constexpr std::size_t kScanChunk = 1 << 16;  // searched for a header at once
constexpr std::size_t kMaxReasons = 200;     // counted one by one

constexpr char kSensoryFrame[] = "CSensoryFrame";
constexpr char kActionCollection[] = "CActionCollection";
constexpr char kMovement[] = "CActionRobotMovement2D";

bool isClassName(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '<' ||
           c == '>' || c == ',';
  });
}

/// Names of all classes that are or contain observations; without namespace in files before 2.0.
const std::unordered_set<std::string_view>& observationClasses() {
  static const std::unordered_set<std::string_view> classes = [] {
    std::unordered_set<std::string_view> result = {"mrpt::obs::CSensoryFrame",
                                                   "mrpt::obs::CActionCollection",
                                                   "mrpt::obs::CActionRobotMovement2D",
                                                   kSensoryFrame,
                                                   kActionCollection,
                                                   kMovement};
    for (const auto* id :
         mrpt::rtti::getAllRegisteredClassesChildrenOf(CLASS_ID(mrpt::obs::CObservation))) {
      const std::string_view name = id->className;
      result.insert(name);
      result.insert(name.substr(name.rfind(':') + 1));
    }
    return result;
  }();
  return classes;
}

/// Position of the first header of such a class; npos if there is none.
std::size_t findObservationHeader(std::string_view bytes) {
  for (std::size_t at = 0; at + kMinNameLength < bytes.size(); ++at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const char second = bytes[at + 1];
    // All names begin with "mrpt::", "headway::" or "C".
    if ((first & kNameFlag) == 0 || (second != 'm' && second != 'h' && second != 'C')) continue;
    const std::size_t length = first & ~kNameFlag;
    if (at + 1 + length > bytes.size()) continue;
    if (observationClasses().count(bytes.substr(at + 1, length)) > 0) return at;
  }
  return std::string_view::npos;
}

}  // namespace

std::string shortClassName(const mrpt::rtti::CObject& object) {
  return shortClassName(object.GetRuntimeClass()->className);
}

ObservationStream::ObservationStream(const std::string& path,
                                     std::map<std::string, std::size_t>& skipped)
    : path_(path), skipped_(skipped), input_(path) {
  registerClasses();
  if (!readClassName()) {
    const std::string pointer = lfsPointerFault(path_);
    if (!pointer.empty()) throw InputError(path_ + ": " + pointer);
    throw InputError(path_ + ": is not a rawlog" +
                     (truncation_ ? " (" + *truncation_ + ")" : std::string()));
  }
  input_.goTo(header_position_);
}

mrpt::obs::CObservation::Ptr ObservationStream::next() {
  while (ready_.empty() && !at_end_ && !stopRequested()) {
    const auto class_name = readClassName();
    if (class_name) readObject(*class_name);
  }
  if (ready_.empty()) return nullptr;
  auto observation = ready_.front();
  ready_.pop_front();
  return observation;
}

/// Class name of the next object; nullopt at the end of the file. Bytes that are no header are
/// skipped.
std::optional<std::string> ObservationStream::readClassName() {
  while (true) {
    input_.mark();
    header_position_ = input_.position();
    const std::string_view header = input_.peek(1 + kMaxNameLength);
    if (header.empty()) return endOfFile();
    const auto first = static_cast<unsigned char>(header[0]);
    if (first == kEndMark && (open_containers_ > 0 || has_skipped_)) {
      input_.take(1);
      if (open_containers_ > 0) --open_containers_;
      continue;
    }
    const std::size_t length = first & ~kNameFlag;
    const std::string_view name = header.substr(1, length);
    if ((first & kNameFlag) != 0 && length >= kMinNameLength && length <= kMaxNameLength &&
        isClassName(name)) {
      if (name.size() < length) {
        truncate("the file ends within an object");
        return std::nullopt;
      }
      std::string result(name);
      input_.take(1 + length);
      return result;
    }
    // Behind an object that was found within a skipped one follows the remainder of the latter.
    if (objects_since_skip_ >= 2) count("broken_header");
    input_.take(1);
    if (!skipToNextObservation()) return endOfFile();
  }
}

std::nullopt_t ObservationStream::endOfFile() {
  at_end_ = true;
  if (!input_.compressionError().empty()) {
    truncate(input_.compressionError());
  } else if (open_containers_ > 0 && !has_skipped_) {
    truncate("the file ends within a sensory frame");
  }
  return std::nullopt;
}

/// Reads an object after its class name. After a failure continues behind the class name, so that
/// a wrong length costs no other object.
void ObservationStream::readObject(const std::string& class_name) {
  const std::uint64_t start = input_.position();
  const std::string name = shortClassName(class_name);
  try {
    if (readValues(name)) {
      ++objects_since_skip_;
      return;
    }
    count(name);
  } catch (const UnexpectedEnd& error) {
    input_.goTo(start);
    const std::string reason = input_.compressionError();
    if (!skipToNextObservation()) return truncate(reason.empty() ? error.what() : reason);
    return count("unreadable_" + name);
  } catch (const UnknownVersion& error) {
    count("unreadable_" + name + "_" + error.what());
  } catch (const BrokenObject&) {
    count("unreadable_" + name);
  }
  input_.goTo(start);
  (void)skipToNextObservation();
}

/// Reads the values of an object; false if it is not one of those that are used.
bool ObservationStream::readValues(const std::string& name) {
  ObjectReader in(input_);
  if (name == kSensoryFrame || name == kActionCollection) {
    enterContainer(name, in);
  } else if (name == kMovement) {
    const auto increment = readMovement(in);
    if (!increment) return false;
    addMovement(*increment);
  } else if (isReadClass(name)) {
    deliver(readObservation(name, in));
  } else {
    return false;
  }
  return true;
}

/// Reads the version and the number of objects, which follow one by one. The number is not used:
/// the end mark tells where they end.
void ObservationStream::enterContainer(const std::string& name, ObjectReader& in) {
  const auto version = in.value<std::uint8_t>();
  if (name == kSensoryFrame && version == 1) (void)in.value<std::uint32_t>();  // identifier
  const bool is_known = name == kSensoryFrame ? version == 1 || version == 2 : version == 0;
  if (!is_known) throw BrokenObject("a container has an unknown version");
  (void)in.value<std::uint32_t>();
  ++open_containers_;
}

void ObservationStream::addMovement(const mrpt::poses::CPose2D& increment) {
  odometry_ = odometry_ + increment;
  odometry_is_new_ = true;
}

void ObservationStream::deliver(const mrpt::obs::CObservation::Ptr& observation) {
  if (odometry_is_new_ && observation->timestamp != INVALID_TIMESTAMP) {
    auto summed = mrpt::obs::CObservationOdometry::Create();
    summed->timestamp = observation->timestamp;
    summed->sensorLabel = "odometry";
    summed->odometry = odometry_;
    ready_.push_back(summed);
    odometry_is_new_ = false;
  }
  ++observations_;
  ready_.push_back(observation);
}

/// Counts what is skipped; the names in a broken file do not fill the memory.
void ObservationStream::count(const std::string& reason) {
  const bool is_new = skipped_.count(reason) == 0;
  ++skipped_[is_new && skipped_.size() >= kMaxReasons ? "other_classes" : reason];
}

/// Continues at the next header of an observation; false if there is none.
bool ObservationStream::skipToNextObservation() {
  has_skipped_ = true;
  objects_since_skip_ = 0;
  while (!stopRequested()) {
    input_.mark();
    const std::string_view window = input_.peek(kScanChunk);
    const auto at = findObservationHeader(window);
    if (at != std::string_view::npos) {
      input_.take(at);
      return true;
    }
    const bool is_end = window.size() < kScanChunk;
    // A header may begin in the last bytes.
    input_.take(is_end ? window.size() : window.size() - (kMaxNameLength + 1));
    if (is_end) return false;
  }
  return false;
}

void ObservationStream::truncate(const std::string& reason) {
  at_end_ = true;
  truncation_ = path_ + ": truncated after " + std::to_string(observations_) +
                " observations, at byte " + std::to_string(input_.position()) +
                " of the uncompressed content: " + reason;
}

}  // namespace headway::io
