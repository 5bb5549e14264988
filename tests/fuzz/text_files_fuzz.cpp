// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of the readers of text files; the first byte selects one of them.
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <cstddef>
#include <cstdint>

#include "memory_file.h"
#include "yaml_parsers.h"

namespace {

void read(int reader, const std::string& path) {
  using namespace headway;
  DropCounts dropped;
  switch (reader) {
    case 0:
      (void)io::readCalibration(path);
      break;
    case 1:
      (void)io::readRawCalibration(path);
      break;
    case 2:
      (void)io::readTum(path);
      break;
    case 3:
      (void)io::readKittiPoses(path);
      break;
    case 4:
      (void)io::readTrackCsv(path);
      break;
    case 5:
      (void)io::readPredictionCsv(path);
      break;
    case 6:
      (void)io::readKittiRows(path);
      break;
    case 7:
      (void)io::readDetections(path, dropped);
      break;
    case 8:
      (void)io::readKittiProjections(path);
      break;
    case 9:
      (void)io::PoseFile(path, Pose::Identity()).at(1, 0.1);
      break;
    default:
      (void)io::readStereoCalibration(path, {752, 480});
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const headway::test::MemoryFile file(data + 1, size - 1);
  try {
    read(data[0] % 11, file.path());
  } catch (const headway::InputError&) {  // expected of most inputs
  }
  headway::test::freeYamlParsers();
  return 0;
}
