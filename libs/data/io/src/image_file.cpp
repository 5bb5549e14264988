// SPDX-License-Identifier: BSD-3-Clause
// Decoding of images within limits. Sizes are read from headers here, because OpenCV allocates
// before it checks, and lets libjpeg and libpng print.
#include <headway/io/image_file.h>

#include <cctype>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

// After cstdio, on which it depends.
#include <jpeglib.h>
#include <png.h>

namespace headway::io {
namespace {

constexpr int kMaxScans = 100;  // of a progressive JPEG; ordinary ones have 10

/// libjpeg's error handler: errors and warnings end the decoding, and nothing is printed.
struct JpegErrors {
  jpeg_error_mgr manager{};  // first, so that libjpeg's pointer is one to the whole
  std::jmp_buf end{};
};

void endDecoding(j_common_ptr info) {
  std::longjmp(reinterpret_cast<JpegErrors*>(info->err)->end, 1);
}

void onMessage(j_common_ptr info, int level) {
  if (level < 0) endDecoding(info);
}

void onProgress(j_common_ptr info) {
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > kMaxScans) endDecoding(info);
}

bool isWithinLimits(std::uint64_t width, std::uint64_t height) {
  return width > 0 && height > 0 && width <= kMaxImageSide && height <= kMaxImageSide &&
         width * height <= kMaxImagePixels;
}

/// Decodes into `pixels`; false on an error. No object with a destructor lives between the
/// long jumps.
bool decodeJpegTo(cv::Mat& pixels, std::string_view bytes, jpeg_decompress_struct& info,
                  JpegErrors& errors) {
  if (setjmp(errors.end) != 0) return false;
  jpeg_create_decompress(&info);
  jpeg_progress_mgr progress{};
  progress.progress_monitor = onProgress;
  info.progress = &progress;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&info, TRUE);
  if (!isWithinLimits(info.image_width, info.image_height)) return false;
  const bool is_grey = info.num_components == 1;
  if (!is_grey && info.num_components != 3) return false;
  info.out_color_space = is_grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_start_decompress(&info);
  pixels.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width),
                is_grey ? CV_8UC1 : CV_8UC3);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = pixels.ptr(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

cv::Mat decodeJpeg(std::string_view bytes) {
  jpeg_decompress_struct info{};
  JpegErrors errors;
  info.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = endDecoding;
  errors.manager.emit_message = onMessage;
  cv::Mat pixels;
  const bool is_whole = decodeJpegTo(pixels, bytes, info, errors);
  jpeg_destroy_decompress(&info);
  return is_whole ? pixels : cv::Mat();
}

void readPngBytes(png_structp png, png_bytep to, png_size_t size) {
  auto& rest = *static_cast<std::string_view*>(png_get_io_ptr(png));
  if (size > rest.size()) png_error(png, "cut off");
  std::memcpy(to, rest.data(), size);
  rest.remove_prefix(size);
}

/// libpng's error handlers: errors end the decoding, and nothing is printed.
void onPngError(png_structp png, png_const_charp /*text*/) { png_longjmp(png, 1); }
void onPngWarning(png_structp /*png*/, png_const_charp /*text*/) {}

/// As decodeJpegTo(): grey or BGR, of 8 or 16 bits, without transparency.
bool decodePngTo(cv::Mat& pixels, std::vector<png_bytep>& rows, png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  // Which the header needs not be the first chunk of, as headerSize() takes it.
  if (!isWithinLimits(png_get_image_width(png, info), png_get_image_height(png, info)))
    return false;
  png_set_expand(png);  // palettes, and grey of fewer bits
  png_set_strip_alpha(png);
  png_set_bgr(png);
  png_set_swap(png);  // the bytes of 16 bits
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  const int depth = png_get_bit_depth(png, info) == 16 ? CV_16U : CV_8U;
  pixels.create(static_cast<int>(png_get_image_height(png, info)),
                static_cast<int>(png_get_image_width(png, info)),
                CV_MAKETYPE(depth, png_get_channels(png, info)));
  for (int y = 0; y < pixels.rows; ++y) rows.push_back(pixels.ptr(y));
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  return true;
}

cv::Mat decodePng(std::string_view bytes) {
  png_structp png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, onPngError, onPngWarning);
  png_infop info = png_create_info_struct(png);
  png_set_read_fn(png, &bytes, readPngBytes);
  cv::Mat pixels;
  std::vector<png_bytep> rows;
  const bool is_whole = decodePngTo(pixels, rows, png, info);
  png_destroy_read_struct(&png, &info, nullptr);
  return is_whole ? pixels : cv::Mat();
}

bool beginsWith(std::string_view bytes, std::string_view start) {
  return bytes.substr(0, start.size()) == start;
}

bool isPng(std::string_view bytes) { return beginsWith(bytes, "\x89PNG\r\n\x1a\n"); }

