// SPDX-License-Identifier: BSD-3-Clause
// A simulated rawlog and its truth on disk.
#pragma once

#include <headway/sim/simulator.h>

#include <memory>
#include <string>

namespace headway::sim {

/// What else is written beside a rawlog.
struct RecordingOptions {
  bool masks = false;  ///< truth/masks/NNNNNN.png: 255 where an actor (not a parked one) is seen
  bool depth = false;  ///< truth/depth/NNNNNN.png: 16-bit, depth * 256 [m], 0 unknown (KITTI's)
};

/// Writes simulated frames as a rawlog, and their truth into `NAME.truth/` beside it.
///
/// What was written before an error or an interrupt stays readable; close() completes the files.
class Recording {
 public:
  /// @param path       of the rawlog
  /// @param world_ini  parameters as used, kept as `world.ini`
  /// @throws InputError if something cannot be written
  Recording(const std::string& path, const RecordingParams& params, const RecordingOptions& options,
            const StereoCamera& camera, const io::RawStereoCamera& recorded,
            const std::string& world_ini);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  void write(const SimFrame& frame);
  /// @throws InputError on a write error
  void close();

 private:
  class Files;
  std::unique_ptr<Files> files_;
};

/// The images of a frame as drivers of its camera give them: label `stereo` or `rgbd`.
///
/// @param camera         as recorded
/// @param depth_reach_m  of a depth camera: maximum depth measured [m]
[[nodiscard]] std::shared_ptr<mrpt::obs::CObservation> observationOf(
    const SimFrame& frame, const io::RawStereoCamera& camera, double depth_reach_m);

/// Folder of the truth beside a rawlog: `a/NAME.rawlog` -> `a/NAME.truth`.
[[nodiscard]] std::string truthFolder(const std::string& rawlog);

/// Megabytes that a recording of so many frames takes, estimated from its first frames.
///
/// @param frames  drawn so far, at least one
[[nodiscard]] double estimateMegabytes(const std::vector<SimFrame>& frames,
                                       const RecordingParams& params,
                                       const RecordingOptions& options, std::size_t total);

}  // namespace headway::sim
