#pragma once

#include <mrpt/obs/CObservation.h>

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace headway::io {

/// Which observations of a rawlog are the stereo camera.
struct CameraChoice {
  enum class Kind {
    kNone,    ///< no camera: the rawlog holds poses
    kStereo,  ///< `CObservationStereoImages` with the first label
    kPair,    ///< two `CObservationImage` labels, left and right
  };
  Kind kind = Kind::kNone;
  std::array<std::string, 2> labels;
};

/// Looks at the beginning of a rawlog until it is clear what its stereo camera is.
class CameraProbe {
 public:
  /// @param wanted  label of the stereo camera, or two labels "LEFT,RIGHT"; empty: the only one
  explicit CameraProbe(std::string wanted) : wanted_(std::move(wanted)) {}

  void add(const mrpt::obs::CObservation& observation);

  /// Whether choose() would say the same after more observations.
  [[nodiscard]] bool isDecided() const;

  /// @param skipped  what else there is, for messages
  /// @throws InputError if there is no stereo camera and no pose, several stereo cameras and none
  ///         wanted, or not the one that is wanted
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
  std::size_t poses_ = 0;
};

}  // namespace headway::io
