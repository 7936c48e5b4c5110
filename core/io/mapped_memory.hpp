// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory_resource>
#include <mutex>
#include <utility>
#include <vector>

namespace emberfold::io {

/// Allocates memory in a file that is mapped into the address space, in whole pages: for data that is large,
/// long-lived and seldom accessed. The system writes it to the disk where memory is scarce. The file has no
/// name and vanishes with this object, however the program ends. Freed memory is used again. Thread-safe.
/// Allocation throws core::IoError where the disk is full. O(free runs of pages).
class MappedMemory : public std::pmr::memory_resource {
 public:
  /// Puts the file into `folder` once it is needed.
  explicit MappedMemory(std::filesystem::path folder);
  ~MappedMemory() override;
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;

  /// Returns the size of the file, and how much of it is allocated.
  [[nodiscard]] std::size_t mapped_bytes() const;
  [[nodiscard]] std::size_t used_bytes() const;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }
  void map(std::size_t bytes);
  void add_free(std::byte* begin, std::size_t bytes);
  [[nodiscard]] std::size_t whole_pages(std::size_t bytes) const;

  std::filesystem::path folder_;
  std::size_t page_ = 4096, end_ = 0, used_ = 0;
  int file_ = -1;
  mutable std::mutex access_;
  std::map<std::byte*, std::size_t> free_;  // runs of pages, no two adjacent
  std::vector<std::pair<void*, std::size_t>> maps_;
};

}  // namespace emberfold::io
