// SPDX-License-Identifier: BSD-3-Clause
#include "processes.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>

namespace headway::io::test {

ProcessResult runProcess(const std::string& command) {
  ProcessResult result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return result;
  std::array<char, 4096> buffer{};
  while (const std::size_t got = fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.output.append(buffer.data(), got);
  }
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

bool programExists(const std::string& name) { return runProcess("command -v " + name).status == 0; }

}  // namespace headway::io::test
