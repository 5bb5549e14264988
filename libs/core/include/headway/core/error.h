#pragma once

#include <stdexcept>

namespace headway {

/// The input or the environment is at fault: a file, a rawlog, a calibration, a parameter.
///
/// what() is one line that names what is wrong, where (file, place in it, key, value, unit) and
/// what to do. Programs print it and end with status 1. A programmer's fault is an assertion
/// instead, and an estimate that fails is a status in its result.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace headway
