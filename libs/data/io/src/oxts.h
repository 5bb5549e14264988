// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/dataset.h>

#include <string>
#include <vector>

namespace headway::io {

/// One packet of KITTI's GNSS and inertial unit. The unit's axes are x forward, y left, z up.
struct OxtsPacket {
  Time time = 0.0;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< of the unit; yaw 0 is east, positive left [rad]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< east, north, up [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< unit's axes [m/s^2]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< unit's axes [rad/s]
  int satellites = 0;
  double position_sigma_m = 0.0;  ///< as the unit states it; 0: unknown
};

/// Reads `data/NNNNNNNNNN.txt` (30 values each) and `timestamps.txt` of a folder `oxts`, in time
/// order.
///
/// @param dropped  counts packets without a time, and packets whose time does not increase
///                 ("oxts_without_time", "oxts_time_backwards")
/// @throws InputError naming file and line of an error
[[nodiscard]] std::vector<OxtsPacket> readOxts(const std::string& folder,
                                               std::map<std::string, std::size_t>& dropped);

/// Poses of the unit, in a frame with x east, y north, z up.
///
/// kPositions: Mercator projection at the scale of the first packet's latitude; kVelocities:
/// velocities integrated by the trapezoidal rule, from the origin.
///
/// @see Geiger et al. 2013, "Vision meets robotics: the KITTI dataset", Sec. III-A and its raw data
///      development kit
[[nodiscard]] std::vector<Stamped<Pose>> oxtsPath(const std::vector<OxtsPacket>& packets,
                                                  OxtsPath path);

/// The pose at a time, interpolated between packets, or extrapolated by up to 0.05 s; nullopt in
/// gaps of more than 0.3 s and beyond.
[[nodiscard]] std::optional<Pose> oxtsPoseAt(const std::vector<Stamped<Pose>>& path, Time time);

/// The times of a KITTI raw `timestamps.txt`: one row "YYYY-MM-DD hh:mm:ss.sss" per frame, UTC.
///
/// @throws InputError naming file and line of an error
[[nodiscard]] std::vector<Time> readKittiTimestamps(const std::string& path);

}  // namespace headway::io
