// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// MRPT's YAML reader does not free libfyaml's parser where a text is no YAML: 3 kB a file, of
/// which a program reads one.
extern "C" __attribute__((used)) inline const char* __lsan_default_suppressions() {
  return "leak:libfyaml";
}
