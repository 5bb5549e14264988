// SPDX-License-Identifier: BSD-3-Clause
// Values, poses, cameras and images of MRPT's objects in a rawlog.
#include "object_reader.h"

#include <headway/core/error.h>
#include <headway/io/image_file.h>
#include <mrpt/core/exceptions.h>
#include <mrpt/system/datetime.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace headway::io {
namespace {

constexpr std::size_t kReadBytes = 1 << 17;  // at once
// Smaller files, such as those with images outside, are read in a few steps, so that the position
// in the file does not tell how much of its contents is processed.
constexpr std::uint64_t kSmallFile = 1 << 21;
constexpr std::uint64_t kMaxCounted = 1 << 27;  // bytes of such a file when decompressed

/// Uncompressed bytes of a file; nullopt if there are many.
std::optional<std::uint64_t> countContents(const std::string& path) {
  const auto file = openCompressed(path);
  std::vector<char> chunk(kReadBytes);
  std::uint64_t count = 0;
  while (count <= kMaxCounted) {
    const std::size_t got = file->read(chunk.data(), chunk.size());
    count += got;
    if (got < chunk.size()) return std::max<std::uint64_t>(1, count);
  }
  return std::nullopt;
}

}  // namespace

CompressedInput::CompressedInput(const std::string& path) : path_(path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path + ": is a folder, not a rawlog");
  }
  file_size_ = std::filesystem::file_size(path, error);
  if (error) throw InputError(path + ": cannot be opened: " + error.message());
  if (file_size_ == 0) throw InputError(path + ": is empty");
  file_ = openCompressed(path);
  const bool is_file = std::filesystem::is_regular_file(path, error);
  if (is_file && file_size_ <= kSmallFile) contents_ = countContents(path);
}

std::string_view CompressedInput::peek(std::size_t count) {
  if (filled_ - read_ < count && !at_end_) fill(count);
  return {buffer_.data() + read_, std::min(count, filled_ - read_)};
}

void CompressedInput::take(std::size_t count) { read_ += std::min(count, filled_ - read_); }

void CompressedInput::goTo(std::uint64_t position) {
  ASSERT_(position >= origin_ + mark_ && position <= origin_ + filled_);
  read_ = static_cast<std::size_t>(position - origin_);
}

std::string_view CompressedInput::at(std::uint64_t position, std::size_t count) const {
  ASSERT_(position >= origin_ && position + count <= origin_ + filled_);
  return {buffer_.data() + static_cast<std::size_t>(position - origin_), count};
}

/// Reads until `count` bytes follow, or the file ends.
void CompressedInput::fill(std::size_t count) {
  const std::size_t kept = std::min(mark_, read_);
  if (kept > 0) {
    std::memmove(buffer_.data(), buffer_.data() + kept, filled_ - kept);
    origin_ += kept;
    mark_ -= kept;
    read_ -= kept;
    filled_ -= kept;
  }
  while (filled_ - read_ < count) {
    const std::size_t chunk =
        std::min(std::max({count - (filled_ - read_), kReadBytes}), std::max(filled_, kReadBytes));
    if (buffer_.size() < filled_ + chunk) buffer_.resize(filled_ + chunk);
    const std::size_t got = file_->read(buffer_.data() + filled_, chunk);
    filled_ += got;
    if (got < chunk) {
      at_end_ = true;
      return;
    }
  }
}

std::string CompressedInput::compressionError() const { return file_->error(); }

double CompressedInput::progress() const {
  if (contents_) return static_cast<double>(position()) / static_cast<double>(*contents_);
  return std::min(1.0, static_cast<double>(file_->position()) / static_cast<double>(file_size_));
}

namespace {

constexpr std::size_t kMaxText = 4096;      // of labels, file names and classes
constexpr std::size_t kMaxMatrixSize = 64;  // rows and columns of calibrations and covariances

}  // namespace

