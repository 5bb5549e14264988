// SPDX-License-Identifier: BSD-3-Clause
// Import of a bag: its messages become the observations of a rawlog.
#pragma once

#include <headway/bags/bag_selection.h>
#include <headway/io/rawlog_sink.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway::bags {

/// What of a bag is imported, and how.
struct BagImportOptions {
  BagSelection topics;
  std::string base_frame;       ///< frame of the robot; empty: base_link, base_footprint, ...
  std::string calibration;      ///< of the stereo camera, instead of camera_info; empty: none
  std::size_t first_frame = 0;  ///< index of the first frame
  std::optional<std::size_t> last_frame;
};

/// Result of an import.
struct BagImportSummary {
  std::size_t frames = 0;
  std::map<std::string, std::size_t> written;  ///< observations that are no frames, by kind
  std::map<std::string, std::size_t> dropped;  ///< messages and images, by reason
  std::vector<std::string> notes;              ///< what had to be assumed
  std::optional<std::string> truncation;       ///< where and why the bag ends early
  bool was_stopped = false;
};

/// Writes the selected topics as observations in the order of their headers' times.
///
/// The calibration is that of camera_info, the mounting that of tf: a first pass over the bag's
/// beginning collects both. Sensors whose mounting is unknown are not written but counted.
///
///     io::RawlogSink sink("out.rawlog", io::ImageStorage::kEmbeddedRaw);
///     importBag("drive.mcap", options, sink, [](std::size_t, double) { return true; });
///
/// @param go_on  called after each frame with their number and the ratio that is read; false stops
/// @throws InputError if there is no calibration, it is impossible, or no frame could be made
BagImportSummary importBag(const std::string& path, const BagImportOptions& options,
                           io::RawlogSink& sink,
                           const std::function<bool(std::size_t, double)>& go_on);

}  // namespace headway::bags
