// SPDX-License-Identifier: BSD-3-Clause
// Values, poses, cameras and images of MRPT's objects in a rawlog. Read here and not by MRPT's
// CArchive, which allocates what a length in a file asks for.
#pragma once

#include <headway/core/compression.h>
#include <mrpt/core/Clock.h>
#include <mrpt/img/CImage.h>
#include <mrpt/img/TCamera.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPose3DQuat.h>

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace headway::io {

/// Input of a compressed or plain file, from which bytes can be looked at before they are taken
/// and to which a reader can return after a failure.
///
/// The buffer grows only with bytes that the file has supplied, so that a length in a broken file
/// allocates no more than twice of what the file contains.
class CompressedInput {
 public:
  /// @throws InputError if the file cannot be opened or is empty
  explicit CompressedInput(const std::string& path);
  ~CompressedInput() = default;
  CompressedInput(const CompressedInput&) = delete;
  CompressedInput& operator=(const CompressedInput&) = delete;

  /// The next bytes, without taking them; fewer than `count` only at the end of the file or on an
  /// error. Valid until the next call.
  [[nodiscard]] std::string_view peek(std::size_t count);
  /// Takes bytes that peek() has returned.
  void take(std::size_t count);

  /// Keeps all bytes from here on, for goTo() and at().
  void mark() { mark_ = read_; }
  /// Continues at a position between the mark and the last byte looked at.
  void goTo(std::uint64_t position);
  /// Bytes between the mark and the last byte looked at. Valid until the next peek().
  [[nodiscard]] std::string_view at(std::uint64_t position, std::size_t count) const;

  /// Number of uncompressed bytes taken so far.
  [[nodiscard]] std::uint64_t position() const { return origin_ + read_; }
  /// The decompressor's error message; empty if there is none.
  [[nodiscard]] std::string compressionError() const;
  /// Ratio of the file taken so far, 0 to 1.
  [[nodiscard]] double progress() const;

 private:
  void fill(std::size_t count);

  std::string path_;
  std::uint64_t file_size_ = 0;
  std::optional<std::uint64_t> contents_;  ///< uncompressed bytes of a small file
  std::vector<char> buffer_;
  std::uint64_t origin_ = 0;  ///< position of the first byte of the buffer
  std::size_t mark_ = 0;      ///< in the buffer, as the following
  std::size_t read_ = 0;
  std::size_t filled_ = 0;
  bool at_end_ = false;
  std::unique_ptr<Decompressor> file_;
};

/// An object that cannot be read. It costs itself only: the reader continues at the next object.
class BrokenObject : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The file ends within an object.
class UnexpectedEnd : public BrokenObject {
 public:
  UnexpectedEnd() : BrokenObject("the file ends within an object") {}
};

/// An object of a version that is not known: of a later MRPT, as a rule.
class UnknownVersion : public BrokenObject {
 public:
  /// @param class_name  of an object within the observation; empty: the observation itself
  UnknownVersion(const std::string& class_name, int version)
      : BrokenObject((class_name.empty() ? "" : class_name + "_") + "version_" +
                     std::to_string(version)) {}
};

/// Class name without namespace: "mrpt::obs::CObservationImage" gives "CObservationImage".
[[nodiscard]] std::string shortClassName(const std::string& name);

/// First byte of an object, with the length of its class name, and last byte.
inline constexpr unsigned char kNameFlag = 0x80, kEndMark = 0x88;

/// Reads the values of objects in MRPT's format, with all lengths checked against a limit and
/// against the file before anything is allocated.
///
/// The format (MRPT's CArchive, unchanged from MRPT 0.9 to 3.0; little-endian): an object is the
/// length of its class name with the highest bit set, the name, a version byte, its values, and an
/// end mark. Strings and vectors are preceded by their length as uint32.
class ObjectReader {
 public:
  /// @param input  its mark is where the object begins
  explicit ObjectReader(CompressedInput& input) : input_(input) {}

  template <typename T>
  [[nodiscard]] T value() {
    static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>, "bool: see flag()");
    T result;
    std::memcpy(&result, take(sizeof(T)).data(), sizeof(T));
    return result;
  }

  /// A bool. @throws BrokenObject if it is neither 0 nor 1
  [[nodiscard]] bool flag();
  /// INVALID_TIMESTAMP if it is before the clock's epoch.
  [[nodiscard]] mrpt::Clock::time_point time();
  /// @throws BrokenObject if it is longer than labels and file names are
  [[nodiscard]] std::string text();

  template <typename T>
  [[nodiscard]] std::vector<T> values(std::size_t count, std::size_t max_count) {
    if (count > max_count) throw BrokenObject("a vector is too long");
    const std::string_view bytes = take(count * sizeof(T));
    std::vector<T> result(count);
    if (count > 0) std::memcpy(result.data(), bytes.data(), bytes.size());
    return result;
  }
  /// A vector preceded by its length.
  template <typename T>
  [[nodiscard]] std::vector<T> vector(std::size_t max_count) {
    const auto count = value<std::uint32_t>();
    return values<T>(count, max_count);
  }
  /// A matrix object of MRPT, row-major.
  [[nodiscard]] std::vector<double> matrix(std::size_t rows, std::size_t columns);

  /// Skips bytes; returns their position.
  std::uint64_t skip(std::size_t count);

  /// Begins an object of one of these classes (without namespace); returns its version.
  std::uint8_t enter(std::initializer_list<const char*> class_names);
  /// Begins an object of this class whose version must not be greater.
  std::uint8_t enter(const char* class_name, std::uint8_t max_version);
  /// Requires the end mark of the object.
  void leave();

  /// Bytes skipped before.
  [[nodiscard]] std::string_view at(std::uint64_t position, std::size_t count) const {
    return input_.at(position, count);
  }

 private:
  std::string_view take(std::size_t count);
  std::string className();

  CompressedInput& input_;
};

