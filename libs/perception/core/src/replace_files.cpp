// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <headway/core/error.h>
#include <headway/core/replace_files.h>
#include <unistd.h>

#include <set>

namespace headway {
namespace {

std::set<std::filesystem::path> filesIn(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_directory() || entry.is_symlink()) {
      files.insert(entry.path().lexically_relative(folder));
    }
  }
  return files;
}

/// Synchronises the file system of a folder with the disk.
void synchroniseAll(const std::filesystem::path& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)syncfs(file);
  close(file);
}

}  // namespace

void replaceFiles(const std::filesystem::path& from, const std::filesystem::path& to,
                  const std::function<bool(const std::filesystem::path&)>& is_stale) {
  try {
    synchroniseAll(from);
    std::filesystem::create_directories(to);
    const auto files = filesIn(from);
    // `from` may be a folder of `to`.
    for (const auto& file : filesIn(to)) {
      const bool is_new =
          files.count(file) > 0 || files.count((to / file).lexically_relative(from)) > 0;
      if (!is_new && is_stale(file)) std::filesystem::remove(to / file);
    }
    for (const auto& file : files) {
      std::filesystem::create_directories((to / file).parent_path());
      std::filesystem::rename(from / file, to / file);
    }
    std::filesystem::remove_all(from);
    synchroniseAll(to);
  } catch (const std::filesystem::filesystem_error& error) {
    throw InputError(to.string() + ": files cannot be replaced: " + error.code().message());
  }
}

}  // namespace headway
