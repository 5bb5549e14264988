#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace headway::replay {

/// A text file that reports what it could not write instead of losing it.
class OutputFile {
 public:
  /// @throws InputError if the file cannot be opened
  explicit OutputFile(std::filesystem::path path);

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// @throws InputError if something could not be written so far
  void check() const;
  /// Brings what was written so far to disk. @throws InputError if that fails
  void flush();

 private:
  std::filesystem::path path_;
  std::ofstream stream_;
};

/// Makes the folder of a replay's results ready.
///
/// An empty or new folder is taken as it is. One with files in it needs `overwrite`; then the
/// pictures of an earlier replay are removed, and nothing else.
///
/// @return  the folder
/// @throws  InputError if it may not or cannot be written
[[nodiscard]] std::filesystem::path prepareOutputFolder(const std::filesystem::path& folder,
                                                        bool overwrite);

}  // namespace headway::replay
