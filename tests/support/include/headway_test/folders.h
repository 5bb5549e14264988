// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace headway::test {

/// Folder of the real data named by HEADWAY_DATA; nullopt where it is not set.
inline std::optional<std::filesystem::path> dataFolder() {
  const char* folder = std::getenv("HEADWAY_DATA");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  return std::filesystem::path(folder);
}

/// An empty folder that is deleted at the end of the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "headway-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Works in an empty folder until the end of the test: for what MRPT writes where it stands.
class WorkingInTemporaryFolder {
 public:
  WorkingInTemporaryFolder() : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder_.path());
  }
  ~WorkingInTemporaryFolder() {
    std::error_code ignored;
    std::filesystem::current_path(before_, ignored);
  }
  WorkingInTemporaryFolder(const WorkingInTemporaryFolder&) = delete;
  WorkingInTemporaryFolder& operator=(const WorkingInTemporaryFolder&) = delete;

 private:
  TemporaryFolder folder_;
  std::filesystem::path before_;
};

}  // namespace headway::test

/// Ends the test as skipped, saying why, where there is no real data.
#define HEADWAY_REQUIRE_DATA(folder)                                                   \
  const auto folder##_optional = ::headway::test::dataFolder();                        \
  if (!folder##_optional) GTEST_SKIP() << "HEADWAY_DATA names no folder of real data"; \
  const std::filesystem::path folder = *folder##_optional
