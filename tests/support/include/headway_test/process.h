// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway_test/paths.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace headway::test {

/// What became of a program that was run to its end.
struct ProcessResult {
  int status = -1;     ///< exit status; 128 + signal where a signal ended it
  std::string output;  ///< standard output and standard error, as they came
};

/// Contents of a whole file; empty if there is none.
inline std::string contentsOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Runs a shell command to its end.
inline ProcessResult runProcess(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
  ProcessResult result;
  std::array<char, 4096> buffer{};
  std::size_t count = 0;
  while ((count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0) {
    result.output.append(buffer.data(), count);
  }
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

/// Path of one of headway's programs in the build folder.
inline std::string program(const std::string& name) {
  return std::string(HEADWAY_BIN_DIR) + "/" + name;
}

}  // namespace headway::test
