#pragma once

#include <headway/io/dataset.h>
#include <headway/io/degrade.h>

#include <optional>
#include <string>

namespace headway::import {

/// What the command line asks for.
struct ImportOptions {
  std::string dataset;  ///< the sub-command
  std::string folder;
  std::string sequence;
  std::string boxes = "det3d_pointrcnn";
  std::string left;
  std::string right;
  std::string calibration;

  std::string output;
  bool overwrite = false;
  bool external_images = false;
  std::string detections;  ///< side file; empty: those of the dataset
  std::string poses;       ///< side file; empty: those of the dataset
  std::optional<io::DegradeParams> degrade;
  std::optional<std::size_t> from_index;
  std::optional<std::size_t> to_index;
  bool quiet = false;
};

/// Reads the command line; nullopt if there is nothing more to do (--help and the like).
///
/// @throws program::UsageError, InputError
[[nodiscard]] std::optional<ImportOptions> parseOptions(int argc, const char** argv);

/// Opens the dataset that the options name.
[[nodiscard]] std::unique_ptr<io::Dataset> openDataset(const ImportOptions& options);

}  // namespace headway::import
