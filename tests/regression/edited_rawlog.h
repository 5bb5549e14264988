// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/detection_observation.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

namespace headway::test {

/// Changes of a recording as mistakes of mounting or of a driver would cause them.
struct RawlogEdit {
  std::function<void(mrpt::obs::CObservationStereoImages&)> stereo;
  /// Adds inertial samples, each at rest before it is changed.
  std::function<void(mrpt::obs::CObservationIMU&)> imu;
  std::function<void(mrpt::obs::CObservationIMU&)>
      recorded_imu;    ///< changes those of the recording
  int max_pairs = 60;  ///< of the copy
};

/// Copies an observation-only rawlog with changed observations.
inline void editRawlog(const std::string& from, const std::string& to, const RawlogEdit& edit) {
  mrpt::rtti::registerClass(CLASS_ID(headway::CObservationObjectDetections));
  mrpt::io::CFileGZInputStream in(from);
  mrpt::io::CFileGZOutputStream out(to);
  auto source = mrpt::serialization::archiveFrom(in);
  auto target = mrpt::serialization::archiveFrom(out);
  int pairs = 0;
  while (pairs < edit.max_pairs) {
    mrpt::serialization::CSerializable::Ptr object;
    try {
      object = source.ReadObject();
    } catch (const std::exception&) {
      return;  // the end
    }
    if (auto* stereo = dynamic_cast<mrpt::obs::CObservationStereoImages*>(object.get())) {
      ++pairs;
      if (edit.stereo) edit.stereo(*stereo);
    }
    auto* recorded_imu = dynamic_cast<mrpt::obs::CObservationIMU*>(object.get());
    if (recorded_imu != nullptr && edit.recorded_imu) edit.recorded_imu(*recorded_imu);
    target << *object;
    if (dynamic_cast<mrpt::obs::CObservationStereoImages*>(object.get()) == nullptr || !edit.imu) {
      continue;
    }
    const auto& pair = dynamic_cast<const mrpt::obs::CObservation&>(*object);
    for (int i = 0; i < 10; ++i) {
      mrpt::obs::CObservationIMU imu;
      imu.timestamp = pair.timestamp + std::chrono::milliseconds(10 * i);
      imu.sensorLabel = "imu";
      for (const auto value : {mrpt::obs::IMU_WX, mrpt::obs::IMU_WY, mrpt::obs::IMU_WZ,
                               mrpt::obs::IMU_X_ACC, mrpt::obs::IMU_Y_ACC}) {
        imu.set(value, 0.0);
      }
      imu.set(mrpt::obs::IMU_Z_ACC, 9.81);
      edit.imu(imu);
      target << imu;
    }
  }
}

}  // namespace headway::test
