// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway_test/repeats.h>

#include <fstream>
#include <string>

namespace headway::test {

/// The most memory that this process has had since an instance was made.
class PeakMemory {
 public:
  PeakMemory() {
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew: proc(5)
    before_ = peakMb();
  }
  /// More than at the beginning [MB]; 0 under a sanitizer, which holds back what is freed.
  [[nodiscard]] double growthMb() const { return kSanitized ? 0.0 : peakMb() - before_; }

 private:
  static double peakMb() {
    std::ifstream status("/proc/self/status");
    double peak_kb = 0.0;
    for (std::string word; status >> word;) {
      if (word == "VmHWM:") status >> peak_kb;
    }
    return 1.024e-3 * peak_kb;  // the kernel's kB have 1024 bytes
  }

  double before_ = 0.0;
};

}  // namespace headway::test
