// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <string>
#include <vector>

namespace headway::test {}

namespace headway::io::test {

using namespace headway::test;

/// A rawlog as other programs write it: any objects, gz or plain.
void writeObjects(const std::string& path,
                  const std::vector<mrpt::serialization::CSerializable::Ptr>& objects,
                  bool compressed = true);

/// The stereo observation of wall(number) at `time`, from smallCamera().
[[nodiscard]] mrpt::obs::CObservationStereoImages::Ptr wallObservation(
    int number, Time time, const std::string& label = "stereo");

/// Left (0) or right (1) half of the same.
[[nodiscard]] mrpt::obs::CObservationImage::Ptr singleImage(int side, int number, Time time,
                                                            const std::string& label);

}  // namespace headway::io::test
