// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_identity.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.hpp"
#include "core/fingerprint.hpp"
#include "core/io/image_files.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

/// Adds evenly spaced samples of a file's content, including head and tail; small files are added whole.
bool add_content(core::Fingerprint& sum, const fs::path& path, std::uintmax_t size) {
  constexpr std::uintmax_t kBlock = std::uintmax_t{1} << 14, kBlocks = 9;  // 144 KiB take below 1 ms
  std::ifstream in(path, std::ios::binary);
  std::string block;
  const bool is_small = size <= kBlock * kBlocks;
  for (std::uintmax_t i = 0; i < (is_small ? 1 : kBlocks); ++i) {
    block.resize(is_small ? size : kBlock);
    in.seekg(static_cast<std::streamoff>(is_small ? 0 : (size - kBlock) / (kBlocks - 1) * i));
    if (i + 1 == kBlocks) in.seekg(static_cast<std::streamoff>(size - kBlock));
    if (!in.read(block.data(), static_cast<std::streamsize>(block.size()))) return false;
    sum.add(block);
  }
  return true;
}

/// Adds a file's size, time of last change and content; returns whether it is a file that can be read.
bool add_file(core::Fingerprint& sum, const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  const auto size = fs::file_size(path, error);
  if (error) return false;
  const auto time = fs::last_write_time(path, error);
  if (error) return false;
  sum.add(
      std::to_string(size) + " " +
      std::to_string(std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count()));
  return add_content(sum, path, size);
}

}  // namespace

std::string clip_identity(const std::string& name) {
  core::Fingerprint sum;
  std::error_code error;
  if (add_file(sum, name)) return sum.text();
  try {
    const auto images = fs::is_directory(name, error) ? list_images(name)
                        : is_pattern(name)            ? match_images(name)
                                                      : std::vector<fs::path>();
    for (const auto& image : images) {
      sum.add(image.filename().string());
      if (!add_file(sum, image)) return {};
    }
    return images.empty() ? std::string() : sum.text();
  } catch (const core::IoError&) {
    return {};
  }
}

}  // namespace emberfold::io
