// SPDX-License-Identifier: Apache-2.0
#include "apps/distributed/stripe_files.hpp"

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.hpp"
#include "core/io/files.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {

constexpr const char* kKey = "key";
constexpr std::string_view kHead = "emberfold.learning 1 ";

[[noreturn]] void fail(const char* what, const fs::path& path, int reason) {
  throw core::IoError(std::string("cannot ") + what + " " + path.string() + ": " +
                      std::generic_category().message(reason));
}

/// Writes all bytes at an offset.
void write_at(int file, std::size_t offset, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("write", path, written == 0 ? ENOSPC : errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::size_t>(written);
  }
}

std::string first_line(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string line;
  std::getline(in, line);
  return line;
}

}  // namespace

StripeFiles::~StripeFiles() {
  for (const auto& [stripe, open] : open_) {
    if (open.map != nullptr) ::munmap(open.map, open.size);
    if (open.file >= 0) ::close(open.file);
  }
}

fs::path StripeFiles::path_of(std::size_t stripe) const {
  return folder_ / ("stripe-" + std::to_string(stripe));
}

StripeFiles::Open& StripeFiles::opened(std::size_t stripe) {
  Open& open = open_[stripe];
  if (open.file >= 0) return open;
  open.file = ::open(path_of(stripe).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (open.file < 0) fail("write", path_of(stripe), errno);
  return open;
}

void StripeFiles::put(std::size_t stripe, std::size_t offset, std::span<const std::byte> values) {
  write_at(opened(stripe).file, offset, values, path_of(stripe));
}

std::span<const std::byte> StripeFiles::values(std::size_t stripe, std::size_t size) {
  Open& open = opened(stripe);
  if (size == 0) return {};
  if (open.size != size) {
    struct stat about {};
    if (::fstat(open.file, &about) != 0) fail("read", path_of(stripe), errno);
    if (static_cast<std::size_t>(about.st_size) < size)
      throw core::IoError("what an earlier run kept is damaged (" + path_of(stripe).string() +
                          "): remove its folder");
    if (open.map != nullptr) ::munmap(std::exchange(open.map, nullptr), open.size);
    void* const map = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, open.file, 0);
    if (map == MAP_FAILED) fail("read", path_of(stripe), errno);
    open.map = map, open.size = size;
  }
  return {static_cast<const std::byte*>(open.map), size};
}

void StripeFiles::flush() {
  for (const auto& [stripe, open] : open_)
    if (::fdatasync(open.file) != 0) fail("write", path_of(stripe), errno);
}

void StripeFiles::save(const std::string& name, std::span<const std::byte> bytes) {
  const fs::path path = folder_ / name, part = folder_ / (name + ".part");
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail("write", path, errno);
  try {
    write_at(file, 0, bytes, path);
    if (::fdatasync(file) != 0) fail("write", path, errno);
  } catch (...) {
    ::close(file);
    ::unlink(part.c_str());
    throw;
  }
  ::close(file);
  if (::rename(part.c_str(), path.c_str()) != 0) fail("write", path, errno);
}

std::optional<std::vector<std::byte>> StripeFiles::load(const std::string& name) {
  const fs::path path = folder_ / name;
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (error) return std::nullopt;
  std::vector<std::byte> bytes(size);
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) throw core::IoError("cannot read " + path.string());
  return bytes;
}

void StripeFiles::remove(const std::string& name) {
  std::error_code ignored;
  fs::remove(folder_ / name, ignored);
}

bool begin_kept_work(const fs::path& folder, const std::string& key) {
  const std::string text = std::string(kHead) + key;
  std::error_code ignored;
  const std::string found = first_line(folder / kKey);
  if (found == text) return true;
  if (fs::exists(folder, ignored) && !found.starts_with(kHead) && !fs::is_empty(folder, ignored))
    throw core::IoError("cannot keep work in " + folder.string() +
                        ": it holds other things; move it, or give another --output");
  fs::remove_all(folder, ignored);
  io::make_folder(folder);
  std::ofstream out(folder / kKey, std::ios::binary);
  out << text << '\n' << std::flush;
  if (!out) fail("write", folder / kKey, errno != 0 ? errno : ENOSPC);
  return false;
}

void drop_unbegun_work(const fs::path& folder) {
  std::error_code ignored;
  if (first_line(folder / kKey).starts_with(kHead) && !fs::exists(folder / "progress", ignored))
    fs::remove_all(folder, ignored);
}

}  // namespace emberfold::apps