std::string shortClassName(const std::string& name) {
  const auto colon = name.rfind(':');
  return colon == std::string::npos ? name : name.substr(colon + 1);
}

std::string_view ObjectReader::take(std::size_t count) {
  const std::string_view bytes = input_.peek(count);
  if (bytes.size() < count) throw UnexpectedEnd();
  input_.take(count);
  return bytes;
}

std::uint64_t ObjectReader::skip(std::size_t count) {
  const std::uint64_t position = input_.position();
  (void)take(count);
  return position;
}

bool ObjectReader::flag() {
  const auto byte = value<std::uint8_t>();
  if (byte > 1) throw BrokenObject("a bool is neither 0 nor 1");
  return byte == 1;
}

mrpt::Clock::time_point ObjectReader::time() {
  const auto ticks = value<std::int64_t>();
  return ticks > 0 ? mrpt::Clock::time_point(mrpt::Clock::duration(ticks)) : INVALID_TIMESTAMP;
}

std::string ObjectReader::text() {
  const auto length = value<std::uint32_t>();
  if (length > kMaxText) throw BrokenObject("a text is too long");
  return std::string(take(length));
}

std::string ObjectReader::className() {
  const auto first = value<std::uint8_t>();
  if ((first & kNameFlag) == 0) throw BrokenObject("an object is expected");
  return std::string(take(first & ~kNameFlag));
}

std::uint8_t ObjectReader::enter(std::initializer_list<const char*> class_names) {
  const std::string name = shortClassName(className());
  if (std::find(class_names.begin(), class_names.end(), name) == class_names.end()) {
    throw BrokenObject("an object has an unexpected class");
  }
  return value<std::uint8_t>();
}

std::uint8_t ObjectReader::enter(const char* class_name, std::uint8_t max_version) {
  const std::uint8_t version = enter({class_name});
  if (version > max_version) throw UnknownVersion(class_name, version);
  return version;
}

void ObjectReader::leave() {
  if (value<std::uint8_t>() != kEndMark) throw BrokenObject("an end mark is missing");
}

/// CMatrixF and CMatrixD of MRPT 2.5.8, version 0: rows, columns, values; CMatrix in older files.
std::vector<double> ObjectReader::matrix(std::size_t rows, std::size_t columns) {
  const std::string name = shortClassName(className());
  const auto version = value<std::uint8_t>();
  const bool is_float = name == "CMatrix" || name == "CMatrixF";
  if ((!is_float && name != "CMatrixD") || version != 0) throw BrokenObject("not a matrix");
  const std::size_t own_rows = value<std::uint32_t>();
  const std::size_t own_columns = value<std::uint32_t>();
  const bool is_any = rows == 0 && columns == 0;
  if (own_rows > kMaxMatrixSize || own_columns > kMaxMatrixSize ||
      (!is_any && (own_rows != rows || own_columns != columns))) {
    throw BrokenObject("a matrix has another size");
  }
  const std::size_t count = own_rows * own_columns;
  std::vector<double> result;
  if (is_float) {
    const auto floats = values<float>(count, count);
    result.assign(floats.begin(), floats.end());
  } else {
    result = values<double>(count, count);
  }
  leave();
  return result;
}

namespace {

mrpt::poses::CPose3DQuat quaternionPose(ObjectReader& in) {
  mrpt::poses::CPose3DQuat pose;
  for (unsigned i = 0; i < 7; ++i) pose[i] = in.value<double>();
  return pose;
}

/// Versions 0 and 1: a homogeneous matrix.
mrpt::poses::CPose3D matrixPose(ObjectReader& in) {
  const auto values = in.matrix(4, 4);
  mrpt::math::CMatrixDouble44 matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = values[static_cast<std::size_t>(i)];
  return mrpt::poses::CPose3D(matrix);
}

/// Version 3: position, then the rotation matrix.
mrpt::poses::CPose3D rotationPose(ObjectReader& in) {
  auto matrix = mrpt::math::CMatrixDouble44::Identity();
  for (int row = 0; row < 3; ++row) matrix(row, 3) = in.value<double>();
  for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = in.value<double>();
  return mrpt::poses::CPose3D(matrix);
}

}  // namespace

