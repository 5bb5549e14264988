// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway_test/paths.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace headway::test {

/// A folder in memory with valid files, of which each input replaces one. The valid contents are
/// the target's seeds: a byte that selects the file, and its content. A seed's name is the file's,
/// with commas for slashes.
class FileTree {
 public:
  explicit FileTree(const std::string& target)
      : seeds_(std::string(HEADWAY_SOURCE_DIR) + "/tests/fuzz/corpus/" + target + "/"),
        root_("/dev/shm/headway-fuzz-" + std::to_string(getpid())) {
    std::filesystem::remove_all(root_);
  }
  FileTree(FileTree&& other) noexcept
      : seeds_(std::move(other.seeds_)),
        root_(std::exchange(other.root_, {})),
        names_(std::move(other.names_)),
        contents_(std::move(other.contents_)) {}
  FileTree& operator=(FileTree&&) = delete;
  ~FileTree() {
    std::error_code ignored;
    if (!root_.empty()) std::filesystem::remove_all(root_, ignored);
  }

  /// The valid content of a file.
  [[nodiscard]] std::string seed(std::string name) const {
    for (char& c : name) c = c == '/' ? ',' : c;
    std::ifstream file(seeds_ + name, std::ios::binary);
    std::string content(std::istreambuf_iterator<char>(file), {});
    if (content.empty()) throw std::runtime_error(seeds_ + name + ": is missing");
    return content.substr(1);
  }

  /// Adds a file that inputs may replace.
  void addSeed(const std::string& name) {
    names_.push_back(name);
    contents_.push_back(seed(name));
    add(name, contents_.back());
  }

  /// Adds a file that is never replaced.
  void add(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    write(name, content.data(), content.size());
  }

  /// A file that contains an input until the end of this object's life.
  class Replaced {
   public:
    Replaced(const FileTree& tree, std::size_t index) : tree_(tree), index_(index) {}
    ~Replaced() {
      tree_.write(name(), tree_.contents_[index_].data(), tree_.contents_[index_].size());
    }
    Replaced(const Replaced&) = delete;
    Replaced& operator=(const Replaced&) = delete;
    [[nodiscard]] const std::string& name() const { return tree_.names_[index_]; }

   private:
    const FileTree& tree_;
    std::size_t index_;
  };
  [[nodiscard]] Replaced replace(std::uint8_t selected, const std::uint8_t* data,
                                 std::size_t size) const {
    const std::size_t index = selected % names_.size();
    write(names_[index], reinterpret_cast<const char*>(data), size);
    return {*this, index};
  }

  [[nodiscard]] const std::filesystem::path& path() const { return root_; }

 private:
  void write(const std::string& name, const char* data, std::size_t size) const {
    std::ofstream file(root_ / name, std::ios::binary);
    file.write(data, static_cast<std::streamsize>(size));
    if (!file) throw std::runtime_error((root_ / name).string() + ": cannot be written");
  }

  std::string seeds_;
  std::filesystem::path root_;
  std::vector<std::string> names_;
  std::vector<std::string> contents_;
};

}  // namespace headway::test
