// SPDX-License-Identifier: BSD-3-Clause
// Files that are read, which nothing may write.
#pragma once

#include <filesystem>
#include <vector>

namespace headway {

/// Registers a file that this process reads: OutputFile, GrowingFile and replaceFiles() refuse it
/// from then on, by whichever path. What is no regular file is ignored: folders that are read may
/// receive new files, and devices are read and written.
void registerInput(const std::filesystem::path& path);

/// As registered. Callable by any thread, as the others.
[[nodiscard]] std::vector<std::filesystem::path> registeredInputs();

/// @throws InputError if the path leads to a file that was registered
void requireNoInput(const std::filesystem::path& path);

}  // namespace headway
