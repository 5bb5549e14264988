// SPDX-License-Identifier: BSD-3-Clause
#include "foxglove_messages.h"

#include <headway/core/ellipse.h>
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/io/image_file.h>

#include <cmath>
#include <cstring>
#include <opencv2/imgcodecs.hpp>

namespace headway::exporting {
namespace {

using report::ReplayFrame;

constexpr char kMap[] = "map", kOdom[] = "odom", kRobot[] = "base_link", kCamera[] = "camera";
constexpr std::size_t kMaxPathPoses = 5000;
constexpr int kEllipseSides = 24;
constexpr double kLineWidthM = 0.12;
// Grey levels of a map server's picture: 254 free, 205 unknown, 0 occupied.
constexpr int kFreeAbove = 230, kOccupiedBelow = 100;

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

}  // namespace

std::uint64_t nanoseconds(Time time) {
  return time > 0.0 ? static_cast<std::uint64_t>(std::llround(time * 1e6)) * 1000U : 0U;
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

foxglove::PosesInFrame pathOf(const std::vector<ReplayFrame>& frames) {
  foxglove::PosesInFrame path;
  setHeader(frames.front().time, kMap, path);
  const std::size_t step = 1 + (frames.size() - 1) / kMaxPathPoses;
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
      const bool is_free = level > kFreeAbove, is_occupied = level < kOccupiedBelow;
      const unsigned char shade = is_free ? 200 : 40;
      for (int i = 0; i < 3; ++i) bytes += static_cast<char>(shade);
      bytes += static_cast<char>(is_free ? 110 : is_occupied ? 230 : 0);
    }
  }
  return grid;
}

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

}  // namespace headway::exporting
