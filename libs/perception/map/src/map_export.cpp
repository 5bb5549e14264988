// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/byte_archive.h>
#include <headway/core/mrpt_pose.h>
#include <headway/core/output_file.h>
#include <headway/map/map_export.h>
#include <headway/map/object_file.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <cmath>
#include <unordered_map>

#include "pose_pdf.h"

namespace headway::map {
namespace {

using PositionById = std::unordered_map<LandmarkId, Eigen::Vector3d>;

/// A range scan with points only. CObservationPointCloud is not used, because MRPT before 2.11
/// ignores the robot's pose when it builds a map from it.
mrpt::obs::CObservation3DRangeScan::Ptr scanOf(const slam::KeyframeView& keyframe,
                                               const PositionById& positions) {
  const Pose T_robot_map = keyframe.T_map_robot.inverse();
  auto scan = mrpt::obs::CObservation3DRangeScan::Create();
  scan->sensorLabel = "landmarks";
  scan->timestamp = mrpt::Clock::fromDouble(keyframe.time);
  scan->hasPoints3D = true;
  scan->hasRangeImage = false;
  scan->resizePoints3DVectors(keyframe.landmarks.size());
  std::size_t count = 0;
  for (const auto id : keyframe.landmarks) {
    const auto position = positions.find(id);
    if (position == positions.end()) continue;  // culled since then
    const Eigen::Vector3f p = (T_robot_map * position->second).cast<float>();
    scan->points3D_x[count] = p.x();
    scan->points3D_y[count] = p.y();
    scan->points3D_z[count] = p.z();
    ++count;
  }
  scan->resizePoints3DVectors(count);
  return scan;
}

}  // namespace

void writeSimpleMap(const std::string& path, const slam::MapView& static_map) {
  PositionById positions;
  for (const auto& landmark : static_map.landmarks) positions[landmark.id] = landmark.position;
  mrpt::maps::CSimpleMap simple_map;
  for (const auto& keyframe : static_map.keyframes) {
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(scanOf(keyframe, positions));
    simple_map.insert(mrpt::poses::CPose3DPDFGaussian::Create(
                          toMrptPdf(keyframe.T_map_robot, keyframe.covariance)),
                      frame);
  }
  writeObject(path, simple_map);
}

/// Hand-written because MRPT's saveToPlyFile omits colours and adds an empty list of faces.
void writePly(const std::string& path, const slam::MapView& static_map) {
  OutputFile file(path);
  file.stream()
      << "ply\nformat binary_little_endian 1.0\ncomment landmarks of headway, map frame, metres\n"
      << "element vertex " << static_map.landmarks.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
      << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  ByteWriter vertices;
  for (const auto& landmark : static_map.landmarks) {
    vertices.matrix(landmark.position.cast<float>());
    vertices.value(static_cast<float>(landmark.intensity) / 255.f);
    for (int channel = 0; channel < 3; ++channel) vertices.value(landmark.intensity);
  }
  file.stream() << vertices.bytes;
  file.commit();
}

void writePly(const std::string& path, const mrpt::maps::CPointsMap& points) {
  OutputFile file(path);
  file.stream() << "ply\nformat binary_little_endian 1.0\n"
                << "comment dense static map of headway, map frame, metres\nelement vertex "
                << points.size() << "\nproperty float x\nproperty float y\nproperty float z\n"
                << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  constexpr std::size_t kPiece = 1U << 20U;
  ByteWriter vertices;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Array3f place, colour;
    points.getPointRGB(i, place.x(), place.y(), place.z(), colour.x(), colour.y(), colour.z());
    vertices.matrix(place.matrix());
    for (const float channel : colour) {
      vertices.value(static_cast<std::uint8_t>(std::lround(255.0F * channel)));
    }
    if (vertices.bytes.size() < kPiece) continue;
    file.stream() << vertices.bytes;
    vertices.bytes.clear();
  }
  file.stream() << vertices.bytes;
  file.commit();
}

}  // namespace headway::map
