// SPDX-License-Identifier: BSD-3-Clause
// Which observations of a recording are used: those of the one camera, boxes, poses and sensors of
// motion.
#pragma once

#include <headway/core/log.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "observation_stream.h"

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

/// Selects the observations that frames are assembled from; others are counted by reason.
class UsefulObservations {
 public:
  /// @param skipped  counts "truth", "no_time", and other observations by class name
  UsefulObservations(std::unique_ptr<ObservationReader> reader, const RawlogSourceOptions& options,
                     std::map<std::string, std::size_t>& skipped)
      : reader_(std::move(reader)),
        options_(options),
        skipped_(skipped),
        probe_(options.sensor_label) {}

  /// Reads until the camera is determined. The observations read are returned by next(); if they
  /// are many, only the latest images, motions and scans, and the others are counted.
  ///
  /// @throws InputError as CameraProbe::choose(), with the reason if the recording is truncated
  [[nodiscard]] CameraChoice findCamera();

  /// Reads on until the camera is determined or the reader has no observation at present.
  ///
  /// @return whether chooseCamera() is final
  [[nodiscard]] bool readForCamera();
  /// The camera by the observations read so far. @throws InputError as findCamera()
  [[nodiscard]] CameraChoice chooseCamera() const;

  /// The next observation; null at the end.
  [[nodiscard]] mrpt::obs::CObservation::Ptr next();

  [[nodiscard]] const std::optional<std::string>& truncation() const {
    return reader_->truncation();
  }
  [[nodiscard]] double progress() const { return reader_->progress(); }
  /// What the recording says of itself.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }

 private:
  [[nodiscard]] mrpt::obs::CObservation::Ptr read();
  [[nodiscard]] bool isUseful(const mrpt::obs::CObservation& observation) const;
  void keep(const mrpt::obs::CObservation::Ptr& observation);
  void keepLast(std::size_t max_count, bool (*of_kind)(const mrpt::obs::CObservation&));

  /// Numbers of observations stored until the camera is determined, at most: some seconds of each.
  struct Limits {
    std::size_t images = 16, motions = 2000, laser_scans = 50, gnss = 1000;
  };

  Limits limits_;
  std::unique_ptr<ObservationReader> reader_;
  RawlogSourceOptions options_;
  std::map<std::string, std::size_t>& skipped_;
  CameraProbe probe_;
  Warnings warnings_;
  std::deque<mrpt::obs::CObservation::Ptr> kept_;  ///< read by findCamera(), for next()
};

inline constexpr char kDetectionsLabel[] = "detections";       ///< input of tracking
inline constexpr char kPoseLabel[] = "pose";                   ///< used instead of SLAM
inline constexpr char kTruthPoseLabel[] = "truth_pose";        ///< for evaluation only
inline constexpr char kTruthObjectsLabel[] = "truth_objects";  ///< for evaluation only

/// Whether the observation is truth, which must not reach any estimator.
[[nodiscard]] inline bool isTruth(const std::string& label) {
  return label.rfind("truth_", 0) == 0;
}

/// Whether it is the mark of RawlogSink::writeTimesAssumed().
[[nodiscard]] bool isTimesAssumed(const mrpt::obs::CObservation& observation);

/// Whether it is a robot pose to use instead of visual SLAM.
[[nodiscard]] bool isRecordedPose(const mrpt::obs::CObservation& observation);

/// Whether it contains boxes for tracking.
[[nodiscard]] bool isRecordedDetections(const mrpt::obs::CObservation& observation);

template <typename Kind>
[[nodiscard]] bool isKind(const mrpt::obs::CObservation& observation) {
  return dynamic_cast<const Kind*>(&observation) != nullptr;
}

[[nodiscard]] inline bool isImage(const mrpt::obs::CObservation& observation) {
  return isKind<mrpt::obs::CObservationStereoImages>(observation) ||
         isKind<mrpt::obs::CObservationImage>(observation) ||
         isKind<mrpt::obs::CObservation3DRangeScan>(observation);
}

/// Whether a pair is complete, which MRPT's driver for image folders does not mark.
[[nodiscard]] inline bool hasRightImage(const mrpt::obs::CObservationStereoImages& stereo) {
  return stereo.hasImageRight || !stereo.imageRight.isEmpty();
}

/// Whether it measures the robot's motion.
[[nodiscard]] inline bool isMotion(const mrpt::obs::CObservation& observation) {
  return isKind<mrpt::obs::CObservationOdometry>(observation) ||
         isKind<mrpt::obs::CObservationIMU>(observation);
}

[[nodiscard]] inline bool isLaser(const mrpt::obs::CObservation& observation) {
  return isKind<mrpt::obs::CObservation2DRangeScan>(observation);
}

/// Whether it is of a satellite receiver.
[[nodiscard]] inline bool isGnss(const mrpt::obs::CObservation& observation) {
  return isKind<mrpt::obs::CObservationGPS>(observation);
}

}  // namespace headway::io
