// SPDX-License-Identifier: BSD-3-Clause
// Files that appear whole or not at all, growing files, and replacing a folder of results.
#include <fcntl.h>
#include <headway/core/error.h>
#include <headway/core/input_files.h>
#include <headway/core/output_file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace headway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPageBytes = 4096;

[[noreturn]] void failToWrite(const fs::path& path, int error) {
  throw InputError(path.string() + ": cannot be written: " + std::strerror(error));
}

/// The file that a path leads to: a symbolic link is kept, and its target is replaced.
fs::path targetOf(const fs::path& path) {
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::canonical(path, error) : path;
  return error ? path : target;
}

bool isDevice(const fs::path& path) {
  std::error_code ignored;
  const auto type = fs::status(path, ignored).type();
  return type == fs::file_type::character || type == fs::file_type::fifo ||
         type == fs::file_type::block || type == fs::file_type::socket;
}

/// Creates the file of another name in which a file is written: new, no link, and private. The
/// name cannot be guessed, so that no other program can create it first.
fs::path createTemporary(const fs::path& path) {
  const std::string ending = "-" + path.filename().string();
  const std::string start = ".partial-" + std::to_string(getpid()) + "-XXXXXX";
  std::string name = (path.parent_path() / (start + ending)).string();
  const int file = mkostemps(name.data(), static_cast<int>(ending.size()), O_CLOEXEC);
  if (file < 0) failToWrite(path, errno);
  ::close(file);
  return name;
}

/// Permissions of new files (umask), read without changing them for other threads meanwhile;
/// private ones where the system does not tell.
mode_t modeOfNewFiles() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    unsigned int mask = 0;
    if (std::sscanf(line.c_str(), "Umask: %o", &mask) == 1) return 0666 & ~mask;
  }
  return 0600;
}

/// Length of the first rows that are written at once. A kill splits a write() between two pages of
/// the file, so that the pieces are not longer than a page.
std::size_t pieceLength(std::string_view rows) {
  const auto end = rows.substr(0, kPageBytes).rfind('\n');
  if (end != std::string_view::npos) return end + 1;
  const auto end_of_long_row = rows.find('\n');
  return end_of_long_row == std::string_view::npos ? rows.size() : end_of_long_row + 1;
}

/// Synchronises a file or folder with the disk; file systems that cannot are left out.
///
/// @param mode  permissions that it gets; nullopt: those it has
void synchronise(const fs::path& path, int flags, std::optional<mode_t> mode = std::nullopt) {
  const int file = open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0) failToWrite(path, errno);
  int error = mode && fchmod(file, *mode) != 0 ? errno : 0;
  if (error == EPERM || error == ENOTSUP) error = 0;  // a file system without permissions
  if (error == 0 && fsync(file) != 0) error = errno;
  ::close(file);
  if (error != 0 && error != EINVAL && error != EROFS) failToWrite(path, error);
}

}  // namespace

void synchroniseFile(const fs::path& path) { synchronise(path, O_RDONLY); }

OutputFile::OutputFile(const fs::path& path) : path_(targetOf(path)) {
  requireNoInput(path_);
  if (fs::is_directory(path_)) throw InputError(path_.string() + ": is a folder, not a file");
  temporary_ = isDevice(path_) ? path_ : createTemporary(path_);
  stream_.open(temporary_, std::ios::binary);
  if (stream_) return;
  const int error = errno;
  if (!isDirect()) (void)unlink(temporary_.c_str());
  failToWrite(path_, error);
}

OutputFile::~OutputFile() {
  if (!is_committed_ && !isDirect()) (void)unlink(temporary_.c_str());
}

void OutputFile::check() const {
  if (!stream_) throw InputError(path_.string() + ": not written completely; check the disk space");
}

