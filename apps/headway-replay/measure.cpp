#include "measure.h"

#include <unistd.h>

#include <ctime>
#include <fstream>
#include <limits>
#include <string>

namespace headway::replay {

double secondsSinceProcessStart() {
  // proc(5): field 22 of stat is the start in clock ticks since boot; the name in field 2 may
  // hold blanks but ends at the last ')'.
  std::ifstream stat("/proc/self/stat");
  std::string line;
  std::getline(stat, line);
  const auto end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) return 0.0;
  std::size_t position = end_of_name + 2;
  for (int field = 3; field < 22; ++field) position = line.find(' ', position) + 1;
  const double start = std::stod(line.substr(position)) / static_cast<double>(sysconf(_SC_CLK_TCK));
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - start;
}

double peakMemoryMb() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word) {
    if (word == "VmHWM:") {
      double kib = 0.0;
      status >> kib;
      return kib / 1024.0;
    }
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return 0.0;
}

}  // namespace headway::replay
