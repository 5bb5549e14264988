// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace headway::io {

/// The stereo or depth camera among the observations of a rawlog.
struct CameraChoice {
  enum class Kind {
    kNone,    ///< no camera: the rawlog contains poses
    kStereo,  ///< `CObservationStereoImages` with the first label
    kPair,    ///< two `CObservationImage` labels, left and right
    kDepth,   ///< `CObservation3DRangeScan` with the first label
  };
  Kind kind = Kind::kNone;
  std::array<std::string, 2> labels;
};

/// Determines the camera from the first observations of a rawlog: a stereo camera, else two images,
/// else a depth camera.
class CameraProbe {
 public:
  /// @param wanted  label of the camera, or two labels "LEFT,RIGHT"; empty: the only one
  explicit CameraProbe(std::string wanted) : wanted_(std::move(wanted)) {}

  void add(const mrpt::obs::CObservation& observation);

  /// Whether further observations cannot change the result of choose().
  [[nodiscard]] bool isDecided() const;

  /// @param skipped  other observations, for messages
  /// @throws InputError if there is neither a stereo camera nor a pose, several stereo cameras
  ///         without a selection, or not the selected one
  [[nodiscard]] CameraChoice choose(const std::map<std::string, std::size_t>& skipped) const;

 private:
  [[nodiscard]] std::optional<CameraChoice> wantedCamera() const;
  [[nodiscard]] CameraChoice pairByGeometry() const;
  [[nodiscard]] std::string labelsSeen(const std::map<std::string, std::size_t>& skipped) const;

  struct Camera {
    std::size_t count = 0;
    mrpt::poses::CPose3D pose;  ///< on the robot
  };

  std::string wanted_;
  std::map<std::string, std::size_t> stereo_;  ///< label -> observations
  std::map<std::string, Camera> single_;
  std::map<std::string, std::size_t> depth_;  ///< as stereo_, with intensity and depth
  std::size_t poses_ = 0;
};

}  // namespace headway::io
