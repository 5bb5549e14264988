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
  if (!stream_) throw InputError(path_.string() + ": write error; check the disk space");
}

void OutputFile::flush() {
  stream_.flush();
  check();
}

fs::path prepareOutputFolder(const fs::path& folder, bool overwrite) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder)) {
    throw InputError(folder.string() + ": the folder cannot be created: " +
                     (error ? error.message() : "a file of that name exists"));
  }
  if (!overwrite && !fs::is_empty(folder)) {
    throw InputError(folder.string() +
                     ": is not empty; use -w to overwrite the results of a replay");
  }
  removeOldSnapshots(folder);
  OutputFile probe(folder / "replay.json");
  return folder;
}

}  // namespace headway::replay
