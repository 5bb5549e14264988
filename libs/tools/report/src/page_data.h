// SPDX-License-Identifier: BSD-3-Clause
// The data that the page of a replay shows.
#pragma once

#include <headway/report/replay_page.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "replay_folder.h"

namespace headway::report {

/// Points as the page reads them: of n points first the coordinates, 3 n u16 in steps of `step`
/// from `origin`, then the colours, 3 n u8; little-endian. In random order, so that the first ones
/// are a sample of all.
struct PackedPoints {
  std::size_t count = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< map frame [m]
  Eigen::Vector3d step = Eigen::Vector3d::Ones();    ///< [m]
  double spacing = 0.0;  ///< median distance of a sample to the nearest other point [m]
  std::vector<std::uint8_t> bytes;
};

/// Packs points; those that are not finite are left out.
[[nodiscard]] PackedPoints packed(std::vector<ColouredPoint> points);

/// What the page shows of the whole run, without frames, tracks, points and images. Of more true
/// boxes than a page can hold the nearest of each frame are shown, which is noted.
[[nodiscard]] nlohmann::ordered_json pageData(const std::filesystem::path& folder,
                                              const std::vector<ReplayFrame>& frames,
                                              const ReplayTruth& truth,
                                              const std::vector<Stamped<Pose>>& keyframes,
                                              const Note& note);

/// Writes these data with tracks and frames as one JSON object, a frame at a time: lengths and
/// positions of objects in cm, angles in mrad, speeds in cm/s, all integers; times in seconds since
/// the first frame.
void writePageData(std::ostream& out, const nlohmann::ordered_json& data,
                   const std::vector<ReplayFrame>& frames);

}  // namespace headway::report
