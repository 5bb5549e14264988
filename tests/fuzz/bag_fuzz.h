// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>

#include "../bags/read_whole_bag.h"

namespace headway::test {

/// Imports the input as a bag, in a file in memory: SQLite opens no descriptors.
inline int fuzzBag(const std::uint8_t* data, std::size_t size, const std::string& magic) {
  static const std::string path = "/dev/shm/headway-fuzz-bag-" + std::to_string(getpid());
  std::ofstream file(path, std::ios::binary);
  file << magic;
  file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  file.close();
  (void)headway::bags::test::readWholeBag(path);
  return 0;
}

}  // namespace headway::test
