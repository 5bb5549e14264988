#include "output_folder.h"

#include <headway/core/error.h>

#include <cerrno>
#include <cstring>

namespace headway::replay {
namespace {

namespace fs = std::filesystem;

void removeOldSnapshots(const fs::path& folder) {
  const fs::path snapshots = folder / "snapshots";
  if (!fs::is_directory(snapshots)) return;
  for (const auto& entry : fs::directory_iterator(snapshots)) {
    const auto name = entry.path().stem().string();
    const bool is_number = name.size() == 6 && name.find_first_not_of("0123456789") == name.npos;
    if (is_number && entry.path().extension() == ".png") fs::remove(entry.path());
  }
}

}  // namespace

OutputFile::OutputFile(fs::path path) : path_(std::move(path)), stream_(path_) {
  if (!stream_) {
    throw InputError(path_.string() + ": cannot be written: " + std::strerror(errno));
  }
}

void OutputFile::check() const {
  if (!stream_) throw InputError(path_.string() + ": writing failed; is the disk full?");
}

void OutputFile::flush() {
  stream_.flush();
  check();
}

fs::path prepareOutputFolder(const fs::path& folder, bool overwrite) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw InputError(folder.string() + ": this folder cannot be made: " +
                     (error ? error.message() : "a file stands in its place"));
  }
  if (!overwrite && !fs::is_empty(folder)) {
    throw InputError(folder.string() + ": holds files already; -w overwrites a replay's results");
  }
  removeOldSnapshots(folder);
  OutputFile probe(folder / "replay.json");
  return folder;
}

}  // namespace headway::replay
