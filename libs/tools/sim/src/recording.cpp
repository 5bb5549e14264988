// SPDX-License-Identifier: BSD-3-Clause
// A simulated rawlog and its truth on disk.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/stereo_camera.h>
#include <headway/io/calibration_file.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/raw_camera.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/sim/recording.h>
#include <mrpt/img/CImage.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iomanip>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace headway::sim {
namespace {

/// The upper three rows, row by row.
void writeRows(std::ostream& out, const Pose& pose, const char* separator) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      out << (row + column > 0 ? separator : "") << pose.matrix()(row, column);
    }
  }
}

/// KITTI's calib.txt: P0 ... P3 (pairs 0/1 and 2/3 are the same), R0_rect, and the robot frame in
/// the place of the lidar's. @throws InputError if it cannot be written
void writeKittiCalibration(const std::string& path, const StereoCamera& camera) {
  std::ostringstream out;
  out << std::setprecision(12);
  for (int i = 0; i < 4; ++i) {
    const double shift = i % 2 == 0 ? 0.0 : -camera.fx * camera.baseline_m;
    out << "P" << i << ": " << camera.fx << " 0 " << camera.cx << " " << shift << " 0 " << camera.fy
        << " " << camera.cy << " 0 0 0 1 0\n";
  }
  out << "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: ";
  writeRows(out, camera.T_robot_cam.inverse(), " ");
  out << "\nTr_imu_to_velo: 1 0 0 0 0 1 0 0 0 0 1 0\n";
  writeFile(path, out.str());
}

io::ImageStorage storageOf(RecordingParams::Storage storage) {
  switch (storage) {
    case RecordingParams::Storage::kExternalPng:
      return io::ImageStorage::kExternalPng;
    case RecordingParams::Storage::kExternalJpeg:
      return io::ImageStorage::kExternalJpeg;
    case RecordingParams::Storage::kEmbedded:
      break;
  }
  return io::ImageStorage::kEmbedded;
}

/// Creates a folder unless it exists. @throws InputError if it cannot be created
std::filesystem::path madeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder + ": cannot be made: " + error.message());
  return folder;
}

void writePicture(const std::string& folder, std::size_t index, const cv::Mat& picture) {
  char name[32];
  std::snprintf(name, sizeof name, "/%06zu.png", index);
  std::vector<uchar> png;
  cv::imencode(".png", picture, png);
  writeFile(folder + name, {reinterpret_cast<const char*>(png.data()), png.size()});
}

cv::Mat kittiDepth(const cv::Mat& depth) {
  cv::Mat scaled;
  depth.convertTo(scaled, CV_16U, 256.0);  // saturates at 255.99 m
  return scaled;
}

io::KittiRow labelOf(const SimFrame& frame, const TruthObject& object) {
  io::KittiRow row;
  row.frame = frame.index;
  row.id = object.id;
  row.type = std::string(toString(object.object_class));
  row.truncation = object.truncation;
  row.occlusion = object.occlusion;
  row.alpha =
      wrapAngle(object.box3d.yaw - std::atan2(object.box3d.centre.x(), object.box3d.centre.z()));
  row.box2d = object.box2d;
  row.height = object.box3d.height;
  row.width = object.box3d.width;
  row.length = object.box3d.length;
  row.bottom_centre = object.box3d.centre + Eigen::Vector3d(0, 0.5 * object.box3d.height, 0);
  row.rotation_y = object.box3d.yaw;
  row.visible = object.visible;
  return row;
}

/// Detections that say exactly what is there.
Detections truthDetections(const SimFrame& frame) {
  Detections truth = frame.detections;
  truth.items.clear();
  for (const TruthObject& object : frame.objects) {
    Detection detection;
    detection.object_class = object.object_class;
    detection.score = object.visible;
    detection.detector_id = object.id;
    detection.box2d = object.box2d;
    detection.box3d = object.box3d;
    truth.items.push_back(detection);
  }
  return truth;
}

/// The columns of io::objectCsvHeader() and `visible`.
void writeObjectRow(std::ostream& out, const SimFrame& frame, const TruthObject& object) {
  const double speed = object.velocity.norm();
  out << frame.index << ',' << std::fixed << std::setprecision(6) << frame.time << ',' << object.id
      << ',' << toString(object.object_class) << ",confirmed," << (speed > 0.1 ? 1 : 0)
      << std::setprecision(4);
  for (const double value :
       {object.position.x(), object.position.y(), object.position.z(), object.yaw, object.size.x(),
        object.size.y(), object.size.z(), object.velocity.x(), object.velocity.y(),
        object.velocity.z(), 0.0, 0.0, 0.0, object.visible}) {
    out << ',' << value;
  }
  out << '\n';
}

