// SPDX-License-Identifier: BSD-3-Clause
// Files that a program finds, reads, may write, and the folder of its results.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace headway::program {

/// Finds a file or folder that headway brings, such as `config/worlds/street.ini`: relative to the
/// working folder, as in a clone of the repository, else below share/headway of the installation
/// that the running program belongs to.
///
/// @return the path found; `path` itself if there is none, or if it is absolute
[[nodiscard]] std::string findDataFile(const std::string& path);

/// findDataFile() below a given folder instead of the installation's.
[[nodiscard]] std::string findDataFile(const std::string& path, const std::string& installed);

/// Whether a file is a picture numbered by six or more digits: 000123.png.
[[nodiscard]] bool isNumberedPicture(const std::filesystem::path& file);

/// Whether a file in the folder of a run is one of its results, by its path in the folder. Old
/// results are removed when new ones replace them; other files are not touched.
[[nodiscard]] bool isResult(const std::filesystem::path& file);

/// registerInput() for what headway reads, by name, in a folder of results or truth. A folder that
/// is read may receive other files, pages and pictures.
void registerInputsIn(const std::filesystem::path& folder);

/// registerInput() for all files below the folder of a dataset but rawlogs, which imports write.
void registerDataset(const std::filesystem::path& folder);

/// @throws InputError if the file cannot be read
[[nodiscard]] std::string readFile(const std::filesystem::path& path);

/// @param inputs  files that are read, none of which is overwritten; empty names are ignored
/// @throws InputError if the path exists and may not be overwritten, or is an input
void requireWritable(const std::string& path, bool overwrite,
                     const std::vector<std::string>& inputs = {});

/// The folder of a run's results, which one process at a time may write.
///
/// A new or empty folder is written in place. In a folder with contents, which requires
/// `overwrite`, the new results are written to `unfinished/`, and publish() replaces the old ones
/// by them. The old results remain until then, and files that are no results always remain.
///
///     OutputFolder folder("out", true, {"in.rawlog"}, isResult);
///     writeTum(folder.path() / "trajectory.tum", poses);
///     folder.publish();
class OutputFolder {
 public:
  /// Whether a file is a result, by its path in the folder.
  using IsResult = std::function<bool(const std::filesystem::path&)>;

  /// Creates the folder if necessary and locks it.
  ///
  /// @param inputs  files that are read, none of which may be a result; empty names are ignored
  /// @throws InputError if the folder may not be overwritten, cannot be written, is used by another
  ///         process, or contains an input as result
  OutputFolder(std::filesystem::path folder, bool overwrite, const std::vector<std::string>& inputs,
               IsResult is_result);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until publish().
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Where the results are after publish().
  [[nodiscard]] const std::filesystem::path& published() const { return folder_; }
  /// Whether old results remain until publish().
  [[nodiscard]] bool hasOldResults() const { return path_ != folder_; }

  /// Replaces the old results. @throws InputError if that fails
  void publish();

 private:
  void lock();

  std::filesystem::path folder_;
  std::filesystem::path path_;
  IsResult is_result_;
  int lock_ = -1;  ///< descriptor
};

}  // namespace headway::program
