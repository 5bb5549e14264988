// SPDX-License-Identifier: BSD-3-Clause
// Detections as an MRPT observation.
#pragma once

#include <headway/core/detection.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway {

/// Detections in one image, as stored in MRPT rawlogs.
///
/// Boxes are those of `Detection`: 2D ones in pixels of the image as recorded, 3D ones in the
/// sensor's optical frame, their position being the centre of the volume. Classes are stored
/// by name, so that rawlogs with classes of newer versions remain readable.
class CObservationObjectDetections : public mrpt::obs::CObservation {
  DEFINE_SERIALIZABLE(CObservationObjectDetections, headway)
 public:
  /// One detection.
  struct Item {
    std::string class_name;         ///< KITTI's spelling
    double score = 1.0;             ///< the detector's own scale
    std::int64_t detector_id = -1;  ///< -1: none
    std::optional<Box2d> box2d;
    std::optional<Box3d> box3d;
    std::optional<Eigen::Matrix3d> centre_covariance;  ///< symmetric [m^2]
  };

  mrpt::poses::CPose3D sensor_pose;  ///< the optical frame on the robot
  std::uint32_t image_width = 0;     ///< [px], 0 unknown
  std::uint32_t image_height = 0;    ///< [px], 0 unknown
  std::vector<Item> items;

  void getSensorPose(mrpt::poses::CPose3D& out_sensorPose) const override {
    out_sensorPose = sensor_pose;
  }
  void setSensorPose(const mrpt::poses::CPose3D& newSensorPose) override {
    sensor_pose = newSensorPose;
  }
  void getDescriptionAsText(std::ostream& o) const override;
  /// One row per observation: the number of detections, followed by their values.
  bool exportTxtSupported() const override { return true; }
  std::string exportTxtHeader() const override;
  std::string exportTxtDataRow() const override;
};

namespace io {

/// Registers headway's observation class with MRPT. May be called repeatedly.
void registerClasses();

[[nodiscard]] CObservationObjectDetections::Ptr observationFrom(const std::string& label,
                                                                const Detections& detections);

/// @param dropped  counts items of unknown classes ("unknown_class"), items with numbers that no
/// box
///                 has ("implausible_box"), and covariances that are none ("bad_covariance"), whose
///                 items are returned without them
[[nodiscard]] Detections detectionsFrom(const CObservationObjectDetections& observation,
                                        std::map<std::string, std::size_t>& dropped);

}  // namespace io
}  // namespace headway
