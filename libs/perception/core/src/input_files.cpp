// SPDX-License-Identifier: BSD-3-Clause
// Files that are read, which nothing may write.
#include <headway/core/error.h>
#include <headway/core/input_files.h>

#include <algorithm>
#include <mutex>

namespace headway {
namespace {

namespace fs = std::filesystem;

struct Inputs {
  std::mutex mutex;
  std::vector<fs::path> paths;  ///< absolute
};

Inputs& inputs() {
  static Inputs all;
  return all;
}

}  // namespace

void registerInput(const fs::path& path) {
  std::error_code error;
  if (path.empty() || !fs::is_regular_file(path, error)) return;
  const fs::path absolute = fs::absolute(path, error);
  const std::lock_guard lock(inputs().mutex);
  inputs().paths.push_back(error ? path : absolute);
}

std::vector<fs::path> registeredInputs() {
  const std::lock_guard lock(inputs().mutex);
  return inputs().paths;
}

void requireNoInput(const fs::path& path) {
  const auto all = registeredInputs();
  const bool is_input = std::any_of(all.begin(), all.end(), [&](const fs::path& input) {
    std::error_code ignored;
    return fs::equivalent(path, input, ignored);
  });
  if (is_input) {
    throw InputError(path.string() + ": is an input and would be overwritten; choose another name");
  }
}

}  // namespace headway
