// SPDX-License-Identifier: BSD-3-Clause
// The error for what the environment got wrong: files, parameters, calibrations.
#pragma once

#include <stdexcept>

namespace headway {

/// Invalid input or environment: a file, a rawlog, a calibration, a parameter.
///
/// what() is one line that states the error, its location (file, position, key, value, unit) and
/// the remedy. Programs print it and exit with status 1. Programming errors are assertions, and a
/// failed estimate is a status in its result.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace headway
