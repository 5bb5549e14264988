// SPDX-License-Identifier: BSD-3-Clause
// Sensors of a robot that is not there: its observations come from a rawlog, 40 stereo pairs at
// 10 Hz.
#pragma once

#include <headway/io/detection_observation.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <chrono>
#include <functional>
#include <thread>

inline void runSensors(const char* rawlog,
                       const std::function<void(mrpt::obs::CObservation::Ptr)>& callback) {
  headway::io::registerClasses();  // the rawlog holds detections, too
  mrpt::io::CFileGZInputStream file(rawlog);
  auto archive = mrpt::serialization::archiveFrom(file);
  for (int pairs = 0; pairs < 40;) {
    const auto object = archive.ReadObject();
    const auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object);
    if (std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(object)) {
      ++pairs;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    if (observation) callback(observation);
  }
}