mrpt::poses::CPose2D readPose2D(ObjectReader& in) {
  const auto version = in.enter("CPose2D", 1);
  double values[3];
  for (double& one : values) {
    one = version == 0 ? static_cast<double>(in.value<float>()) : in.value<double>();
  }
  in.leave();
  return {values[0], values[1], values[2]};
}

mrpt::poses::CPose3D readPose3D(ObjectReader& in) {
  const auto version = in.enter("CPose3D", 3);
  mrpt::poses::CPose3D pose = version <= 1   ? matrixPose(in)
                              : version == 2 ? mrpt::poses::CPose3D(quaternionPose(in))
                                             : rotationPose(in);
  in.leave();
  return pose;
}

mrpt::poses::CPose3DQuat readPoseQuat(ObjectReader& in) {
  (void)in.enter("CPose3DQuat", 0);
  const auto pose = quaternionPose(in);
  in.leave();
  return pose;
}

/// The covariance follows the mean: its diagonal, then the upper triangle by rows.
mrpt::poses::CPose3DPDFGaussian readPosePdf(ObjectReader& in) {
  const int version = in.enter({"CPose3DPDFGaussian"});
  if (version != 1) throw UnknownVersion("CPose3DPDFGaussian", version);
  mrpt::poses::CPose3DPDFGaussian pdf;
  pdf.mean = readPose3D(in);
  for (int i = 0; i < 6; ++i) pdf.cov(i, i) = in.value<double>();
  for (int row = 0; row < 5; ++row) {
    for (int column = row + 1; column < 6; ++column) {
      pdf.cov(row, column) = pdf.cov(column, row) = in.value<double>();
    }
  }
  in.leave();
  return pdf;
}

void setIntrinsics(mrpt::img::TCamera& camera, const std::vector<double>& matrix) {
  camera.setIntrinsicParamsFromValues(matrix[0], matrix[4], matrix[2], matrix[5]);
}

mrpt::img::TCamera readCamera(ObjectReader& in) {
  const auto version = in.enter("TCamera", 6);
  mrpt::img::TCamera camera;
  camera.focalLengthMeters = in.value<double>();
  camera.dist.fill(0.0);
  const std::size_t coefficients = version >= 3 ? 8 : 5;
  for (std::size_t i = 0; i < coefficients; ++i) camera.dist[i] = in.value<double>();
  if (version >= 4) {
    double values[4];
    for (double& one : values) one = in.value<double>();
    camera.setIntrinsicParamsFromValues(values[0], values[1], values[2], values[3]);
  } else {
    setIntrinsics(camera, in.matrix(3, 3));
  }
  if (version == 0) (void)in.matrix(1, 5);
  camera.nrows = 480;  // versions 0 and 1 do not store the size
  camera.ncols = 640;
  if (version >= 2) {
    camera.nrows = in.value<std::uint32_t>();
    camera.ncols = in.value<std::uint32_t>();
  }
  if (version >= 5) camera.cameraName = in.text();
  camera.distortion = mrpt::img::DistortionModel::plumb_bob;
  if (version >= 6) {
    const auto model = in.value<std::uint8_t>();
    if (model > static_cast<std::uint8_t>(mrpt::img::DistortionModel::kannala_brandt)) {
      throw BrokenObject("a camera has an unknown distortion model");
    }
    camera.distortion = static_cast<mrpt::img::DistortionModel>(model);
  }
  in.leave();
  return camera;
}

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
  const auto data = decompressorOf(bytes, Compression::kZlib);
  char more = 0;
  const bool is_whole = data->read(pixels.ptr<char>(), pixels.total()) == pixels.total() &&
                        data->read(&more, 1) == 0 && data->error().empty();
  return is_whole ? pixels : cv::Mat();
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
