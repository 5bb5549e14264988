// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/serialization/CSerializable.h>

#include <string>
#include <vector>

#include "synthetic_recording.h"

namespace headway::test {}

namespace headway::io::test {

using namespace headway::test;

/// Bytes of values as MRPT writes them.
template <typename... Values>
[[nodiscard]] std::string bytesOf(const Values&... values) {
  std::string result;
  (result.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return result;
}

/// A text with its length.
[[nodiscard]] std::string textBytes(const std::string& text);

/// An object of any class and version, around values.
[[nodiscard]] std::string objectBytes(const std::string& class_name, int version,
                                      const std::string& values);

/// An object as MRPT writes it.
[[nodiscard]] std::string mrptBytes(const mrpt::serialization::CSerializable& object);

/// The object in these bytes as MRPT reads it.
[[nodiscard]] mrpt::serialization::CSerializable::Ptr mrptRead(const std::string& bytes);

/// A grey CImage of random pixels, as MRPT 2.5.8 writes it.
[[nodiscard]] std::string imageBytes();

/// `image` as a CImage with an embedded JPEG.
[[nodiscard]] std::string jpegImageBytes(const cv::Mat& image);

/// Writes the content of a rawlog as a seed for tests/fuzz if HEADWAY_FUZZ_SEEDS names a folder.
void keepAsSeed(const std::string& content);

/// A CObservationStereoImages with these images and the calibration of smallCamera().
[[nodiscard]] std::string stereoBytes(int frame, const std::string& left, const std::string& right);

}  // namespace headway::io::test
