// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of .db3 files: no input may crash, hang or take much memory.
#include "bag_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return headway::test::fuzzBag(data, size, "");
}
