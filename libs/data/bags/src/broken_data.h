// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace headway::bags {

/// A part of a recording that is not as its format says; it is skipped and counted.
class BrokenData : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace headway::bags
