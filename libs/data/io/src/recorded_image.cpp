// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_image.h"

#include <headway/io/image_decoding.h>
#include <zlib.h>

#include <opencv2/imgproc.hpp>

namespace headway::io {
namespace {

using Storage = RecordedImage::Storage;

constexpr std::size_t kMaxEncodedBytes = 1 << 26;  // of one JPEG
constexpr std::int32_t kMaxUnzipped = 16 * 1024;   // version 4 stores smaller images as they are

void setSize(RecordedImage& image, std::int64_t width, std::int64_t height) {
  if (width < 0 || height < 0 || width > kMaxImageSide || height > kMaxImageSide ||
      width * height > kMaxImagePixels) {
    throw BrokenObject("an image is too large");
  }
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
}

void skipContent(RecordedImage& image, std::size_t bytes, ObjectReader& in) {
  image.bytes = bytes;
  image.position = in.skip(bytes);
}

void readEncoded(RecordedImage& image, ObjectReader& in) {
  const auto bytes = in.value<std::uint32_t>();
  if (bytes > kMaxEncodedBytes) throw BrokenObject("an encoded image is too large");
  image.storage = Storage::kEncoded;
  skipContent(image, bytes, in);
}

/// Pixels of a size, stored as they are.
void readRaw(RecordedImage& image, Storage storage, ObjectReader& in) {
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  image.storage = pixels > 0 ? storage : Storage::kNone;
  skipContent(image, storage == Storage::kGrey ? pixels : 3 * pixels, in);
}

void readGrey(RecordedImage& image, std::uint8_t version, ObjectReader& in) {
  const auto width = in.value<std::int32_t>();
  const auto height = in.value<std::int32_t>();
  if (version < 10) (void)in.value<std::int32_t>();  // origin
  const auto bytes = in.value<std::uint32_t>();
  if (version >= 9) (void)in.value<std::int32_t>();  // depth, which follows from the bytes
  setSize(image, width, height);
  const auto pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  bool is_zipped = version == 3 || (version == 4 && bytes > kMaxUnzipped);
  if (version >= 5 && version < 10) is_zipped = in.flag();
  if (is_zipped) {
    const auto zipped = in.value<std::uint32_t>();
    if (zipped > kMaxEncodedBytes) throw BrokenObject("a compressed image is too large");
    skipContent(image, zipped, in);
    image.storage = bytes == pixels ? Storage::kZippedGrey : Storage::kUnsupported;
  } else if (bytes == pixels) {
    readRaw(image, Storage::kGrey, in);
  } else if (pixels > 0 && bytes % pixels == 0 && bytes / pixels <= sizeof(double)) {
    skipContent(image, bytes, in);
    image.storage = Storage::kUnsupported;  // 16 bits and more
  } else {
    throw BrokenObject("an image has another number of bytes than pixels");
  }
}

void readColour(RecordedImage& image, std::uint8_t version, ObjectReader& in) {
  if (version < 7) return readEncoded(image, in);
  const std::int64_t width = in.value<std::int32_t>();
  const std::int64_t height = in.value<std::int32_t>();
  if (version == 10) {
    setSize(image, width, height);
    readRaw(image, Storage::kRgb, in);
  } else if (width >= 1 && height >= 1) {
    readEncoded(image, in);
  } else if (width < 0 && height < 0) {  // stored as it is: marked by negative sizes
    setSize(image, -width, -height);
    readRaw(image, Storage::kBgr, in);
  }
}

void readVersion0(RecordedImage& image, ObjectReader& in) {
  const auto width = in.value<std::uint32_t>();
  const auto height = in.value<std::uint32_t>();
  const auto channels = in.value<std::uint32_t>();
  (void)in.value<std::uint8_t>();  // origin
  const auto bytes = in.value<std::uint32_t>();
  setSize(image, width, height);
  if (channels != 1 && channels != 3) throw BrokenObject("an image has unknown channels");
  readRaw(image, channels == 1 ? Storage::kGrey : Storage::kBgr, in);
  if (image.bytes != bytes) throw BrokenObject("an image has padded rows");
}

cv::Mat unzipped(const RecordedImage& image, std::string_view bytes) {
  cv::Mat pixels(image.height, image.width, CV_8UC1);
  uLongf size = pixels.total();
  const int status = uncompress(pixels.data, &size, reinterpret_cast<const Bytef*>(bytes.data()),
                                static_cast<uLong>(bytes.size()));
  return status == Z_OK && size == pixels.total() ? pixels : cv::Mat();
}

cv::Mat pixelsOf(const RecordedImage& image, std::string_view bytes) {
  const auto view = [&](int type) {
    return cv::Mat(image.height, image.width, type, const_cast<char*>(bytes.data()));
  };
  cv::Mat result;
  switch (image.storage) {
    case Storage::kGrey:
      return view(CV_8UC1).clone();
    case Storage::kBgr:
      return view(CV_8UC3).clone();
    case Storage::kRgb:
      cv::cvtColor(view(CV_8UC3), result, cv::COLOR_RGB2BGR);
      return result;
    case Storage::kZippedGrey:
      return unzipped(image, bytes);
    case Storage::kEncoded:
      return decodeImage(bytes);
    case Storage::kUnsupported:  // kept for its type, which is refused by name
      if (image.bytes ==
          2 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height)) {
        result = view(CV_16UC1).clone();
      }
      break;
    case Storage::kNone:
    case Storage::kExternal:
      break;
  }
  return result;
}

}  // namespace

/// As CImage::serializeFrom() of MRPT 2.5.8 (versions 0 to 9, and 100 of builds without OpenCV) and
/// of MRPT 3.0 (version 10).
RecordedImage readImage(ObjectReader& in) {
  RecordedImage image;
  const std::uint8_t version = in.enter({"CImage"});
  if (version > 10 && version != 100) throw UnknownVersion("CImage", version);
  if (version >= 6 && in.flag()) {
    image.storage = Storage::kExternal;
    image.file = in.text();
  } else if (version == 0) {
    readVersion0(image, in);
  } else if (version == 1) {
    readEncoded(image, in);
  } else if (version <= 10) {
    if (in.flag()) {
      readColour(image, version, in);
    } else {
      readGrey(image, version, in);
    }
  }
  in.leave();
  return image;
}

mrpt::img::CImage mrptImage(const RecordedImage& image, const ObjectReader& in) {
  mrpt::img::CImage result;
  if (image.storage == Storage::kExternal) {
    result.setExternalStorage(image.file);
  } else if (image.storage != Storage::kNone) {
    const cv::Mat pixels = pixelsOf(image, in.at(image.position, image.bytes));
    if (!pixels.empty()) result = mrpt::img::CImage(pixels, mrpt::img::SHALLOW_COPY);
  }
  return result;
}

}  // namespace headway::io
