#pragma once

namespace headway::test {

// Accuracy that the whole system must reach, in one place. Greater is worse.

inline constexpr double kStreetAteM = 0.10;      ///< rawlogs/street.rawlog
inline constexpr std::size_t kStreetMovers = 4;  ///< tracked, found moving and predicted
inline constexpr double kKitti06AteM = 0.08;     ///< KITTI odometry 06, frames 0-50
inline constexpr double kKitti01AteM = 1.3;      ///< KITTI odometry 01, frames 0-50
inline constexpr double kEurocMh01AteM = 0.008;  ///< EuRoC MH_01, first 200 pairs
inline constexpr double kSharedFrameM = 0.10;    ///< between two drives at the same place

}  // namespace headway::test
