// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of ROS messages in both encodings; the first byte selects type and encoding.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "bag_file.h"
#include "messages.h"
#include "observations.h"

namespace {

void decode(int type, std::string_view bytes, headway::bags::Encoding encoding) {
  using namespace headway::bags;
  switch (type) {
    case 0: {
      const auto image = decodeImageMessage(bytes, encoding);
      (void)pictureFrom(image);
      (void)depthFrom(image);
      break;
    }
    case 1: {
      const auto image = decodeCompressedImage(bytes, encoding);
      (void)pictureFrom(image);
      (void)depthFrom(image);
      break;
    }
    case 2:
      (void)decodeCameraInfo(bytes, encoding);
      break;
    case 3:
      (void)decodeImu(bytes, encoding);
      break;
    case 4:
      (void)decodeOdometry(bytes, encoding);
      break;
    case 5:
      (void)scanFrom(decodeLaserScan(bytes, encoding), 0.0, headway::Pose::Identity());
      break;
    case 6:
      (void)decodeNavSatFix(bytes, encoding);
      break;
    default:
      (void)decodeTransforms(bytes, encoding);
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using headway::bags::Encoding;
  if (size == 0) return 0;
  try {
    decode(data[0] % 8, std::string_view(reinterpret_cast<const char*>(data) + 1, size - 1),
           data[0] < 128 ? Encoding::kRos1 : Encoding::kCdr);
  } catch (const headway::bags::BrokenData&) {  // expected of most inputs
  }
  return 0;
}
