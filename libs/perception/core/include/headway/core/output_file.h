// SPDX-License-Identifier: BSD-3-Clause
// Files that appear whole or not at all, growing files, and replacing a folder of results.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <ostream>
#include <sstream>
#include <string_view>

namespace headway {

/// A file that appears whole or not at all.
///
/// It is written under a temporary name in the same folder, private until commit() synchronises it
/// with the disk, gives it the permissions of new files (umask) and renames it over an older file.
/// Without commit() nothing of it remains. A device or pipe is written directly.
///
///     OutputFile file("trajectory.tum");
///     for (const auto& pose : path) writeTumRow(file.stream(), pose);
///     file.commit();
class OutputFile {
 public:
  /// @throws InputError if the file cannot be written
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// For writers that open files by name, instead of stream(). It ends like the file's name.
  [[nodiscard]] const std::filesystem::path& temporaryPath() const { return temporary_; }
  /// @throws InputError if a write to the stream failed so far
  void check() const;
  /// Ends the file. @throws InputError if it could not be written to the end
  void commit();

 private:
  [[nodiscard]] bool isDirect() const { return temporary_ == path_; }

  std::filesystem::path path_;
  std::filesystem::path temporary_;  ///< path_ for devices and pipes
  std::ofstream stream_;
  bool is_committed_ = false;
};

/// Writes a whole file from bytes. @throws InputError if that fails
void writeFile(const std::filesystem::path& path, std::string_view bytes);

/// Waits until a file's contents are on the disk; file systems that cannot tell are left out.
///
/// @throws InputError if that fails
void synchroniseFile(const std::filesystem::path& path);

/// A file of rows that grows while a program runs. After a kill it has all rows that were ended and
/// ends with a whole row, unless the kill fell into the microseconds in which the system appends a
/// row to two pages of the file.
///
///     GrowingFile file("tracks.csv");
///     file.stream() << "1,2\n";
///     file.endRows();
class GrowingFile {
 public:
  /// Creates the file, or empties it. @throws InputError if it cannot be written
  explicit GrowingFile(const std::filesystem::path& path);
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  [[nodiscard]] std::ostream& stream() { return rows_; }
  /// Call after whole rows: hands them to the system. @throws InputError if the file cannot be
  /// written
  void endRows();
  /// Ends the file and synchronises it with the disk. @throws InputError as endRows()
  void close();

 private:
  void write(std::string_view rows);

  std::filesystem::path path_;
  int file_;  ///< descriptor; -1 when closed
  std::ostringstream rows_;
};

/// Folder of a run's new results, in the folder of the old ones, while they replace these. After a
/// kill meanwhile it remains, and the folder that it is in contains results of both runs.
inline constexpr char kReplacingFolder[] = "complete";

/// Moves all files of a folder, with those in its folders, to another folder of the same file
/// system and removes the first one. They replace files of the same names, after they have been
/// synchronised with the disk.
///
/// @param to        created if necessary
/// @param is_stale  which other files of `to` are removed, by their path in `to`
/// @throws InputError if a file cannot be moved; those moved before remain moved
void replaceFiles(const std::filesystem::path& from, const std::filesystem::path& to,
                  const std::function<bool(const std::filesystem::path&)>& is_stale);

}  // namespace headway
