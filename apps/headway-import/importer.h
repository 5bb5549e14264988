// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/dataset.h>
#include <headway/io/degrade.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace headway::import {

/// Command-line options.
struct ImportOptions {
  std::string dataset;  ///< the sub-command
  std::string folder;
  std::string sequence;
  std::string drive;  ///< kitti-raw: its name; kitti-tracking: its folder, empty without images
  std::string boxes;  ///< empty: the default
  std::string oxts_path = "positions";
  std::string left;
  std::string right;
  std::string depth;  ///< images: instead of right
  std::string calibration;

  std::string output;
  bool check = false;
  bool overwrite = false;
  bool external_images = false;
  std::string detections;       ///< side file; empty: boxes or poses of the dataset
  std::string poses;            ///< side file; empty: boxes or poses of the dataset
  bool use_oxts_poses = false;  ///< the true path of the raw drive as `pose`
  std::optional<io::DegradeParams> degrade;
  std::optional<std::size_t> from_index;
  std::optional<std::size_t> to_index;
  bool quiet = false;
};

/// Removes the sub-command from the arguments.
///
/// @throws program::UsageError if it is unknown
std::string takeSubcommand(int& argc, const char**& argv);

/// Reads the command line; nullopt if the program is done (--help and similar).
///
/// @throws program::UsageError, InputError
[[nodiscard]] std::optional<ImportOptions> parseOptions(int argc, const char** argv);

/// Opens the selected dataset.
[[nodiscard]] std::unique_ptr<io::Dataset> openDataset(const ImportOptions& options);

/// Result of an import.
struct ImportSummary {
  std::size_t frames = 0;
  bool interrupted = false;
  std::map<std::string, std::size_t> dropped;  ///< by reason
};

/// Writes the dataset and the side files as a rawlog.
///
/// @throws InputError
ImportSummary importDataset(const io::Dataset& dataset, const ImportOptions& options);

}  // namespace headway::import