/// An unsigned number of `size` bytes; 0 beyond the end.
std::uint64_t numberAt(std::string_view bytes, std::size_t at, std::size_t size, bool big_endian) {
  if (at + size > bytes.size() || at + size < at) return 0;
  std::uint64_t result = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t index = at + (big_endian ? i : size - 1 - i);
    result = (result << 8) | static_cast<unsigned char>(bytes[index]);
  }
  return result;
}

struct ImageSize {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};

/// Width and height in the header of a PBM, PGM or PPM; comments begin with '#'.
ImageSize pnmSize(std::string_view bytes) {
  std::uint64_t numbers[2] = {0, 0};
  std::size_t at = 2;
  for (auto& number : numbers) {
    while (at < bytes.size() &&
           (std::isspace(static_cast<unsigned char>(bytes[at])) != 0 || bytes[at] == '#')) {
      if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
      ++at;
    }
    for (; at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])) != 0; ++at) {
      number = std::min<std::uint64_t>(10 * number + static_cast<std::uint64_t>(bytes[at] - '0'),
                                       1U << 30);
    }
  }
  return {numbers[0], numbers[1]};
}

/// Width and height in the first directory of a TIFF (tags 256 and 257).
ImageSize tiffSize(std::string_view bytes) {
  const bool big_endian = bytes[0] == 'M';
  const auto number = [&](std::size_t at, std::size_t size) {
    return numberAt(bytes, at, size, big_endian);
  };
  const auto directory = static_cast<std::size_t>(number(4, 4));
  const std::size_t entries = number(directory, 2);
  ImageSize size;
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * i;
    const bool is_short = number(entry + 2, 2) == 3;
    const std::uint64_t value = number(entry + 8, is_short ? 2 : 4);
    if (number(entry, 2) == 256) size.width = value;
    if (number(entry, 2) == 257) size.height = value;
  }
  return size;
}

/// Size in the header of an image; 0 x 0 for other formats.
ImageSize headerSize(std::string_view bytes) {
  if (isPng(bytes)) {
    return {numberAt(bytes, 16, 4, true), numberAt(bytes, 20, 4, true)};
  }
  if (beginsWith(bytes, "BM")) {
    const auto height = static_cast<std::int32_t>(numberAt(bytes, 22, 4, false));
    return {numberAt(bytes, 18, 4, false),
            static_cast<std::uint64_t>(std::abs(static_cast<std::int64_t>(height)))};
  }
  if (beginsWith(bytes, std::string_view("II*\0", 4)) ||
      beginsWith(bytes, std::string_view("MM\0*", 4))) {
    return tiffSize(bytes);
  }
  if (bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') {
    return pnmSize(bytes);
  }
  return {};
}

/// Any format but JPEG; empty if it is broken or its header states a size beyond the limits.
cv::Mat decodedWithinLimits(std::string_view bytes) {
  const ImageSize size = headerSize(bytes);
  if (!isWithinLimits(size.width, size.height)) return {};
  if (isPng(bytes)) return decodePng(bytes);
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1,
                          const_cast<char*>(bytes.data()));
    const cv::Mat image = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
    return image.empty() ? cv::Mat() : image;  // a released image keeps the type of its header
  } catch (const cv::Exception&) {
    return {};
  }
}

/// 8-bit grey or BGR image without transparency; empty for other types.
cv::Mat withoutTransparency(const cv::Mat& image) {
  if (image.type() == CV_8UC1 || image.type() == CV_8UC3) return image;
  cv::Mat result;
  if (image.type() == CV_8UC4) cv::cvtColor(image, result, cv::COLOR_BGRA2BGR);
  return result;
}

constexpr std::uintmax_t kMaxFileBytes = 1 << 28;  // of an image, more than any within the limits

/// The content of an image file; empty if it is missing or larger than any.
std::string imageBytesOf(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  const auto size = std::filesystem::file_size(path, error);
  if (error || size == 0 || size > kMaxFileBytes) return {};
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file ? bytes : std::string();
}

}  // namespace

cv::Mat decodeDepthImage(std::string_view bytes) {
  if (!isPng(bytes)) return {};
  const cv::Mat image = decodedWithinLimits(bytes);
  return image.type() == CV_16UC1 ? image : cv::Mat();
}

cv::Mat decodeImage(std::string_view bytes) {
  if (beginsWith(bytes, "\xFF\xD8\xFF")) return decodeJpeg(bytes);
  return withoutTransparency(decodedWithinLimits(bytes));
}

bool isDeepImage(std::string_view bytes) { return decodedWithinLimits(bytes).depth() == CV_16U; }

cv::Mat loadImage(const std::string& path) { return decodeImage(imageBytesOf(path)); }

cv::Mat loadGreyImage(const std::string& path) { return greyOf(loadImage(path)); }

cv::Mat loadDepthImage(const std::string& path) { return decodeDepthImage(imageBytesOf(path)); }

bool isDeepImageFile(const std::string& path) { return isDeepImage(imageBytesOf(path)); }

cv::Mat greyOf(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace headway::io
