// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/processor_time.h>

#include <ctime>

namespace headway {

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace headway
