// SPDX-License-Identifier: BSD-3-Clause
// Files of the map for other programs: simplemap, PLY, grids for MRPT and map servers.
#include <headway/core/byte_archive.h>
#include <headway/core/compression.h>
#include <headway/core/mrpt_pose.h>
#include <headway/core/output_file.h>
#include <headway/map/map_export.h>
#include <mrpt/core/Clock.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <unordered_map>
#include <utility>
#include <vector>

namespace headway::map {

void writeObject(const std::string& path, const mrpt::serialization::CSerializable& object) {
  OutputFile file(path);
  mrpt::io::CMemoryStream bytes;
  mrpt::serialization::archiveFrom(bytes) << object;
  Compressor content(file.stream(), Compression::kGzip);
  content.write({static_cast<const char*>(bytes.getRawBufferData()), bytes.getTotalBytesCount()});
  content.finish();
  file.commit();
}

namespace {

/// d(yaw, pitch, roll) / d(rotation in body axes), rotation = Rz(yaw) Ry(pitch) Rx(roll).
/// @see Diebel 2006, "Representing Attitude", eq. 78 for this order of rotations
Eigen::Matrix3d eulerRates(double pitch, double roll) {
  const double cos_pitch =
      std::copysign(std::max(std::abs(std::cos(pitch)), 1e-6), std::cos(pitch));
  const double tan_pitch = std::sin(pitch) / cos_pitch;
  Eigen::Matrix3d rates;
  rates << 0.0, std::sin(roll) / cos_pitch, std::cos(roll) / cos_pitch,  //
      0.0, std::cos(roll), -std::sin(roll),                              //
      1.0, std::sin(roll) * tan_pitch, std::cos(roll) * tan_pitch;
  return rates;
}

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

/// Hand-written because MRPT's saveToPlyFile omits colours and adds an empty list of faces.
///
/// @param about       the points, with their frame and unit
/// @param properties  further than x, y and z, before red, green and blue
template <typename WriteVertices>
void writePly(const std::string& path, const char* about, const char* properties, std::size_t size,
              const WriteVertices& write_vertices) {
  OutputFile file(path);
  file.stream() << "ply\nformat binary_little_endian 1.0\ncomment " << about
                << ", map frame, metres\nelement vertex " << size
                << "\nproperty float x\nproperty float y\nproperty float z\n"
                << properties
                << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  write_vertices(file.stream());
  file.commit();
}

// Grey levels of ROS' map_server.
enum Grey : std::uint8_t { kOccupied = 0, kUnknown = 205, kFree = 254 };

Grey greyOf(float free_probability) {
  if (free_probability > static_cast<float>(1.0 - kMaxFree)) return kFree;
  return free_probability < static_cast<float>(1.0 - kMinOccupied) ? kOccupied : kUnknown;
}

void writePicture(const std::string& path, const mrpt::maps::COccupancyGridMap2D& grid) {
  const int width = static_cast<int>(grid.getSizeX());
  const int height = static_cast<int>(grid.getSizeY());
  cv::Mat_<std::uint8_t> picture(height, width);
  for (int y = 0; y < height; ++y) {
    auto* row = picture[height - 1 - y];
    for (int x = 0; x < width; ++x) row[x] = greyOf(grid.getCell(x, y));
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", picture, png);
  writeFile(path, {reinterpret_cast<const char*>(png.data()), png.size()});
}

void writeDescription(const std::string& path, const std::string& picture,
                      const mrpt::maps::COccupancyGridMap2D& grid) {
  std::ostringstream text;
  text << "image: " << picture << "\nresolution: " << grid.getResolution() << "\norigin: ["
       << grid.getXMin() << ", " << grid.getYMin()
       << ", 0.0]\nnegate: 0\noccupied_thresh: " << kMinOccupied << "\nfree_thresh: " << kMaxFree
       << "\n";
  writeFile(path, text.str());
}

}  // namespace

mrpt::poses::CPose3DPDFGaussian toMrptPdf(const Pose& T_map_robot,
                                          const PoseCovariance& covariance) {
  mrpt::poses::CPose3DPDFGaussian pdf;
  pdf.mean = toMrpt(T_map_robot);
  PoseCovariance jacobian = PoseCovariance::Zero();
  jacobian.topLeftCorner<3, 3>() = T_map_robot.linear();
  jacobian.bottomRightCorner<3, 3>() = eulerRates(pdf.mean.pitch(), pdf.mean.roll());
  const PoseCovariance mapped = jacobian * covariance * jacobian.transpose();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) pdf.cov(row, column) = mapped(row, column);
  }
  return pdf;
}

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

void writePly(const std::string& path, const slam::MapView& static_map) {
  const auto& landmarks = static_map.landmarks;
  writePly(path, "landmarks of headway", "property float intensity\n", landmarks.size(),
           [&](std::ostream& out) {
             for (const auto& landmark : landmarks) {
               ByteWriter vertex;
               vertex.matrix(landmark.position.cast<float>());
               vertex.value(static_cast<float>(landmark.intensity) / 255.f);
               for (int channel = 0; channel < 3; ++channel) vertex.value(landmark.intensity);
               out << vertex.bytes;
             }
           });
}

void writePly(const std::string& path, const mrpt::maps::CPointsMap& points) {
  writePly(path, "dense static map of headway", "", points.size(), [&](std::ostream& out) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      Eigen::Array3f place, colour;
      points.getPointRGB(i, place.x(), place.y(), place.z(), colour.x(), colour.y(), colour.z());
      ByteWriter vertex;
      vertex.matrix(place.matrix());
      for (const float channel : colour) {
        vertex.value(static_cast<std::uint8_t>(std::lround(255.0F * channel)));
      }
      out << vertex.bytes;
    }
  });
}

void writeStaticGrid(const std::string& prefix, const mrpt::maps::COccupancyGridMap2D& grid) {
  writeObject(prefix + ".gridmap.gz", grid);
  writePicture(prefix + ".png", grid);
  writeDescription(prefix + ".yaml", std::filesystem::path(prefix).filename().string() + ".png",
                   grid);
}

void writeMapLayers(const std::filesystem::path& folder, const PerceptionMap& map,
                    const std::string& suffix) {
  if (const auto grid = map.staticGrid()) writeStaticGrid(folder / ("map_grid" + suffix), *grid);
  writePly(folder / ("map_points" + suffix + ".ply"), *map.staticMap());
  if (const auto& dense = map.dense()) writePly(folder / ("map_dense" + suffix + ".ply"), *dense);
}

void writeMapFiles(const std::filesystem::path& folder, StoredMap stored) {
  writeMapLayers(folder, stored.map);
  writeSimpleMap(folder / "map.simplemap", *stored.map.staticMap());
  saveMap(folder / "map.headway", std::move(stored));
}

}  // namespace headway::map
