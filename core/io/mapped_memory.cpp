// SPDX-License-Identifier: Apache-2.0
#include "core/io/mapped_memory.hpp"

#include <algorithm>
#include <cerrno>
#include <iterator>
#include <limits>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "core/error.hpp"

namespace emberfold::io {

namespace {

// The file grows by its own size, within these bounds: small runs take little of the disk.
constexpr std::size_t kLeastGrowth = std::size_t{1} << 20, kMostGrowth = std::size_t{64} << 20;

}  // namespace

MappedMemory::MappedMemory(std::filesystem::path folder)
    : folder_(std::move(folder)), page_(static_cast<std::size_t>(::sysconf(_SC_PAGESIZE))) {
  if (folder_.empty()) folder_ = ".";
}

MappedMemory::~MappedMemory() {
  for (const auto& [address, bytes] : maps_) ::munmap(address, bytes);
  if (file_ >= 0) ::close(file_);
}

std::size_t MappedMemory::mapped_bytes() const {
  const std::scoped_lock lock(access_);
  return end_;
}

std::size_t MappedMemory::used_bytes() const {
  const std::scoped_lock lock(access_);
  return used_;
}

std::size_t MappedMemory::whole_pages(std::size_t bytes) const {
  if (bytes > std::numeric_limits<std::size_t>::max() / 2) throw std::bad_alloc();
  return std::max<std::size_t>(1, (bytes + page_ - 1) / page_) * page_;
}

void* MappedMemory::do_allocate(std::size_t bytes, std::size_t alignment) {
  const std::size_t length = whole_pages(bytes);
  if (alignment > page_) throw std::bad_alloc();
  const std::scoped_lock lock(access_);
  const auto fits = [&](const auto& run) { return run.second >= length; };
  auto found = std::ranges::find_if(free_, fits);
  if (found == free_.end()) {
    map(length);
    found = std::ranges::find_if(free_, fits);
  }
  const auto [begin, size] = *found;
  free_.erase(found);
  if (size > length) free_.emplace(begin + length, size - length);
  used_ += length;
  return begin;
}

void MappedMemory::do_deallocate(void* block, std::size_t bytes, std::size_t /*alignment*/) {
  const std::scoped_lock lock(access_);
  const std::size_t length = whole_pages(bytes);
  used_ -= length;
  add_free(static_cast<std::byte*>(block), length);
}

void MappedMemory::add_free(std::byte* begin, std::size_t bytes) {
  auto next = free_.lower_bound(begin);
  if (next != free_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second == begin) {
      begin = before->first, bytes += before->second;
      free_.erase(before);
    }
  }
  if (next != free_.end() && begin + bytes == next->first) {
    bytes += next->second;
    free_.erase(next);
  }
  free_.emplace(begin, bytes);
}

void MappedMemory::map(std::size_t bytes) {
  const auto fail = [&](int reason) {
    throw core::IoError("cannot keep what is large in a file in " + folder_.string() + ": " +
                        std::generic_category().message(reason));
  };
  if (file_ < 0) {
    std::string name = (folder_ / ".emberfold-cache-XXXXXX").string();
    file_ = ::mkstemp(name.data());
    if (file_ < 0) fail(errno);
    ::unlink(name.c_str());
  }
  const std::size_t length = std::max(bytes, std::clamp(end_, kLeastGrowth, kMostGrowth));
  // Space is reserved now: a page that finds none later would end the program.
  const int reason = ::posix_fallocate(file_, static_cast<off_t>(end_), static_cast<off_t>(length));
  if (reason != 0) fail(reason);
  void* const address =
      ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file_, static_cast<off_t>(end_));
  if (address == MAP_FAILED) fail(errno);
  maps_.emplace_back(address, length);
  end_ += length;
  add_free(static_cast<std::byte*>(address), length);
}

}  // namespace emberfold::io
