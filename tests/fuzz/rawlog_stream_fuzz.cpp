// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of the rawlog reader: no input may crash, hang or take much memory.
#include <headway/core/error.h>
#include <headway/io/detection_observation.h>

#include <cstddef>
#include <cstdint>

#include "memory_file.h"
#include "observation_stream.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const headway::test::MemoryFile file(data, size);
  std::map<std::string, std::size_t> skipped;
  try {
    headway::io::ObservationStream stream(file.path(), skipped);
    while (const auto observation = stream.next()) {
      const auto* detections =
          dynamic_cast<const headway::CObservationObjectDetections*>(observation.get());
      if (detections != nullptr) (void)headway::io::detectionsFrom(*detections, skipped);
    }
  } catch (const headway::InputError&) {  // the file is no rawlog
  }
  return 0;
}
