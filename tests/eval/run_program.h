// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace headway::eval {

/// Output and exit status of a program.
struct ProgramRun {
  int status = -1;
  std::string out;
  std::string error;
};

inline std::string contentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

/// Runs headway-eval with arguments as a shell splits them.
inline ProgramRun runEval(const std::string& arguments) {
  const test::TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::string error = folder / "error";
  const std::string command =
      HEADWAY_BIN_DIR "/headway-eval " + arguments + " > " + out + " 2> " + error;
  const int status = std::system(command.c_str());
  return {WEXITSTATUS(status), contentOf(out), contentOf(error)};
}

}  // namespace headway::eval
