// SPDX-License-Identifier: BSD-3-Clause
// headway-export mcap: a replay as messages of Foxglove, in the frames "map", "odom", "base_link"
// (the robot) and "camera".
#include <google/protobuf/descriptor.pb.h>
#include <headway/core/ellipse.h>
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/text.h>
#include <headway/io/calibration_file.h>
#include <headway/io/image_file.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>
#include <headway/report/map_files.h>
#include <headway/report/replay_frames.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>

#include "commands.h"
#include "foxglove.pb.h"
#include "mcap_writer.h"

namespace headway::exporting {
namespace {

namespace fs = std::filesystem;
using report::ReplayFrame;

constexpr char kMap[] = "map", kOdom[] = "odom", kRobot[] = "base_link", kCamera[] = "camera";
constexpr int kEllipseSides = 24;
constexpr double kLineWidthM = 0.12;

/// Nanoseconds since 1970.
std::uint64_t nanoseconds(Time time) {
  return time > 0.0 ? static_cast<std::uint64_t>(std::llround(time * 1e6)) * 1000U : 0U;
}

template <typename Message>
void setTime(Time time, Message& message) {
  const std::uint64_t ns = nanoseconds(time);
  message.mutable_timestamp()->set_seconds(static_cast<std::int64_t>(ns / 1'000'000'000U));
  message.mutable_timestamp()->set_nanos(static_cast<int>(ns % 1'000'000'000U));
}

template <typename Message>
void setHeader(Time time, const char* frame, Message& message) {
  setTime(time, message);
  message.set_frame_id(frame);
}

template <typename Vector>
void set(const Eigen::Vector3d& value, Vector& vector) {
  vector.set_x(value.x());
  vector.set_y(value.y());
  vector.set_z(value.z());
}

void set(const Eigen::Quaterniond& value, foxglove::Quaternion& quaternion) {
  quaternion.set_x(value.x());
  quaternion.set_y(value.y());
  quaternion.set_z(value.z());
  quaternion.set_w(value.w());
}

void set(const Pose& value, foxglove::Pose& pose) {
  set(value.translation(), *pose.mutable_position());
  set(Eigen::Quaterniond(value.linear()), *pose.mutable_orientation());
}

void set(Colour value, double opacity, foxglove::Color& colour) {
  colour.set_r(value.red / 255.0);
  colour.set_g(value.green / 255.0);
  colour.set_b(value.blue / 255.0);
  colour.set_a(opacity);
}

void addTransform(Time time, const char* parent, const char* child, const Pose& T_parent_child,
                  foxglove::FrameTransforms& transforms) {
  auto& transform = *transforms.add_transforms();
  setTime(time, transform);
  transform.set_parent_frame_id(parent);
  transform.set_child_frame_id(child);
  set(T_parent_child.translation(), *transform.mutable_translation());
  set(Eigen::Quaterniond(T_parent_child.linear()), *transform.mutable_rotation());
}

template <typename Message>
void addField(const char* name, std::uint32_t offset,
              foxglove::PackedElementField::NumericType type, Message& message) {
  auto& field = *message.add_fields();
  field.set_name(name);
  field.set_offset(offset);
  field.set_type(type);
}

template <typename Message>
void addColours(std::uint32_t offset, Message& message) {
  for (const char* name : {"red", "green", "blue", "alpha"}) {
    addField(name, offset++, foxglove::PackedElementField::UINT8, message);
  }
}

/// An update that first removes what its topic shows.
foxglove::SceneUpdate freshUpdate(Time time) {
  foxglove::SceneUpdate update;
  auto& deletion = *update.add_deletions();
  setTime(time, deletion);
  deletion.set_type(foxglove::SceneEntityDeletion::ALL);
  return update;
}

foxglove::SceneEntity& addEntity(const ReplayFrame& frame, const Track& track,
                                 foxglove::SceneUpdate& update) {
  auto& entity = *update.add_entities();
  setHeader(frame.time, kMap, entity);
  entity.set_id("track " + std::to_string(track.id.value));
  return entity;
}

void addMetadata(const std::string& key, const std::string& value, foxglove::SceneEntity& entity) {
  auto& pair = *entity.add_metadata();
  pair.set_key(key);
  pair.set_value(value);
}

foxglove::LinePrimitive& addLine(foxglove::LinePrimitive::Type type, double opacity,
                                 foxglove::SceneEntity& entity) {
  auto& line = *entity.add_lines();
  line.set_type(type);
  set(Pose::Identity(), *line.mutable_pose());
  line.set_thickness(kLineWidthM);
  set(kPredictionColour, opacity, *line.mutable_color());
  return line;
}

void addEllipse(const PredictedPoint& point, double opacity, foxglove::SceneEntity& entity) {
  const Ellipse ellipse = sigmaEllipse(point.covariance);
  const Eigen::Rotation2Dd rotation(ellipse.angle);
  auto& line = addLine(foxglove::LinePrimitive::LINE_LOOP, 0.6 * opacity, entity);
  line.set_thickness(0.5 * kLineWidthM);
  for (int i = 0; i < kEllipseSides; ++i) {
    const double angle = 2.0 * M_PI * i / kEllipseSides;
    const Eigen::Vector2d offset = rotation * Eigen::Vector2d(ellipse.major * std::cos(angle),
                                                              ellipse.minor * std::sin(angle));
    set({point.position.x() + offset.x(), point.position.y() + offset.y(), point.position.z()},
        *line.add_points());
  }
}

foxglove::FrameTransforms transformsOf(const ReplayFrame& frame, const Pose& T_robot_cam) {
  foxglove::FrameTransforms transforms;
  const Pose T_odom_robot = frame.T_odom_robot.value_or(frame.T_map_robot);
  addTransform(frame.time, kMap, kOdom, frame.T_map_robot * T_odom_robot.inverse(), transforms);
  addTransform(frame.time, kOdom, kRobot, T_odom_robot, transforms);
  addTransform(frame.time, kRobot, kCamera, T_robot_cam, transforms);
  return transforms;
}

foxglove::PoseInFrame poseOf(const ReplayFrame& frame) {
  foxglove::PoseInFrame pose;
  setHeader(frame.time, kMap, pose);
  set(frame.T_map_robot, *pose.mutable_pose());
  return pose;
}

/// Poses of the whole replay, at most 5000, which viewers draw at once, evenly spaced.
foxglove::PosesInFrame pathOf(const std::vector<ReplayFrame>& frames) {
  foxglove::PosesInFrame path;
  setHeader(frames.front().time, kMap, path);
  const std::size_t step = 1 + (frames.size() - 1) / 5000;
  for (std::size_t i = 0; i < frames.size(); i += step) {
    set(frames[i].T_map_robot, *path.add_poses());
  }
  return path;
}

foxglove::CameraCalibration calibrationOf(Time time, const StereoCamera& camera) {
  foxglove::CameraCalibration calibration;
  setHeader(time, kCamera, calibration);
  calibration.set_width(static_cast<std::uint32_t>(camera.width));
  calibration.set_height(static_cast<std::uint32_t>(camera.height));
  calibration.set_distortion_model("plumb_bob");
  for (int i = 0; i < 5; ++i) calibration.add_d(0.0);
  for (const double value : {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0}) {
    calibration.add_k(value);
  }
  for (const double value : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) calibration.add_r(value);
  for (const double value :
       {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    calibration.add_p(value);
  }
  return calibration;
}

/// @param image  grey or BGR
foxglove::CompressedImage imageOf(Time time, const cv::Mat& image) {
  foxglove::CompressedImage message;
  setHeader(time, kCamera, message);
  message.set_format("jpeg");
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, 85});
  message.set_data(jpeg.data(), jpeg.size());
  return message;
}

foxglove::PointCloud cloudOf(Time time, const std::vector<report::ColouredPoint>& points) {
  constexpr std::size_t kStride = 16;  // bytes
  foxglove::PointCloud cloud;
  setHeader(time, kMap, cloud);
  set(Pose::Identity(), *cloud.mutable_pose());
  cloud.set_point_stride(kStride);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    addField(name, offset, foxglove::PackedElementField::FLOAT32, cloud);
    offset += 4;
  }
  addColours(offset, cloud);
  std::string& bytes = *cloud.mutable_data();
  bytes.resize(kStride * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& [position, colour] = points[i];
    std::memcpy(&bytes[kStride * i], position.data(), 12);
    const unsigned char rgba[4] = {colour.red, colour.green, colour.blue, 255};
    std::memcpy(&bytes[kStride * i + 12], rgba, 4);
  }
  return cloud;
}

/// Free cells in a light and occupied ones in a dark colour; unknown ones are transparent.
///
/// @throws InputError if its picture cannot be read
foxglove::Grid gridOf(Time time, const report::GridFile& file) {
  const cv::Mat grey = io::loadGreyImage(file.picture.string());
  if (grey.empty()) throw InputError(file.picture.string() + ": is not a readable picture");
  foxglove::Grid grid;
  setHeader(time, kMap, grid);
  Pose corner = Pose::Identity();
  corner.translation().head<2>() = file.origin;
  set(corner, *grid.mutable_pose());
  grid.set_column_count(static_cast<std::uint32_t>(grey.cols));
  grid.mutable_cell_size()->set_x(file.resolution_m);
  grid.mutable_cell_size()->set_y(file.resolution_m);
  grid.set_cell_stride(4);
  grid.set_row_stride(static_cast<std::uint32_t>(4 * grey.cols));
  addColours(0, grid);
  std::string& bytes = *grid.mutable_data();
  for (int row = grey.rows - 1; row >= 0; --row) {  // y increases with the rows of the message
    for (int column = 0; column < grey.cols; ++column) {
      const int level = grey.at<unsigned char>(row, column);
      // A map server's picture has 254 for free, 205 for unknown and 0 for occupied cells.
      const bool is_free = level > 230, is_occupied = level < 100;
      const unsigned char shade = is_free ? 200 : 40;
      for (int i = 0; i < 3; ++i) bytes += static_cast<char>(shade);
      bytes += static_cast<char>(is_free ? 110 : is_occupied ? 230 : 0);
    }
  }
  return grid;
}

/// Boxes with their names; they replace those of the frame before.
foxglove::SceneUpdate boxesOf(const ReplayFrame& frame) {
  foxglove::SceneUpdate update = freshUpdate(frame.time);
  for (const auto& track : frame.tracks) {
    auto& entity = addEntity(frame, track, update);
    Pose pose = Pose::Identity();
    pose.translation() = track.position;
    pose.linear() = Eigen::AngleAxisd(track.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    auto& cube = *entity.add_cubes();
    set(pose, *cube.mutable_pose());
    set(track.size, *cube.mutable_size());
    set(colourOf(track.object_class), isMoving(track) ? 0.6 : 0.3, *cube.mutable_color());
    auto& text = *entity.add_texts();
    pose.translation().z() += 0.5 * track.size.z() + 0.4;
    set(pose, *text.mutable_pose());
    text.set_billboard(true);
    text.set_font_size(0.5);
    set(colourOf(track.object_class), 1.0, *text.mutable_color());
    text.set_text(std::string(displayName(track.object_class)) + " " +
                  std::to_string(track.id.value));
    addMetadata("class", std::string(toString(track.object_class)), entity);
    addMetadata("status", std::string(toString(track.status)), entity);
    addMetadata("moving", isMoving(track) ? "true" : "false", entity);
    addMetadata("speed_mps", std::to_string(track.velocity.head<2>().norm()), entity);
  }
  return update;
}

/// Predicted paths of moving tracks, the more probable the more opaque, with ellipses of one
/// standard deviation at their ends; they replace those of the frame before.
foxglove::SceneUpdate predictionsOf(const ReplayFrame& frame) {
  foxglove::SceneUpdate update = freshUpdate(frame.time);
  for (const auto& track : frame.tracks) {
    if (!isMoving(track) || track.predictions.empty()) continue;
    auto& entity = addEntity(frame, track, update);
    for (const auto& path : track.predictions) {
      if (path.points.empty()) continue;
      const double opacity = 0.25 + 0.75 * path.probability;
      auto& line = addLine(foxglove::LinePrimitive::LINE_STRIP, opacity, entity);
      set(track.position, *line.add_points());
      for (const auto& point : path.points) set(point.position, *line.add_points());
      addEllipse(path.points.back(), opacity, entity);
      addMetadata("mode " + std::to_string(path.mode), std::to_string(path.probability), entity);
    }
  }
  return update;
}

/// The message's file of types and those it imports, as MCAP wants a Protobuf schema.
std::string descriptionOf(const google::protobuf::Descriptor& type) {
  google::protobuf::FileDescriptorSet files;
  std::set<std::string> seen;
  const std::function<void(const google::protobuf::FileDescriptor&)> add =
      [&](const google::protobuf::FileDescriptor& file) {
        if (!seen.insert(file.name()).second) return;
        for (int i = 0; i < file.dependency_count(); ++i) add(*file.dependency(i));
        file.CopyTo(files.add_file());
      };
  add(*type.file());
  return files.SerializeAsString();
}

/// One topic of messages of a type.
template <typename Message>
class Topic {
 public:
  Topic(const std::string& name, McapWriter& mcap)
      : mcap_(mcap),
        id_(mcap.addTopic(name, Message::descriptor()->full_name(), "protobuf",
                          descriptionOf(*Message::descriptor()))) {}

  void write(Time time, const Message& message) {
    mcap_.write(id_, nanoseconds(time), message.SerializeAsString());
  }

 private:
  McapWriter& mcap_;
  std::uint16_t id_;
};

/// The map, which is written once, at the time of the first frame.
void writeMap(const fs::path& folder, Time time, McapWriter& mcap) {
  for (const char* name : {"dense", "points"}) {
    const fs::path file = folder / (std::string("map_") + name + ".ply");
    if (!fs::exists(file)) continue;
    Topic<foxglove::PointCloud> topic(std::string("/map/") + name, mcap);
    topic.write(time, cloudOf(time, report::readPoints(file, 0)));
  }
  if (const auto grid = report::readGrid(folder / "map_grid.yaml")) {
    Topic<foxglove::Grid>("/map/grid", mcap).write(time, gridOf(time, *grid));
  }
}

/// What is written of each frame.
class FrameTopics {
 public:
  FrameTopics(const std::optional<StereoCamera>& camera, McapWriter& mcap)
      : camera_(camera),
        transforms_("/tf", mcap),
        pose_("/pose", mcap),
        boxes_("/tracks", mcap),
        predictions_("/predictions", mcap) {
    if (!camera_) return;
    calibration_.emplace("/camera/calibration", mcap);
    image_.emplace("/camera/image", mcap);
  }

  void write(const ReplayFrame& frame, const cv::Mat& image) {
    transforms_.write(frame.time,
                      transformsOf(frame, camera_ ? camera_->T_robot_cam : robotFromOptical()));
    pose_.write(frame.time, poseOf(frame));
    boxes_.write(frame.time, boxesOf(frame));
    predictions_.write(frame.time, predictionsOf(frame));
    if (!camera_) return;
    calibration_->write(frame.time, calibrationOf(frame.time, *camera_));
    if (!image.empty()) image_->write(frame.time, imageOf(frame.time, image));
  }

 private:
  std::optional<StereoCamera> camera_;
  Topic<foxglove::FrameTransforms> transforms_;
  Topic<foxglove::PoseInFrame> pose_;
  Topic<foxglove::SceneUpdate> boxes_, predictions_;
  std::optional<Topic<foxglove::CameraCalibration>> calibration_;
  std::optional<Topic<foxglove::CompressedImage>> image_;
};

}  // namespace

int runMcapExport(int argc, const char** argv) {
  ExportOptions options;
  bool without_images = false;
  const auto more = [&](program::CommandLine& line) {
    line.flag(without_images, 0, "no-images", "Leave out the camera's images");
  };
  if (!parse(argc, argv,
             {"mcap",
              "Writes a finished replay as an MCAP file for Foxglove and other viewers: poses, tf, "
              "images, calibration, points, grid, boxes and predictions.",
              "OUTDIR", "Folder of a finished replay", "X.mcap"},
             options, more)) {
    return program::kDone;
  }
  program::requireWritable(options.output, options.overwrite);
  const fs::path folder(options.input);
  const auto note = [&](const std::string& text) {
    if (!options.quiet) std::cerr << "headway-export: " << printable(text) << '\n';
  };
  report::ReplayFrameOptions reading;
  reading.past_s = 0.0;
  const auto frames = report::readReplayFrames(folder, reading, note);
  std::optional<StereoCamera> camera;
  if (fs::exists(folder / "calibration.yaml")) {
    camera = io::readCalibration(folder / "calibration.yaml");
  }
  std::optional<report::RecordedImages> images;
  if (camera && !without_images) {
    images.emplace(report::readReplayInput(folder), frames.front().frame, note);
  }
  program::catchInterrupts();
  McapWriter mcap(options.output);
  Topic<foxglove::PosesInFrame>("/path", mcap).write(frames.front().time, pathOf(frames));
  writeMap(folder, frames.front().time, mcap);
  FrameTopics topics(camera, mcap);
  program::Progress progress("frames", options.quiet);
  std::size_t done = 0;
  for (const auto& frame : frames) {
    if (program::interrupted()) break;
    topics.write(frame, images ? images->at(frame.frame) : cv::Mat());
    ++done;
    progress.update(done, static_cast<double>(done) / static_cast<double>(frames.size()));
  }
  progress.finish();
  mcap.finish();
  if (!options.quiet)
    std::cout << printable(options.output) << ": " << done << " frames" << std::endl;
  return program::kDone;
}

}  // namespace headway::exporting
