// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_objects.h"

#include <headway/io/detection_observation.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <map>

#include "recorded_depth.h"
#include "recorded_gnss.h"
#include "recorded_image.h"
#include "recorded_poses.h"

namespace headway::io {
namespace {

constexpr std::size_t kMaxBeams = 1 << 20;       // of a laser scan
constexpr std::size_t kMaxDetections = 1 << 16;  // in one image
constexpr double kDefaultFocalLengthM = 0.002;   // of cameras that do not store it

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
      {"CObservationRobotPose", readRobotPose},
      {"CObservationObjectDetections", readDetections}};
  return result;
}

}  // namespace

bool isReadClass(const std::string& class_name) { return readers().count(class_name) > 0; }

Observation readObservation(const std::string& class_name, ObjectReader& in) {
  return readers().at(class_name)(in);
}

std::optional<mrpt::poses::CPose2D> readMovement(ObjectReader& in) {
  const Version version = versionUpTo(7, in);
  if (version < 2) throw BrokenObject("a movement has an unknown version");
  constexpr std::int32_t kOdometry = 0;
  if (in.value<std::int32_t>() != kOdometry) return std::nullopt;
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

}  // namespace headway::io
