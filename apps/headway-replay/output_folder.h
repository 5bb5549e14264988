#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace headway::replay {

/// A text file that reports write errors.
class OutputFile {
 public:
  /// @throws InputError if the file cannot be opened
  explicit OutputFile(std::filesystem::path path);

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// @throws InputError if a write failed so far
  void check() const;
  /// Flushes the file. @throws InputError if that fails
  void flush();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

/// Prepares the output folder of a replay.
///
/// Creates the folder if necessary. A folder that is not empty requires `overwrite`; the snapshots
/// of an earlier replay are then removed, and no other files.
///
/// @return  the folder
/// @throws  InputError if the folder may not be overwritten or cannot be written
[[nodiscard]] std::filesystem::path prepareOutputFolder(const std::filesystem::path& folder,
                                                        bool overwrite);

}  // namespace headway::replay
