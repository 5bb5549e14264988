// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace headway::test {}

namespace headway::io::test {

using namespace headway::test;

struct ProcessResult {
  int status = -1;     ///< exit status
  std::string output;  ///< standard output and error
};

/// Runs a shell command to its end.
[[nodiscard]] ProcessResult runProcess(const std::string& command);

[[nodiscard]] bool programExists(const std::string& name);

}  // namespace headway::io::test
