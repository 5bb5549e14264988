// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/core/Clock.h>

#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "compressed_stream.h"

namespace headway::io {

/// An object that cannot be read. It costs itself only: the reader continues at the next object.
class BrokenObject : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file ends within an object.
class UnexpectedEnd : public BrokenObject {
 public:
  UnexpectedEnd() : BrokenObject("the file ends within an object") {}
};

/// An object of a version that is not known: of a later MRPT, as a rule.
class UnknownVersion : public BrokenObject {
 public:
  /// @param class_name  of an object within the observation; empty: the observation itself
  UnknownVersion(const std::string& class_name, int version)
      : BrokenObject((class_name.empty() ? "" : class_name + "_") + "version_" +
                     std::to_string(version)) {}
};

/// Class name without namespace: "mrpt::obs::CObservationImage" gives "CObservationImage".
[[nodiscard]] std::string shortClassName(const std::string& name);

/// Reads the values of objects in MRPT's format, with all lengths checked against a limit and
/// against the file before anything is allocated.
///
/// The format (MRPT's CArchive, unchanged from MRPT 0.9 to 3.0; little-endian): an object is the
/// length of its class name with the highest bit set, the name, a version byte, its values, and an
/// end mark. Strings and vectors are preceded by their length as uint32.
class ObjectReader {
 public:
  /// @param input  its mark is where the object begins
  explicit ObjectReader(CompressedInput& input) : input_(input) {}

  template <typename T>
  [[nodiscard]] T value() {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>, "bool: see flag()");
    T result;
    std::memcpy(&result, take(sizeof(T)).data(), sizeof(T));
    return result;
  }

  /// A bool. @throws BrokenObject if it is neither 0 nor 1
  [[nodiscard]] bool flag();
  /// INVALID_TIMESTAMP if it is before the clock's epoch.
  [[nodiscard]] mrpt::Clock::time_point time();
  /// @throws BrokenObject if it is longer than labels and file names are
  [[nodiscard]] std::string text();

  template <typename T>
  [[nodiscard]] std::vector<T> values(std::size_t count, std::size_t max_count) {
    if (count > max_count) throw BrokenObject("a vector is too long");
    const std::string_view bytes = take(count * sizeof(T));
    std::vector<T> result(count);
    if (count > 0) std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }
  /// A vector preceded by its length.
  template <typename T>
  [[nodiscard]] std::vector<T> vector(std::size_t max_count) {
    const auto count = value<std::uint32_t>();
    return values<T>(count, max_count);
  }
  /// A matrix object of MRPT, row-major.
  [[nodiscard]] std::vector<double> matrix(std::size_t rows, std::size_t columns);

  /// Skips bytes; returns their position.
  std::uint64_t skip(std::size_t count);

  /// Begins an object of one of these classes (without namespace); returns its version.
  std::uint8_t enter(std::initializer_list<const char*> class_names);
  /// Begins an object of this class whose version must not be greater.
  std::uint8_t enter(const char* class_name, std::uint8_t max_version);
  /// Requires the end mark of the object.
  void leave();

  /// Bytes skipped before.
  [[nodiscard]] std::string_view at(std::uint64_t position, std::size_t count) const {
    return input_.at(position, count);
  }

 private:
  std::string_view take(std::size_t count);
  std::string className();

  CompressedInput& input_;
};

}  // namespace headway::io