/// One row for each corner of each drop's outline.
void writeDrops(const std::string& path, const std::vector<Drop>& drops) {
  std::ostringstream out;
  out << "drop,x,y,depth_m\n" << std::fixed << std::setprecision(4);
  for (std::size_t i = 0; i < drops.size(); ++i) {
    for (const Eigen::Vector2d& corner : drops[i].outline) {
      out << i << ',' << corner.x() << ',' << corner.y() << ',' << drops[i].depth_m << '\n';
    }
  }
  writeFile(path, out.str());
}

/// A depth camera whose depths are registered to its intensity image.
io::RawDepthCamera depthCamera(const io::RawStereoCamera& recorded, double reach_m) {
  io::RawDepthCamera registered;
  registered.color = registered.depth = recorded.left;
  registered.T_robot_color = recorded.T_robot_left;
  registered.max_range_m = reach_m;
  return registered;
}

/// The camera as replays of the recording use it.
StereoCamera asReplayed(StereoCamera camera) {
  if (camera.isDepthCamera()) camera.baseline_m = io::equivalentBaseline(camera.fx);
  return camera;
}

void writePlaces(const std::string& path, const std::vector<TruePlace>& places) {
  std::ostringstream out;
  out << "time,latitude_deg,longitude_deg,altitude_m,heading_deg\n" << std::fixed;
  for (const TruePlace& place : places) {
    out << std::setprecision(6) << place.time << ',' << std::setprecision(9) << place.latitude_deg
        << ',' << place.longitude_deg << std::setprecision(4) << ',' << place.altitude_m << ','
        << place.heading_deg << '\n';
  }
  writeFile(path, out.str());
}

}  // namespace

class Recording::Files {
 public:
  Files(const std::string& path, const RecordingParams& params, const RecordingOptions& options,
        const StereoCamera& camera, const io::RawStereoCamera& recorded,
        const std::string& world_ini)
      : folder_(truthFolder(path)),
        options_(options),
        camera_(camera),
        recorded_(recorded),
        sink_(path, storageOf(params.storage), params.jpeg_quality),
        labels_(madeFolder(folder_) / "label_02.txt"),
        objects_(std::filesystem::path(folder_) / "objects.csv") {
    if (options.masks) madeFolder(folder_ + "/masks");
    if (options.depth) madeFolder(folder_ + "/depth");
    objects_.stream() << io::objectCsvHeader() << ",visible\n";
    writeFile(folder_ + "/world.ini", world_ini);
    writeKittiCalibration(folder_ + "/calib.txt", camera);
    io::writeCalibration(folder_ + "/calibration.yaml", asReplayed(camera));
  }

  void write(const SimFrame& frame) {
    for (const ImuSample& sample : frame.imu) {
      sink_.writeImu(sample.time, sample.angular_velocity, sample.acceleration);
    }
    if (frame.odometry) {
      sink_.writeOdometry(frame.odometry->time, frame.odometry->x, frame.odometry->y,
                          frame.odometry->yaw);
    }
    for (const io::RecordedGnss& fix : frame.gnss) sink_.writeGnss(fix);
    if (frame.place) places_.push_back(*frame.place);
    if (frame.laser) sink_.writeLaser(*frame.laser);
    if (!frame.drops.empty()) writeDrops(folder_ + "/drops.csv", frame.drops);
    writeImages(frame);
    sink_.writeDetections("detections", frame.detections);
    sink_.writePose("truth_pose", frame.time, frame.T_map_robot);
    sink_.writeDetections("truth_objects", truthDetections(frame));
    for (const TruthObject& object : frame.objects) {
      io::writeKittiLabel(labels_.stream(), labelOf(frame, object), true);
      writeObjectRow(objects_.stream(), frame, object);
    }
    if (options_.masks) writePicture(folder_ + "/masks", frame.index, dynamicMask(frame));
    if (options_.depth) writePicture(folder_ + "/depth", frame.index, kittiDepth(frame.depth));
    trajectory_.push_back({frame.time, frame.T_map_robot});
  }

