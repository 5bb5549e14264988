// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace headway::replay {

/// Whether a file in the folder of a run is one of its results, by its path in the folder. Old
/// results are removed when new ones replace them; other files are not touched.
[[nodiscard]] bool isResult(const std::filesystem::path& file);

}  // namespace headway::replay
