// SPDX-License-Identifier: BSD-3-Clause
// Records of which the newest are in memory and all others in a temporary file.
#include <fcntl.h>
#include <headway/core/record_log.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>

namespace headway {
namespace {

/// Descriptor of a new file without a name; -1 if there is none.
int openTemporary() {
  // /var/tmp is on a disk, while /tmp is a part of the memory on many small computers.
  const char* folder = std::getenv("TMPDIR");
  std::string path = folder != nullptr && *folder != '\0' ? folder : "/var/tmp";
  path += "/headway-XXXXXX";
  const int file = mkostemp(path.data(), O_CLOEXEC);
  if (file >= 0) unlink(path.c_str());
  return file;
}

/// Calls transfer(done) until `count` bytes are transferred.
template <typename Transfer>
bool transferAll(std::size_t count, const Transfer& transfer) {
  for (std::size_t done = 0; done < count;) {
    const ssize_t bytes = transfer(done);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes <= 0) return false;
    done += static_cast<std::size_t>(bytes);
  }
  return true;
}

}  // namespace

TemporaryFile::~TemporaryFile() {
  if (file_ >= 0) close(file_);
}

bool TemporaryFile::append(const void* bytes, std::size_t count) {
  if (file_ < 0) file_ = openTemporary();
  if (file_ < 0) return false;
  const auto* data = static_cast<const char*>(bytes);
  const bool is_written = transferAll(count, [&](std::size_t done) {
    return pwrite(file_, data + done, count - done, static_cast<off_t>(size_ + done));
  });
  if (is_written) size_ += count;
  return is_written;
}

bool TemporaryFile::read(std::size_t offset, void* bytes, std::size_t count) const {
  if (file_ < 0) return false;
  auto* data = static_cast<char*>(bytes);
  return transferAll(count, [&](std::size_t done) {
    return pread(file_, data + done, count - done, static_cast<off_t>(offset + done));
  });
}

}  // namespace headway
