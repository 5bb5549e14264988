#pragma once

#include <headway/io/dataset.h>

#include <map>
#include <string>

#include "import_options.h"

namespace headway::import {

/// What an import did.
struct ImportSummary {
  std::size_t frames = 0;
  bool interrupted = false;
  std::map<std::string, std::size_t> dropped;  ///< by reason
};

/// Writes the dataset, with the side files that the options name, as a rawlog.
///
/// @throws InputError
ImportSummary importDataset(const io::Dataset& dataset, const ImportOptions& options);

}  // namespace headway::import
