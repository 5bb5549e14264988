// SPDX-License-Identifier: BSD-3-Clause
// The version of headway, from which all others are read.
#pragma once

namespace headway {

/// headway's version, MAJOR.MINOR.PATCH; the build reads it from this line. Programs print it with
/// --version and `replay.json` records it.
inline constexpr const char* kVersion = "0.3.0";

}  // namespace headway
