// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>

namespace headway {

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
