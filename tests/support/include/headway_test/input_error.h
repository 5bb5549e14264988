// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/error.h>

#include <string>

namespace headway::test {

/// The text of the InputError that an action throws; empty if it throws none.
template <typename Action>
std::string inputErrorOf(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace headway::test
