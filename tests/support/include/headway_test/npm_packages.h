// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway_test/process.h>

#include <string>

namespace headway::test {

/// Installs the packages of a package.json by npm, unless they are there.
///
/// @param package  folder of the package.json, in the source tree
/// @param folder   where the packages are installed; tests that run at once may share it
/// @param use      what the tests do with them
/// @return         why they are not there; empty if they are
inline std::string missingNpmPackages(const std::string& package, const std::string& folder,
                                      const std::string& use) {
  if (runProcess("command -v node && command -v npm").status != 0) {
    return "node and npm are not installed; they " + use + " for this test";
  }
  const std::string source = std::string(HEADWAY_SOURCE_DIR) + "/" + package + "/package.json";
  const std::string install = "cmp -s " + source + " installed.json || (cp " + source +
                              " . && npm install --no-package-lock --no-audit --no-fund --silent "
                              "&& cp package.json installed.json)";
  const std::string locked =
      "mkdir -p " + folder + " && cd " + folder + " && flock lock sh -c '" + install + "'";
  return runProcess(locked).status == 0 ? "" : "npm cannot install the packages of " + package;
}

}  // namespace headway::test
