#pragma once

#include <headway/core/params.h>

#include <filesystem>

#include "options.h"

namespace headway::replay {

/// Writes replay.json: what was run, so that it can be run again and its rawlog found.
void writeRunRecord(const std::filesystem::path& path, const Options& options,
                    const Params& params);

}  // namespace headway::replay
