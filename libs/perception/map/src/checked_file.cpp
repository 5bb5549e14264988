// SPDX-License-Identifier: BSD-3-Clause
// The container of map files: named sections, compressed, with checksums, replaced as a whole.
#include "checked_file.h"

#include <headway/core/byte_archive.h>
#include <headway/core/compression.h>
#include <headway/core/error.h>
#include <headway/core/output_file.h>

#include <filesystem>
#include <fstream>
#include <utility>

namespace headway::map {
namespace {

constexpr std::string_view kMagic("HEADWAY\x1a", 8);
constexpr std::uint32_t kFormatVersion = 2;
constexpr std::size_t kHeaderSize = 8 + 4 + 8 + 8 + 4 + 4;
constexpr std::uint64_t kMaxCompression = 1100;  // zlib's is 1032

std::string headerOf(const Compressor& data) {
  ByteWriter header;
  header.bytes = kMagic;
  header.value(kFormatVersion);
  header.count(data.packedSize());
  header.count(data.plainSize());
  header.value(data.packedChecksum());
  header.value(checksum(header.bytes));
  return std::move(header.bytes);
}

void writeSection(Compressor& out, const SectionSource& section) {
  std::size_t size = 0;
  section.bytes([&size](std::string_view piece) { size += piece.size(); });
  ByteWriter head;
  head.value(static_cast<std::uint32_t>(section.name.size()));
  head.bytes += section.name;
  head.value(section.version);
  head.count(size);
  out.write(head.bytes);
  section.bytes([&out](std::string_view piece) { out.write(piece); });
}

/// Header and data; the header is written last, when the sizes are known.
void writeSections(std::ostream& file, const std::vector<SectionSource>& sections) {
  file << std::string(kHeaderSize, '\0');
  Compressor data(file, Compression::kZlib);
  for (const auto& section : sections) writeSection(data, section);
  data.finish();
  file.seekp(0);
  file << headerOf(data);
}

/// Decompressed data of a stated size.
class Contents {
 public:
  Contents(std::string_view packed, std::uint64_t size)
      : data_(decompressorOf(packed, Compression::kZlib)), left_(size) {}

  [[nodiscard]] bool atEnd() const { return left_ == 0; }
  std::string take(std::uint64_t size) {
    if (size > left_) throw InputError("damaged: the data end early");
    std::string bytes(size, '\0');
    if (data_->read(bytes.data(), size) < size) {
      throw InputError("damaged: cannot be decompressed to the size that its header states");
    }
    left_ -= size;
    return bytes;
  }
  template <typename T>
  T value() {
    return ByteReader(take(sizeof(T))).value<T>();
  }

 private:
  std::unique_ptr<Decompressor> data_;
  std::uint64_t left_;
};

Section nextSection(Contents& in) {
  Section section;
  section.name = in.take(in.value<std::uint32_t>());
  section.version = in.value<std::uint32_t>();
  section.bytes = in.take(in.value<std::uint64_t>());
  return section;
}

std::string contentsOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path)) throw InputError("no such file");
  std::string contents(std::filesystem::file_size(path), '\0');
  file.read(contents.data(), static_cast<std::streamsize>(contents.size()));
  contents.resize(static_cast<std::size_t>(file.gcount()));
  return contents;
}

struct Header {
  std::uint32_t version = 0;
  std::uint64_t packed_size = 0;
  std::uint64_t plain_size = 0;
  std::uint32_t packed_checksum = 0;
};

void requireKnownVersion(std::uint32_t version) {
  const std::string found = "format version " + std::to_string(version);
  const std::string known = std::to_string(kFormatVersion);
  if (version < kFormatVersion) {
    throw InputError("of " + found + ", and this program reads " + known +
                     "; replay its rawlog again to make a new one");
  }
  if (version > kFormatVersion) {
    throw InputError("of " + found + ", newer than " + known +
                     " which this program supports; update headway");
  }
}

Header parseHeader(std::string_view whole) {
  if (whole.substr(0, kMagic.size()) != kMagic.substr(0, whole.size()) || whole.empty()) {
    throw InputError("not a headway map");
  }
  if (whole.size() < kHeaderSize) throw InputError("truncated: it ends within its header");
  ByteReader reader(whole.substr(kMagic.size(), kHeaderSize - kMagic.size()));
  Header header;
  header.version = reader.value<std::uint32_t>();
  header.packed_size = reader.value<std::uint64_t>();
  header.plain_size = reader.value<std::uint64_t>();
  header.packed_checksum = reader.value<std::uint32_t>();
  if (reader.value<std::uint32_t>() != checksum(whole.substr(0, kHeaderSize - 4))) {
    throw InputError("damaged: the checksum of its header does not match");
  }
  requireKnownVersion(header.version);
  return header;
}

}  // namespace

void writeCheckedFile(const std::string& path, const std::vector<SectionSource>& sections) {
  OutputFile file(path);
  writeSections(file.stream(), sections);
  file.commit();
}

void writeCheckedFile(const std::string& path, const std::vector<Section>& sections) {
  std::vector<SectionSource> sources;
  for (const Section& section : sections) {
    sources.push_back({section.name, section.version, sourceOf(section.bytes)});
  }
  writeCheckedFile(path, sources);
}

std::vector<Section> readCheckedFile(const std::string& path) {
  const std::string contents = contentsOf(path);
  const Header header = parseHeader(contents);
  const auto packed = std::string_view(contents).substr(kHeaderSize);
  if (packed.size() < header.packed_size) {
    throw InputError("truncated: " + std::to_string(packed.size()) + " of " +
                     std::to_string(header.packed_size) + " bytes are there");
  }
  if (packed.size() > header.packed_size ||
      header.plain_size > kMaxCompression * (header.packed_size + 1) ||
      checksum(packed) != header.packed_checksum) {
    throw InputError("damaged: its checksum does not match");
  }
  std::vector<Section> sections;
  for (Contents in(packed, header.plain_size); !in.atEnd();) sections.push_back(nextSection(in));
  return sections;
}

}  // namespace headway::map
