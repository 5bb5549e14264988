#include "checked_file.h"

#include <headway/core/byte_archive.h>
#include <headway/core/error.h>
#include <mrpt/io/zip.h>
#include <mrpt/system/crc.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace headway::map {
namespace {

constexpr std::string_view kMagic("HEADWAY\x1a", 8);
constexpr std::uint32_t kFormatVersion = 2;
constexpr std::size_t kHeaderSize = 8 + 4 + 8 + 8 + 4 + 4;
constexpr std::uint64_t kLargestCompression = 1100;  ///< zlib's is 1032

std::uint32_t checksum(std::string_view bytes) {
  return mrpt::system::compute_CRC32(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                     bytes.size());
}

/// @param plain  is not changed; MRPT's signature lacks the const
std::string compressed(std::string& plain) {
  std::vector<unsigned char> out;
  mrpt::io::zip::compress(plain.data(), plain.size(), out);
  return {out.begin(), out.end()};
}

std::string decompressed(std::string_view packed, std::uint64_t plain_size) {
  std::string plain(plain_size, '\0');
  std::size_t actual = 0;
  try {
    mrpt::io::zip::decompress(const_cast<char*>(packed.data()), packed.size(), plain.data(),
                              plain.size(), actual);
  } catch (const std::exception&) {
    throw InputError("damaged: cannot be decompressed");
  }
  if (actual != plain_size) throw InputError("damaged: fewer data than its header states");
  return plain;
}

std::string headerOf(const std::string& packed, std::size_t plain_size) {
  ByteWriter header;
  header.bytes = kMagic;
  header.value(kFormatVersion);
  header.count(packed.size());
  header.count(plain_size);
  header.value(checksum(packed));
  header.value(checksum(header.bytes));
  return header.bytes;
}

std::string plainOf(const std::vector<Section>& sections) {
  ByteWriter plain;
  for (const auto& section : sections) {
    plain.value(static_cast<std::uint32_t>(section.name.size()));
    plain.bytes += section.name;
    plain.value(section.version);
    plain.text(section.bytes);
  }
  return plain.bytes;
}

std::string contentsOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path)) throw InputError("no such file");
  std::ostringstream contents;
  contents << file.rdbuf();
  return contents.str();
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

void writeCheckedFile(const std::string& path, const std::vector<Section>& sections) {
  std::string plain = plainOf(sections);
  const std::string packed = compressed(plain);
  const std::string partial = path + ".part";
  std::ofstream file(partial, std::ios::binary | std::ios::trunc);
  file << headerOf(packed, plain.size()) << packed;
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(partial, path, error);
  if (!file || error) {
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    throw InputError(path + ": cannot be written (is the disk full, or the folder missing?)");
  }
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
      header.plain_size > kLargestCompression * (header.packed_size + 1) ||
      checksum(packed) != header.packed_checksum) {
    throw InputError("damaged: its checksum does not match");
  }
  const std::string plain = decompressed(packed, header.plain_size);
  std::vector<Section> sections;
  for (ByteReader in(plain); !in.atEnd();) {
    Section section;
    section.name = in.take(in.value<std::uint32_t>());
    section.version = in.value<std::uint32_t>();
    section.bytes = in.text();
    sections.push_back(std::move(section));
  }
  return sections;
}

}  // namespace headway::map
