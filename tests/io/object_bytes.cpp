// SPDX-License-Identifier: BSD-3-Clause
#include "object_bytes.h"

#include <headway/io/mrpt_time.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "foreign_recording.h"

namespace headway::io::test {

std::string textBytes(const std::string& text) {
  return bytesOf(static_cast<std::uint32_t>(text.size())) + text;
}

std::string objectBytes(const std::string& class_name, int version, const std::string& values) {
  return std::string(1, static_cast<char>(0x80 | class_name.size())) + class_name +
         static_cast<char>(version) + values + '\x88';
}

std::string mrptBytes(const mrpt::serialization::CSerializable& object) {
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << object;
  return {static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()};
}

mrpt::serialization::CSerializable::Ptr mrptRead(const std::string& bytes) {
  mrpt::io::CMemoryStream stream;
  stream.Write(bytes.data(), bytes.size());
  stream.Seek(0);
  auto archive = mrpt::serialization::archiveFrom(stream);
  return archive.ReadObject();
}

void keepAsSeed(const std::string& content) {
  constexpr std::size_t kMaxSeedBytes = 8000;
  const char* folder = std::getenv("HEADWAY_FUZZ_SEEDS");
  if (folder == nullptr || content.size() > kMaxSeedBytes) return;
  const std::string name = std::to_string(std::hash<std::string>()(content));
  writeContent(std::string(folder) + "/" + name, content);
}

std::string imageBytes() {
  return mrptBytes(mrpt::img::CImage(wall(3).left, mrpt::img::DEEP_COPY));
}

std::string jpegImageBytes(const cv::Mat& image) {
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", image, jpeg);
  return objectBytes("mrpt::img::CImage", 9,
                     bytesOf(false, true, image.cols, image.rows) +
                         textBytes(std::string(jpeg.begin(), jpeg.end())));
}

std::string stereoBytes(int frame, const std::string& left, const std::string& right) {
  const auto stereo = wallObservation(frame, frameTime(static_cast<std::size_t>(frame)));
  return objectBytes("mrpt::obs::CObservationStereoImages", 6,
                     mrptBytes(stereo->cameraPose) + mrptBytes(stereo->leftCamera) +
                         mrptBytes(stereo->rightCamera) + left + bytesOf(false, true) + right +
                         bytesOf(stereo->timestamp.time_since_epoch().count()) +
                         mrptBytes(stereo->rightCameraPose) + textBytes("stereo"));
}

}  // namespace headway::io::test
