// SPDX-License-Identifier: BSD-3-Clause
// Long sequences whose copies share what has not changed.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace headway {

/// A sequence in chunks that its copies share.
///
/// A copy costs a pointer for each chunk. Elements are never modified; who publishes a large
/// sequence again and again makes only those chunks anew whose elements changed.
template <typename T>
class SharedChunks {
 public:
  using Chunk = std::vector<T>;
  using value_type = T;
  /// Iterates over the elements of all chunks.
  class const_iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = const T&;

    const_iterator() = default;
    const_iterator(const SharedChunks* of, std::size_t chunk) : of_(of), chunk_(chunk) {}
    reference operator*() const { return (*of_->chunks_[chunk_])[at_]; }
    pointer operator->() const { return &**this; }
    const_iterator& operator++() {
      if (++at_ == of_->chunks_[chunk_]->size()) {
        ++chunk_;
        at_ = 0;
      }
      return *this;
    }
    const_iterator operator++(int) { return std::exchange(*this, std::next(*this)); }
    bool operator==(const const_iterator& other) const {
      return chunk_ == other.chunk_ && at_ == other.at_;
    }
    bool operator!=(const const_iterator& other) const { return !(*this == other); }

   private:
    const SharedChunks* of_ = nullptr;
    std::size_t chunk_ = 0;
    std::size_t at_ = 0;
  };

  SharedChunks() = default;
  SharedChunks(Chunk elements) { append(std::make_shared<const Chunk>(std::move(elements))); }
  SharedChunks(std::initializer_list<T> elements) : SharedChunks(Chunk(elements)) {}

  /// Appends a chunk; an empty one is left out. Must not be null.
  void append(std::shared_ptr<const Chunk> chunk) {
    if (chunk->empty()) return;
    size_ += chunk->size();
    chunks_.push_back(std::move(chunk));
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const_iterator begin() const { return {this, 0}; }
  [[nodiscard]] const_iterator end() const { return {this, chunks_.size()}; }
  [[nodiscard]] const T& front() const { return chunks_.front()->front(); }
  [[nodiscard]] const T& back() const { return chunks_.back()->back(); }
  /// Element `i` < size(). Takes a step for each chunk before it.
  [[nodiscard]] const T& operator[](std::size_t i) const {
    auto chunk = chunks_.begin();
    for (; i >= (*chunk)->size(); ++chunk) i -= (*chunk)->size();
    return (**chunk)[i];
  }
  [[nodiscard]] const std::vector<std::shared_ptr<const Chunk>>& chunks() const { return chunks_; }

 private:
  std::vector<std::shared_ptr<const Chunk>> chunks_;  ///< none is empty
  std::size_t size_ = 0;
};

}  // namespace headway