// Poses and cameras as objects within observations; each throws BrokenObject if it cannot be read.

[[nodiscard]] mrpt::poses::CPose2D readPose2D(ObjectReader& in);              ///< versions 0 and 1
[[nodiscard]] mrpt::poses::CPose3D readPose3D(ObjectReader& in);              ///< versions 0 to 3
[[nodiscard]] mrpt::poses::CPose3DQuat readPoseQuat(ObjectReader& in);        ///< version 0
[[nodiscard]] mrpt::poses::CPose3DPDFGaussian readPosePdf(ObjectReader& in);  ///< version 1
[[nodiscard]] mrpt::img::TCamera readCamera(ObjectReader& in);                ///< versions 0 to 6

/// Sets the intrinsic parameters from a 3x3 matrix, as cameras of old versions store them.
void setIntrinsics(mrpt::img::TCamera& camera, const std::vector<double>& matrix);

/// Where and how a rawlog stores an image.
///
/// It is decoded only after its object has been read to the end mark, so that bytes are not decoded
/// more than once in broken files.
struct RecordedImage {
  enum class Storage { kNone, kExternal, kGrey, kZippedGrey, kBgr, kRgb, kEncoded, kUnsupported };
  Storage storage = Storage::kNone;
  std::string file;            ///< kExternal: its name
  int width = 0;               ///< [px]; 0 with kExternal and kEncoded
  int height = 0;              ///< [px]
  std::uint64_t position = 0;  ///< of the pixels or the encoded image in the stream
  std::size_t bytes = 0;       ///< their number
};

/// Reads an object of MRPT's class CImage, versions 0 to 10 and 100.
///
/// @throws BrokenObject if it is not such an object, or larger than kMaxImagePixels
[[nodiscard]] RecordedImage readImage(ObjectReader& in);

/// The image with its pixels copied or decoded; empty if it is broken.
[[nodiscard]] mrpt::img::CImage mrptImage(const RecordedImage& image, const ObjectReader& in);

}  // namespace headway::io
