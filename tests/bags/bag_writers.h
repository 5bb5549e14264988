// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::bags::test {

/// A kind of bag, as written by a package that is not ours.
struct BagFormat {
  const char* ending;       ///< "bag", "mcap" or "db3"
  const char* compression;  ///< of its chunks
};

/// Writes the recording of writers/recording.py.
///
/// @param form  see recording.py
/// @return      why the format cannot be written on this machine; empty if it was written
std::string writeBag(const BagFormat& format, const std::string& form,
                     const std::filesystem::path& path);

/// A single-channel image of the recording; the right one has the offset 11.
cv::Mat recordedPicture(int frame, int offset = 0);
/// Depth of the recording [mm].
cv::Mat recordedDepth(int frame);

inline constexpr double kRecordedStart = 1700000000.0;  // [s]
inline constexpr int kRecordedFrames = 12;

}  // namespace headway::bags::test

/// Writes a bag, or ends the test as skipped, saying why.
#define HEADWAY_WRITE_BAG(format, form, path)                                        \
  do {                                                                               \
    const std::string missing = ::headway::bags::test::writeBag(format, form, path); \
    if (!missing.empty()) GTEST_SKIP() << missing;                                   \
  } while (false)
