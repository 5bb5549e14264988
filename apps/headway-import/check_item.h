// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace headway::import {

enum class Verdict { kOk, kWarning, kBad };

/// One line of a check.
struct CheckItem {
  std::string name;
  std::string value;
  Verdict verdict = Verdict::kOk;
  std::string advice;  ///< cause and what to do; empty if it is ok
};

/// The verdict on a value that should be low.
[[nodiscard]] inline Verdict verdictOf(double value, double warning, double bad) {
  if (value > bad) return Verdict::kBad;
  return value > warning ? Verdict::kWarning : Verdict::kOk;
}

}  // namespace headway::import
