// SPDX-License-Identifier: BSD-3-Clause
// Results as serialised messages of ROS 2.
#include "outgoing_messages.h"

#include <headway/core/object_class.h>
#include <headway/map/map_export.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ratio>

#include "cdr_writer.h"

namespace headway::ros2 {
namespace {

void writeTime(CdrWriter& out, std::int64_t time_ns) {
  const std::int64_t second = std::nano::den;
  const std::int64_t rest = (time_ns % second + second) % second;  // of times before 1970, too
  out.number(static_cast<std::int32_t>((time_ns - rest) / second));
  out.number(static_cast<std::uint32_t>(rest));
}

void write(CdrWriter& out, const MessageHeader& header) {
  writeTime(out, header.time_ns);
  out.text(header.frame);
}

void write(CdrWriter& out, const Eigen::Vector3d& vector) {
  for (const double value : {vector.x(), vector.y(), vector.z()}) out.number(value);
}

void write(CdrWriter& out, const Pose& pose) {
  const Eigen::Quaterniond q = quaternionOf(pose);
  write(out, Eigen::Vector3d(pose.translation()));
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) out.number(value);
}

template <typename Matrix>
void writeRows(CdrWriter& out, const Matrix& matrix) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) out.number(matrix(row, column));
  }
}

void write(CdrWriter& out, Colour colour, double opacity) {
  for (const auto part : {colour.red, colour.green, colour.blue}) {
    out.number(static_cast<float>(part) / 255.0F);
  }
  out.number(static_cast<float>(opacity));
}

