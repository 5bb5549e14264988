// SPDX-License-Identifier: BSD-3-Clause
// Names of the folders of several recordings.
#include "recording_names.h"

#include <headway/core/output_file.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace headway::replay {
namespace {

namespace fs = std::filesystem;

/// The file's name with `depth` folders above it.
std::string nameOf(const fs::path& file, std::size_t depth) {
  std::string name = file.filename().string();
  const auto end = name.rfind(".rawlog");
  if (end != std::string::npos && end > 0) name.resize(end);
  fs::path folder = file.parent_path();
  for (; depth > 0 && folder.has_filename(); --depth, folder = folder.parent_path()) {
    name = folder.filename().string() + "-" + name;
  }
  return name;
}

/// Names that the folder with the common map uses itself.
bool isReserved(const std::string& name) {
  static const std::set<std::string> names = {"unfinished", kReplacingFolder, "snapshots", ".",
                                              ".."};
  return names.count(name) > 0 || name.rfind("map", 0) == 0 || name.rfind(".", 0) == 0;
}

}  // namespace

std::vector<std::string> recordingNames(const std::vector<std::string>& files) {
  std::vector<fs::path> paths;
  for (const auto& file : files) paths.push_back(fs::weakly_canonical(file));
  const auto longest =
      std::max_element(paths.begin(), paths.end(), [](const auto& a, const auto& b) {
        return std::distance(a.begin(), a.end()) < std::distance(b.begin(), b.end());
      });
  const auto max_depth =
      longest == paths.end()
          ? std::size_t{0}
          : static_cast<std::size_t>(std::distance(longest->begin(), longest->end()));
  std::vector<std::string> names(files.size());
  std::vector<std::size_t> depth(files.size(), 0);
  for (std::size_t round = 0; round <= max_depth; ++round) {
    for (std::size_t i = 0; i < files.size(); ++i) names[i] = nameOf(paths[i], depth[i]);
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (std::count(names.begin(), names.end(), names[i]) > 1) depth[i] = round + 1;
    }
  }
  for (auto& name : names) {
    if (isReserved(name)) name = "recording-" + name;
  }
  return names;
}

}  // namespace headway::replay