void OutputFile::commit() {
  stream_.close();
  check();
  if (!isDirect()) {
    synchronise(temporary_, O_RDONLY | O_NOFOLLOW, modeOfNewFiles());
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) failToWrite(path_, errno);
    const fs::path folder = path_.parent_path();
    synchronise(folder.empty() ? fs::path(".") : folder, O_RDONLY | O_DIRECTORY);
  }
  is_committed_ = true;
}

void writeFile(const fs::path& path, std::string_view bytes) {
  OutputFile file(path);
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.commit();
}

GrowingFile::GrowingFile(const fs::path& path) : path_(path), file_(-1) {
  requireNoInput(path);
  file_ = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_CREAT | O_TRUNC, 0666);
  if (file_ < 0) failToWrite(path_, errno);
}

GrowingFile::~GrowingFile() {
  if (file_ < 0) return;
  try {
    endRows();
  } catch (const std::exception&) {  // errors are reported by endRows() and close()
  }
  if (file_ >= 0) ::close(file_);
}

void GrowingFile::endRows() {
  const std::string rows = rows_.str();
  rows_.str("");
  for (std::string_view left = rows; !left.empty();) {
    const std::string_view piece = left.substr(0, pieceLength(left));
    write(piece);
    left.remove_prefix(piece.size());
  }
}

/// Writes whole rows. A full disk takes a part of them, which is cut after its last whole row.
void GrowingFile::write(std::string_view rows) {
  if (file_ < 0) failToWrite(path_, EBADF);
  ssize_t written = 0;
  do written = ::write(file_, rows.data(), rows.size());
  while (written < 0 && errno == EINTR);
  if (written == static_cast<ssize_t>(rows.size())) return;
  const int error = written < 0 ? errno : ENOSPC;
  if (written > 0) {
    const auto whole = rows.rfind('\n', static_cast<std::size_t>(written) - 1);
    const off_t excess =
        written - (whole == std::string_view::npos ? 0 : static_cast<off_t>(whole) + 1);
    if (ftruncate(file_, lseek(file_, 0, SEEK_END) - excess) != 0) failToWrite(path_, errno);
  }
  failToWrite(path_, error);
}

void GrowingFile::close() {
  endRows();
  const int file = std::exchange(file_, -1);
  if (file < 0) return;
  const int error = fsync(file) == 0 ? 0 : errno;
  const bool is_closed = ::close(file) == 0;
  if (error != 0 && error != EINVAL && error != EROFS) failToWrite(path_, error);
  if (!is_closed) failToWrite(path_, errno);
}

namespace {

std::set<std::filesystem::path> filesIn(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_directory() || entry.is_symlink()) {
      files.insert(entry.path().lexically_relative(folder));
    }
  }
  return files;
}

/// Synchronises the file system of a folder with the disk.
void synchroniseAll(const std::filesystem::path& folder) {
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  (void)syncfs(file);
  close(file);
}

}  // namespace

void replaceFiles(const std::filesystem::path& from, const std::filesystem::path& to,
                  const std::function<bool(const std::filesystem::path&)>& is_stale) {
  try {
    synchroniseAll(from);
    std::filesystem::create_directories(to);
    const auto files = filesIn(from);
    for (const auto& file : files) requireNoInput(to / file);
    std::vector<std::filesystem::path> stale;
    // `from` may be a folder of `to`.
    for (const auto& file : filesIn(to)) {
      const bool is_new =
          files.count(file) > 0 || files.count((to / file).lexically_relative(from)) > 0;
      if (!is_new && is_stale(file)) stale.push_back(to / file);
    }
    for (const auto& file : stale) requireNoInput(file);
    for (const auto& file : stale) std::filesystem::remove(file);
    for (const auto& file : files) {
      std::filesystem::create_directories((to / file).parent_path());
      std::filesystem::rename(from / file, to / file);
    }
    std::filesystem::remove_all(from);
    synchroniseAll(to);
  } catch (const std::filesystem::filesystem_error& error) {
    throw InputError(to.string() + ": files cannot be replaced: " + error.code().message());
  }
}

}  // namespace headway
