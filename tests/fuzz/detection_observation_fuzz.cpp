// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of headway's own observation: the input is what follows the class's name, the
// version and the label's length, which mutations hardly keep.
#include <headway/core/error.h>
#include <headway/io/detection_observation.h>

#include <cstddef>
#include <cstdint>
#include <sstream>

#include "memory_file.h"
#include "observation_stream.h"

namespace {

/// Two objects, so that what follows a broken one is read too.
std::string rawlogOf(const std::uint8_t* data, std::size_t size) {
  const std::string name = "headway::CObservationObjectDetections";
  std::string object(1, static_cast<char>(0x80 | name.size()));
  object += name;
  object += '\0';
  object.append(reinterpret_cast<const char*>(data), size);
  object += '\x88';
  return object + object;
}

void useAll(const headway::CObservationObjectDetections& observation,
            std::map<std::string, std::size_t>& dropped) {
  (void)headway::io::detectionsFrom(observation, dropped);
  std::ostringstream text;
  observation.getDescriptionAsText(text);
  (void)observation.exportTxtDataRow();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string rawlog = rawlogOf(data, size);
  const headway::test::MemoryFile file(reinterpret_cast<const std::uint8_t*>(rawlog.data()),
                                       rawlog.size());
  std::map<std::string, std::size_t> skipped;
  try {
    headway::io::ObservationStream stream(file.path(), skipped);
    while (const auto observation = stream.next()) {
      const auto* detections =
          dynamic_cast<const headway::CObservationObjectDetections*>(observation.get());
      if (detections != nullptr) useAll(*detections, skipped);
    }
  } catch (const headway::InputError&) {  // the file is no rawlog
  }
  return 0;
}
