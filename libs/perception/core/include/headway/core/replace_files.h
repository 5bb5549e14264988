// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>

namespace headway {

/// Folder of a run's new results, in the folder of the old ones, while they replace these. After a
/// kill meanwhile it remains, and the folder that it is in contains results of both runs.
inline constexpr char kReplacingFolder[] = "complete";

/// Moves all files of a folder, with those in its folders, to another folder of the same file
/// system and removes the first one. They replace files of the same names, after they have been
/// synchronised with the disk.
///
/// @param to        created if necessary
/// @param is_stale  which other files of `to` are removed, by their path in `to`
/// @throws InputError if a file cannot be moved; those moved before remain moved
void replaceFiles(const std::filesystem::path& from, const std::filesystem::path& to,
                  const std::function<bool(const std::filesystem::path&)>& is_stale);

}  // namespace headway