  void close() {
    io::writeTum(folder_ + "/trajectory.tum", trajectory_);
    std::vector<Pose> cameras;
    const Pose T_cam_robot = camera_.T_robot_cam.inverse();
    for (const auto& [time, T_map_robot] : trajectory_) {
      const Pose T_first_robot = trajectory_.front().value.inverse() * T_map_robot;
      cameras.push_back(T_cam_robot * T_first_robot * camera_.T_robot_cam);
    }
    io::writeKittiPoses(folder_ + "/poses_kitti.txt", cameras);
    if (!places_.empty()) writePlaces(folder_ + "/trajectory_geo.csv", places_);
    labels_.commit();
    objects_.commit();
    sink_.close();
  }

 private:
  void writeImages(const SimFrame& frame) {
    if (frame.ranges.empty()) {
      return sink_.writeStereo(frame.time, frame.left, frame.right, recorded_);
    }
    sink_.writeDepth(frame.time, frame.left, frame.ranges,
                     depthCamera(recorded_, camera_.depth_reach_m));
  }

  std::string folder_;
  RecordingOptions options_;
  StereoCamera camera_;
  io::RawStereoCamera recorded_;
  io::RawlogSink sink_;
  OutputFile labels_;
  OutputFile objects_;
  std::vector<Stamped<Pose>> trajectory_;
  std::vector<TruePlace> places_;
};

Recording::Recording(const std::string& path, const RecordingParams& params,
                     const RecordingOptions& options, const StereoCamera& camera,
                     const io::RawStereoCamera& recorded, const std::string& world_ini)
    : files_(
          std::make_unique<Files>(path, validated(params), options, camera, recorded, world_ini)) {}

Recording::~Recording() = default;

void Recording::write(const SimFrame& frame) { files_->write(frame); }

void Recording::close() { files_->close(); }

std::shared_ptr<mrpt::obs::CObservation> observationOf(const SimFrame& frame,
                                                       const io::RawStereoCamera& camera,
                                                       double depth_reach_m) {
  const mrpt::img::CImage left(frame.left, mrpt::img::SHALLOW_COPY);
  std::shared_ptr<mrpt::obs::CObservation> observation;
  if (!frame.ranges.empty()) {
    observation = io::depthObservation(left, frame.ranges, depthCamera(camera, depth_reach_m));
    observation->sensorLabel = "rgbd";
  } else {
    const auto pair = mrpt::obs::CObservationStereoImages::Create();
    pair->imageLeft = left;
    pair->imageRight = mrpt::img::CImage(frame.right, mrpt::img::SHALLOW_COPY);
    io::setCalibration(camera, *pair);
    observation = pair;
    observation->sensorLabel = "stereo";
  }
  observation->timestamp = io::mrptTime(frame.time);
  return observation;
}

std::string truthFolder(const std::string& rawlog) { return io::rawlogStem(rawlog) + ".truth"; }

double estimateMegabytes(const std::vector<SimFrame>& frames, const RecordingParams& params,
                         const RecordingOptions& options, std::size_t total) {
  double bytes = 0.0;
  for (const SimFrame& frame : frames) {
    const bool png = params.storage == RecordingParams::Storage::kExternalPng;
    const bool raw =
        params.storage == RecordingParams::Storage::kEmbedded && frame.left.channels() == 1;
    std::vector<uchar> packed;
    for (const cv::Mat* picture : {&frame.left, &frame.right}) {
      if (picture->empty()) continue;
      // Embedded grey images are kept raw inside a gz stream, which packs about as PNG does.
      cv::imencode(png || raw ? ".png" : ".jpg", *picture, packed,
                   png || raw ? std::vector<int>{}
                              : std::vector<int>{cv::IMWRITE_JPEG_QUALITY, params.jpeg_quality});
      bytes += static_cast<double>(packed.size());
    }
    if (!frame.ranges.empty()) {
      cv::imencode(".png", frame.ranges, packed);
      bytes += static_cast<double>(packed.size());
    }
    if (options.masks) {
      cv::imencode(".png", dynamicMask(frame), packed);
      bytes += static_cast<double>(packed.size());
    }
    if (options.depth) {
      cv::imencode(".png", kittiDepth(frame.depth), packed);
      bytes += static_cast<double>(packed.size());
    }
    bytes += 400.0 * static_cast<double>(frame.objects.size());
  }
  return bytes / static_cast<double>(frames.size()) * static_cast<double>(total) / 1e6;
}

}  // namespace headway::sim
