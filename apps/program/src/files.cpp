// SPDX-License-Identifier: BSD-3-Clause
// Files that a program finds, reads, may write, and the folder of its results.
#include <fcntl.h>
#include <headway/core/error.h>
#include <headway/core/input_files.h>
#include <headway/core/output_file.h>
#include <headway/program/files.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

namespace headway::program {

namespace {

namespace fs = std::filesystem;

constexpr char kLock[] = ".lock";
constexpr char kUnfinished[] = "unfinished";

/// What programs read again in a folder of results.
const std::set<std::string>& readResults() {
  static const std::set<std::string> names = {
      "calibration.yaml",     "detections.csv",      "map.headway",
      "map_dense.ply",        "map_geo.json",        "map.simplemap",
      "map_grid.png",         "map_grid.yaml",       "map_odom.csv",
      "map_points.ply",       "map_grid.gridmap.gz", "predictions.csv",
      "recordings.json",      "replay.json",         "summary.json",
      "tracks.csv",           "tracks_odom.csv",     "tracks_smoothed.csv",
      "trajectory.tum",       "trajectory_odom.tum", "trajectory_covariance.csv",
      "trajectory_online.tum"};
  return names;
}

/// Name of the same file of the first submap.
std::string firstNameOf(const fs::path& file) {
  static const std::regex submap("(map_.*)_submap_[0-9]+(\\..*)");
  return std::regex_replace(file.string(), submap, "$1$2");
}

void requireOtherInputs(const fs::path& folder, const OutputFolder::IsResult& is_result) {
  for (const auto& input : registeredInputs()) {
    const fs::path place =
        fs::weakly_canonical(input).lexically_relative(fs::weakly_canonical(folder));
    const bool is_inside = !place.empty() && *place.begin() != "..";
    if (is_inside && is_result(place)) {
      throw InputError(input.string() + ": is an input and would be replaced by a result in " +
                       folder.string() + "; choose another folder or copy the input");
    }
  }
}

/// Whether a file does not make a folder one with contents: a lock, what a program is writing, or
/// an input beside which results are wanted.
bool isNoContent(const fs::path& file) {
  const std::string name = file.filename().string();
  if (name == kLock || name.rfind(".partial-", 0) == 0) return true;
  const auto inputs = registeredInputs();
  return std::any_of(inputs.begin(), inputs.end(), [&](const fs::path& input) {
    std::error_code ignored;
    return fs::equivalent(file, input, ignored);
  });
}

bool isSameFile(int file, const fs::path& path) {
  struct stat opened {
  }, named{};
  return fstat(file, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// A folder, and no link to one elsewhere.
bool isRealFolder(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() == fs::file_type::directory;
}

std::string textIn(int file) {
  std::array<char, 32> text{};
  const auto length = pread(file, text.data(), text.size() - 1, 0);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : "";
}

}  // namespace

std::string findDataFile(const std::string& path) {
  std::error_code unknown;
  const auto program = fs::read_symlink("/proc/self/exe", unknown);
  return findDataFile(path, program.parent_path().parent_path() / "share/headway");
}

std::string findDataFile(const std::string& path, const std::string& installed) {
  std::error_code ignored;
  if (path.empty() || fs::path(path).is_absolute() || fs::exists(path, ignored)) return path;
  const auto file = fs::path(installed) / path;
  return fs::exists(file, ignored) ? file.string() : path;
}

bool isNumberedPicture(const fs::path& file) {
  const std::string name = file.stem().string();
  return file.extension() == ".png" && name.size() >= 6 &&
         name.find_first_not_of("0123456789") == std::string::npos;
}

bool isResult(const fs::path& file) {
  if (file.parent_path() == "snapshots") return isNumberedPicture(file);
  static const std::set<std::string> shown = {
      "lost.jpg",       "replay.html",      "report.html",        "scene.3Dscene",
      "tracks.geojson", "tracks_kitti.txt", "trajectory.geojson", "trajectory_kitti.txt"};
  const std::string name = firstNameOf(file);
  return readResults().count(name) > 0 || shown.count(name) > 0;
}

void registerInputsIn(const fs::path& folder) {
  static const std::set<std::string> truth = {"calib.txt",   "drops.csv",       "label_02.txt",
                                              "objects.csv", "poses_kitti.txt", "world.ini"};
  std::error_code unreadable;
  for (const auto& entry : fs::directory_iterator(folder, unreadable)) {
    const fs::path name = entry.path().filename();
    const bool is_read = readResults().count(firstNameOf(name)) > 0 || truth.count(name) > 0;
    if (is_read) registerInput(entry.path());
  }
}

void registerDataset(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code unreadable;
  const auto options = fs::directory_options::skip_permission_denied;
  for (fs::recursive_directory_iterator entry(folder, options, unreadable), end;
       !unreadable && entry != end; entry.increment(unreadable)) {
    const fs::path name = entry->path().filename();
    const bool is_rawlog =
        name.extension() == ".rawlog" || fs::path(name.stem()).extension() == ".rawlog";
    if (!is_rawlog) registerInput(entry->path());
  }
}

std::string readFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file) throw InputError(path.string() + ": cannot be read");
  return bytes.str();
}

void requireWritable(const std::string& path, bool overwrite,
                     const std::vector<std::string>& inputs) {
  for (const auto& input : inputs) registerInput(input);
  requireNoInput(path);
  if (!overwrite && fs::exists(path)) {
    throw InputError(path + ": exists already; -w overwrites it");
  }
}

OutputFolder::OutputFolder(fs::path folder, bool overwrite, const std::vector<std::string>& inputs,
                           IsResult is_result)
    : folder_(std::move(folder)), path_(folder_), is_result_(std::move(is_result)) {
  for (const auto& input : inputs) registerInput(input);
  requireOtherInputs(folder_, is_result_);
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_)) {
    throw InputError(folder_.string() + ": the folder cannot be created: " +
                     (error ? error.message() : "a file of that name exists"));
  }
  const bool is_empty = std::all_of(fs::directory_iterator(folder_), fs::directory_iterator(),
                                    [](const auto& entry) { return isNoContent(entry.path()); });
  if (!is_empty && !overwrite) {
    throw InputError(folder_.string() +
                     ": exists already and is not empty; -w overwrites the results in it");
  }
  lock();
  if (is_empty) return;
  if (isRealFolder(folder_ / kReplacingFolder)) {
    replaceFiles(folder_ / kReplacingFolder, folder_, is_result_);
  }
  path_ = folder_ / kUnfinished;
  fs::remove_all(path_, error);
  fs::create_directory(path_, error);
  if (error) throw InputError(path_.string() + ": cannot be made: " + error.message());
}

