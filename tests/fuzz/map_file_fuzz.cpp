// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of map files; the first byte selects the section that the input replaces, with
// valid checksums, because no mutation finds those.
#include <headway/core/error.h>
#include <headway/map/map_file.h>
#include <headway/map/static_grid.h>
#include <headway/slam/stereo_slam.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "checked_file.h"
#include "memory_file.h"

namespace {

constexpr std::array<const char*, 5> kSections = {"configuration", "camera", "static_map", "layers",
                                                  "attachment:other"};

void readSection(const std::string& name, const std::string& bytes) {
  using namespace headway::map;
  // In memory: a new file for each process.
  static const std::string path = "/dev/shm/headway-fuzz-" + std::to_string(getpid());
  writeCheckedFile(path, {{name, 1, bytes}});
  (void)loadMap(path);
}

void read(std::uint8_t selected, const std::string& bytes) {
  using namespace headway;
  if (selected < kSections.size()) return readSection(kSections.at(selected), bytes);
  if (selected == kSections.size()) {
    map::StaticGrid grid({});
    grid.load(bytes);
  } else {
    (void)slam::savedMapView(bytes, Pose::Identity());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    const std::uint8_t selected = data[0] % (kSections.size() + 3);
    if (selected == kSections.size() + 2) {
      (void)headway::map::loadMap(headway::test::MemoryFile(data + 1, size - 1).path());
    } else {
      read(selected, std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
    }
  } catch (const headway::InputError&) {  // expected of most inputs
  }
  return 0;
}
