// SPDX-License-Identifier: BSD-3-Clause
// Rows of an image in several threads.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>

namespace headway {

/// Processes rows of an image in several threads; rows must not depend on each other.
template <class Work>
void forEachRow(int rows, const Work& work) {
  cv::parallel_for_({0, rows}, [&](const cv::Range& some) {
    for (int row = some.start; row < some.end; ++row) work(row);
  });
}

}  // namespace headway
