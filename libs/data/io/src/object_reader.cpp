// SPDX-License-Identifier: BSD-3-Clause
#include "object_reader.h"

#include <mrpt/system/datetime.h>

#include <algorithm>

namespace headway::io {
namespace {

constexpr unsigned char kNestedNameFlag = 0x80;
constexpr unsigned char kObjectEnd = 0x88;
constexpr std::size_t kMaxText = 4096;      // of labels, file names and classes
constexpr std::size_t kMaxMatrixSize = 64;  // rows and columns of calibrations and covariances

}  // namespace

std::string shortClassName(const std::string& name) {
  const auto colon = name.rfind(':');
  return colon == std::string::npos ? name : name.substr(colon + 1);
}

std::string_view ObjectReader::take(std::size_t count) {
  const std::string_view bytes = input_.peek(count);
  if (bytes.size() < count) throw UnexpectedEnd();
  input_.take(count);
  return bytes;
}

std::uint64_t ObjectReader::skip(std::size_t count) {
  const std::uint64_t position = input_.position();
  (void)take(count);
  return position;
}

bool ObjectReader::flag() {
  const auto byte = value<std::uint8_t>();
  if (byte > 1) throw BrokenObject("a bool is neither 0 nor 1");
  return byte == 1;
}

mrpt::Clock::time_point ObjectReader::time() {
  const auto ticks = value<std::int64_t>();
  return ticks > 0 ? mrpt::Clock::time_point(mrpt::Clock::duration(ticks)) : INVALID_TIMESTAMP;
}

std::string ObjectReader::text() {
  const auto length = value<std::uint32_t>();
  if (length > kMaxText) throw BrokenObject("a text is too long");
  return std::string(take(length));
}

std::string ObjectReader::className() {
  const auto first = value<std::uint8_t>();
  if ((first & kNestedNameFlag) == 0) throw BrokenObject("an object is expected");
  return std::string(take(first & ~kNestedNameFlag));
}

std::uint8_t ObjectReader::enter(std::initializer_list<const char*> class_names) {
  const std::string name = shortClassName(className());
  if (std::find(class_names.begin(), class_names.end(), name) == class_names.end()) {
    throw BrokenObject("an object has an unexpected class");
  }
  return value<std::uint8_t>();
}

std::uint8_t ObjectReader::enter(const char* class_name, std::uint8_t max_version) {
  const std::uint8_t version = enter({class_name});
  if (version > max_version) throw UnknownVersion(class_name, version);
  return version;
}

void ObjectReader::leave() {
  if (value<std::uint8_t>() != kObjectEnd) throw BrokenObject("an end mark is missing");
}

/// CMatrixF and CMatrixD of MRPT 2.5.8, version 0: rows, columns, values; CMatrix in older files.
std::vector<double> ObjectReader::matrix(std::size_t rows, std::size_t columns) {
  const std::string name = shortClassName(className());
  const auto version = value<std::uint8_t>();
  const bool is_float = name == "CMatrix" || name == "CMatrixF";
  if ((!is_float && name != "CMatrixD") || version != 0) throw BrokenObject("not a matrix");
  const std::size_t own_rows = value<std::uint32_t>();
  const std::size_t own_columns = value<std::uint32_t>();
  const bool is_any = rows == 0 && columns == 0;
  if (own_rows > kMaxMatrixSize || own_columns > kMaxMatrixSize ||
      (!is_any && (own_rows != rows || own_columns != columns))) {
    throw BrokenObject("a matrix has another size");
  }
  const std::size_t count = own_rows * own_columns;
  std::vector<double> result;
  if (is_float) {
    const auto floats = values<float>(count, count);
    result.assign(floats.begin(), floats.end());
  } else {
    result = values<double>(count, count);
  }
  leave();
  return result;
}

}  // namespace headway::io