OutputFolder::~OutputFolder() {
  (void)unlink((folder_ / kLock).c_str());
  close(lock_);
}

/// The system ends the lock with the process, so that the file of a killed process does not count.
void OutputFolder::lock() {
  const fs::path path = folder_ / kLock;
  while (true) {
    lock_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (lock_ < 0) throw InputError(path.string() + ": cannot be written: " + std::strerror(errno));
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
      const std::string owner = textIn(lock_);
      close(lock_);
      throw InputError(folder_.string() + ": process " + owner +
                       " is writing its results there; wait for its end or choose another folder");
    }
    if (isSameFile(lock_, path)) break;
    close(lock_);  // its owner has ended, and removed it, meanwhile
  }
  const std::string owner = std::to_string(getpid());
  const bool is_written =
      ftruncate(lock_, 0) == 0 && pwrite(lock_, owner.data(), owner.size(), 0) > 0;
  if (is_written) return;
  const int error = errno;
  (void)unlink(path.c_str());
  close(lock_);
  throw InputError(path.string() + ": cannot be written: " + std::strerror(error));
}

void OutputFolder::publish() {
  if (!hasOldResults()) return;
  const fs::path complete = folder_ / kReplacingFolder;
  std::error_code error;
  fs::rename(path_, complete, error);
  if (error) throw InputError(complete.string() + ": cannot be made: " + error.message());
  replaceFiles(complete, folder_, is_result_);
  path_ = folder_;
}

}  // namespace headway::program
