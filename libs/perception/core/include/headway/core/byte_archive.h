// SPDX-License-Identifier: BSD-3-Clause
// Values as bytes of a file and back, each length checked before memory is allocated.
#pragma once

#include <headway/core/error.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace headway {

/// Receives bytes piece by piece, in order.
using ByteSink = std::function<void(std::string_view)>;

/// Gives all its bytes to a sink, the same ones each time and in any thread.
using ByteSource = std::function<void(const ByteSink&)>;

/// The bytes of a source in one string.
[[nodiscard]] inline std::string collected(const ByteSource& source) {
  std::string bytes;
  source([&bytes](std::string_view piece) { bytes += piece; });
  return bytes;
}

/// A source of bytes that exist.
[[nodiscard]] inline ByteSource sourceOf(std::string bytes) {
  const auto held = std::make_shared<const std::string>(std::move(bytes));
  return [held](const ByteSink& sink) { sink(*held); };
}

/// Appends values to a byte string as little-endian numbers of fixed width, for headway's own file
/// formats. Accepts arithmetic types only, so that the caller chooses the width.
class ByteWriter {
 public:
  template <typename T>
  void value(const T& x) {
    static_assert(std::is_arithmetic_v<T>);
    bytes.append(reinterpret_cast<const char*>(&x), sizeof(T));
  }
  template <typename T, std::size_t N>
  void values(const std::array<T, N>& all) {
    static_assert(std::is_arithmetic_v<T>);
    bytes.append(reinterpret_cast<const char*>(all.data()), sizeof all);
  }
  /// In column-major order.
  template <typename Derived>
  void matrix(const Eigen::MatrixBase<Derived>& m) {
    const typename Derived::PlainObject plain = m;  // contiguous
    static_assert(!Derived::PlainObject::IsRowMajor || Derived::IsVectorAtCompileTime);
    bytes.append(reinterpret_cast<const char*>(plain.data()),
                 sizeof(typename Derived::Scalar) * static_cast<std::size_t>(plain.size()));
  }
  void count(std::size_t n) { value<std::uint64_t>(n); }
  void text(std::string_view characters) {
    count(characters.size());
    bytes += characters;
  }

  std::string bytes;
};

/// Reads the bytes of a ByteWriter; they must outlive the reader.
///
/// @throws InputError in each function if the bytes end early or contain an invalid value
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  T value() {
    static_assert(std::is_arithmetic_v<T>);
    T x;
    std::memcpy(&x, take(sizeof(T)).data(), sizeof(T));
    return x;
  }
  template <typename T>
  T finiteValue() {
    const T x = value<T>();
    if (!std::isfinite(x)) throw InputError("damaged: a value is not finite");
    return x;
  }
  template <typename T, std::size_t N>
  void values(std::array<T, N>& all) {
    static_assert(std::is_arithmetic_v<T>);
    std::memcpy(all.data(), take(sizeof all).data(), sizeof all);
  }
  template <typename Matrix>
  Matrix matrix() {
    Matrix m;
    static_assert(!Matrix::IsRowMajor || Matrix::IsVectorAtCompileTime);
    const std::size_t size = sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(m.size());
    std::memcpy(m.data(), take(size).data(), size);
    return m;
  }
  template <typename Matrix>
  Matrix finiteMatrix() {
    const Matrix m = matrix<Matrix>();
    if (!m.allFinite()) throw InputError("damaged: a value is not finite");
    return m;
  }
  template <typename Enum>
  Enum enumerator(int count) {
    const auto x = value<std::uint8_t>();
    if (x >= count) throw InputError("damaged: a value of an enumeration that does not exist");
    return static_cast<Enum>(x);
  }
  /// Without reserve(), so that a damaged count fails at the end of the bytes, not of the memory.
  template <typename Item, typename Read>
  std::vector<Item> list(const Read& read) {
    const auto n = value<std::uint64_t>();
    std::vector<Item> items;
    for (std::uint64_t i = 0; i < n; ++i) items.push_back(read(*this));
    return items;
  }
  std::string_view take(std::uint64_t size) {
    if (size > bytes_.size()) throw InputError("damaged: the data end early");
    const auto taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  std::string text() { return std::string(take(value<std::uint64_t>())); }
  [[nodiscard]] bool atEnd() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

}  // namespace headway
