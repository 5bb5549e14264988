// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace headway {

/// printf-style formatting, because streams depend on a locale. Texts of any length are whole.
[[nodiscard]] std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace headway