Pose boxOf(const Track& track) {
  Pose pose = Pose::Identity();
  pose.translation() = track.position;
  pose.linear() = Eigen::AngleAxisd(track.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

std::vector<const Track*> shownOf(const std::vector<Track>& tracks) {
  std::vector<const Track*> shown;
  for (const Track& track : tracks) {
    if (isShown(track)) shown.push_back(&track);
  }
  return shown;
}

void writeGridHeader(CdrWriter& out, const MessageHeader& header, double cell_m, std::size_t width,
                     std::size_t height, const Eigen::Vector2d& corner) {
  Pose origin = Pose::Identity();
  origin.translation().head<2>() = corner;
  write(out, header);
  writeTime(out, header.time_ns);  // when the map was loaded
  out.number(static_cast<float>(cell_m));
  out.length(width);
  out.length(height);
  write(out, origin);
  out.length(width * height);
}

/// The layout of a cloud of floats, before its bytes.
void writeCloudHeader(CdrWriter& out, const MessageHeader& header, std::size_t points,
                      std::initializer_list<const char*> fields) {
  const std::size_t step = sizeof(float) * fields.size();
  write(out, header);
  out.length(1);
  out.length(points);
  out.length(fields.size());
  std::uint32_t offset = 0;
  for (const char* name : fields) {
    out.text(name);
    out.number(offset);
    out.number(std::uint8_t{7});  // FLOAT32
    out.number(std::uint32_t{1});
    offset += sizeof(float);
  }
  out.flag(false);  // little-endian
  out.length(step);
  out.length(step * points);
  out.length(step * points);
  out.reserve(step * points + 1);
}

enum MarkerType : std::int32_t { kCube = 1, kLineStrip = 4, kText = 9 };

/// A marker that vanishes if it is not replaced; without points, colours, textures and meshes.
struct Marker {
  const char* ns = "";
  std::int32_t id = 0;
  MarkerType type = kCube;
  Pose pose = Pose::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Zero();
  Colour colour;
  double opacity = 1.0;
  std::vector<Eigen::Vector3d> points;
  std::string text;
};

void write(CdrWriter& out, const MessageHeader& header, const Marker& marker) {
  write(out, header);
  out.text(marker.ns);
  out.number(marker.id);
  out.number(static_cast<std::int32_t>(marker.type));
  out.number(std::int32_t{0});  // add
  write(out, marker.pose);
  write(out, marker.scale);
  write(out, marker.colour, marker.opacity);
  writeTime(out, 500'000'000);  // lifetime
  out.flag(false);
  out.length(marker.points.size());
  for (const auto& point : marker.points) write(out, point);
  out.length(0);  // colours
  out.text("");   // texture, with its image and coordinates
  write(out, MessageHeader{});
  out.text("");
  out.length(0);
  out.length(0);
  out.text(marker.text);
  out.text("");  // mesh, with its file
  out.text("");
  out.length(0);
  out.flag(false);
}

std::vector<Marker> markersOf(const Track& track) {
  Marker box;
  box.ns = "boxes";
  box.id = static_cast<std::int32_t>(track.id.value);
  box.pose = boxOf(track);
  box.scale = track.size;
  box.colour = colourOf(track.object_class);
  box.opacity = isMoving(track) ? 0.6 : 0.3;
  Marker name = box;
  name.ns = "names";
  name.type = kText;
  name.pose.translation().z() += 0.5 * track.size.z() + 0.3;
  name.scale = {0.0, 0.0, 0.3};
  name.opacity = 1.0;
  name.text = std::string(displayName(track.object_class)) + " " + std::to_string(track.id.value);
  std::vector<Marker> markers{box, name};
  if (!isMoving(track) || track.predictions.empty()) return markers;
  Marker path = box;
  path.ns = "predictions";
  path.type = kLineStrip;
  path.pose = Pose::Identity();
  path.scale = {0.05, 0.0, 0.0};
  path.opacity = 1.0;
  path.points.push_back(track.position);
  for (const auto& point : track.predictions.front().points) path.points.push_back(point.position);
  markers.push_back(path);
  return markers;
}

}  // namespace

MessageHeader headerOf(Time time, const std::string& frame) {
  const double second = std::floor(time);  // a product of the whole time has 128 ns of rounding
  return {static_cast<std::int64_t>(second) * std::nano::den + std::llround(1e9 * (time - second)),
          frame};
}

std::string clockMessage(Time time) {
  CdrWriter out;
  writeTime(out, headerOf(time, "").time_ns);
  return out.take();
}

std::string transformMessage(const std::vector<bags::TransformMessage>& transforms) {
  CdrWriter out;
  out.length(transforms.size());
  for (const bags::TransformMessage& transform : transforms) {
    write(out, transform.header);
    out.text(transform.child_frame);
    write(out, transform.T_parent_child);
  }
  return out.take();
}

std::string odometryMessage(const OdometrySample& sample) {
  CdrWriter out;
  write(out, headerOf(sample.time, sample.frame));
  out.text(sample.child);
  write(out, sample.T_odom_robot);
  PoseCovariance axes = PoseCovariance::Zero();  // ROS has it in the axes of the frame
  axes.topLeftCorner<3, 3>() = axes.bottomRightCorner<3, 3>() = sample.T_odom_robot.linear();
  writeRows(out, PoseCovariance(axes * sample.covariance * axes.transpose()));
  write(out, sample.velocity);
  write(out, sample.angular_velocity);
  writeRows(out, PoseCovariance(PoseCovariance::Zero()));  // of the velocities: unknown
  return out.take();
}

std::string gridMessage(const GridMessage& grid) {
  CdrWriter out;
  writeGridHeader(out, grid.header, grid.cell_m, grid.width, grid.height, grid.corner);
  out.append(grid.cells.data(), grid.cells.size());
  return out.take();
}

std::string gridMessage(const MessageHeader& header, const mrpt::maps::COccupancyGridMap2D& grid) {
  CdrWriter out;
  const auto width = grid.getSizeX(), height = grid.getSizeY();
  writeGridHeader(out, header, grid.getResolution(), width, height,
                  {grid.getXMin(), grid.getYMin()});
  out.reserve(static_cast<std::size_t>(width) * height);
  std::vector<std::int8_t> row(width);
  for (unsigned y = 0; y < height; ++y) {
    for (unsigned x = 0; x < width; ++x) {
      const float occupied = 1.0F - grid.getCell(static_cast<int>(x), static_cast<int>(y));
      const bool is_known = occupied < map::kMaxFree || occupied > map::kMinOccupied;
      row[x] = static_cast<std::int8_t>(!is_known ? -1 : occupied < 0.5F ? 0 : 100);
    }
    out.append(row.data(), row.size());
  }
  return out.take();
}

std::string cloudMessage(const MessageHeader& header, const std::vector<Eigen::Vector3f>& points) {
  CdrWriter out;
  writeCloudHeader(out, header, points.size(), {"x", "y", "z"});
  out.append(points.data(), points.size() * sizeof(Eigen::Vector3f));
  out.flag(true);  // no point is invalid
  return out.take();
}

std::string cloudMessage(const MessageHeader& header,
                         const mrpt::maps::CColouredPointsMap& points) {
  CdrWriter out;
  writeCloudHeader(out, header, points.size(), {"x", "y", "z", "rgb"});
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<float, 6> p{};
    points.getPointRGB(i, p[0], p[1], p[2], p[3], p[4], p[5]);
    std::uint32_t rgb = 0;
    for (std::size_t part = 3; part < 6; ++part) {
      const long level = std::lround(255.0F * std::clamp(p[part], 0.0F, 1.0F));
      rgb = rgb << 8U | static_cast<std::uint32_t>(level);
    }
    out.append(p.data(), 3 * sizeof(float));
    out.append(&rgb, sizeof rgb);  // the bytes of a float, as PCL has them
  }
  out.flag(true);
  return out.take();
}

