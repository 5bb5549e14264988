// SPDX-License-Identifier: BSD-3-Clause
#include <headway/program/data_files.h>

#include <filesystem>

namespace headway::program {

namespace fs = std::filesystem;

std::string findDataFile(const std::string& path) {
  std::error_code unknown;
  const auto program = fs::read_symlink("/proc/self/exe", unknown);
  return findDataFile(path, program.parent_path().parent_path() / "share/headway");
}

std::string findDataFile(const std::string& path, const std::string& installed) {
  std::error_code ignored;
  if (path.empty() || fs::path(path).is_absolute() || fs::exists(path, ignored)) return path;
  const auto file = fs::path(installed) / path;
  return fs::exists(file, ignored) ? file.string() : path;
}

}  // namespace headway::program
