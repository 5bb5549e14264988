// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace headway::program {

/// Finds a file or folder that headway brings, such as `config/worlds/street.ini`: relative to the
/// working folder, as in a clone of the repository, else below share/headway of the installation
/// that the running program belongs to.
///
/// @return the path found; `path` itself if there is none, or if it is absolute
[[nodiscard]] std::string findDataFile(const std::string& path);

/// findDataFile() below a given folder instead of the installation's.
[[nodiscard]] std::string findDataFile(const std::string& path, const std::string& installed);

}  // namespace headway::program