std::string detectionMessage(const MessageHeader& header, const std::vector<Track>& tracks) {
  CdrWriter out;
  const auto shown = shownOf(tracks);
  write(out, header);
  out.length(shown.size());
  for (const Track* track : shown) {
    PoseCovariance covariance = PoseCovariance::Zero();
    covariance.topLeftCorner<3, 3>() = track->position_covariance;
    write(out, header);
    out.length(1);
    out.text(toString(track->object_class));
    out.number(track->score);
    write(out, boxOf(*track));
    writeRows(out, covariance);
    write(out, boxOf(*track));
    write(out, track->size);
    out.text(std::to_string(track->id.value));
  }
  return out.take();
}

std::string obstacleMessage(const MessageHeader& header, const std::vector<Track>& tracks) {
  CdrWriter out;
  const auto shown = shownOf(tracks);
  write(out, header);
  out.length(shown.size());
  for (const Track* track : shown) {
    std::array<std::uint8_t, 16> uuid{};  // of the track, the same in all frames
    for (std::size_t i = 0; i < sizeof track->id.value; ++i) {
      uuid[15 - i] = static_cast<std::uint8_t>(track->id.value >> (8 * i));
    }
    Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
    velocity_covariance.topLeftCorner<2, 2>() = track->velocity_covariance;
    out.append(uuid.data(), uuid.size());
    out.number(static_cast<float>(track->score));
    write(out, track->position);
    write(out, track->velocity);
    write(out, track->size);
    writeRows(out, track->position_covariance);
    writeRows(out, velocity_covariance);
  }
  return out.take();
}

std::string markerMessage(const MessageHeader& header, const std::vector<Track>& tracks) {
  CdrWriter out;
  std::vector<Marker> markers;
  for (const Track* track : shownOf(tracks)) {
    for (auto& marker : markersOf(*track)) markers.push_back(std::move(marker));
  }
  out.length(markers.size());
  for (const Marker& marker : markers) write(out, header, marker);
  return out.take();
}

std::string diagnosticMessage(Time time, const std::vector<DiagnosticLine>& lines) {
  CdrWriter out;
  write(out, headerOf(time, ""));
  out.length(lines.size());
  for (const DiagnosticLine& line : lines) {
    out.number(static_cast<std::uint8_t>(line.level));
    out.text(line.name);
    out.text(line.message);
    out.text("");
    out.length(line.values.size());
    for (const auto& [key, value] : line.values) {
      out.text(key);
      out.text(value);
    }
  }
  return out.take();
}

}  // namespace headway::ros2
