// libFuzzer target of the rawlog reader: no input may crash, hang or take much memory.
#include <headway/core/error.h>
#include <headway/io/detection_observation.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "observation_stream.h"

namespace {

/// A file in memory, because rawlogs are read by path.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("rawlog", 0)) {
    if (write(descriptor_, data, size) != static_cast<ssize_t>(size)) {
      throw std::runtime_error("the input cannot be written");
    }
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const MemoryFile file(data, size);
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
