// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_identity.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>
#include <vector>

#include "core/error.hpp"
#include "core/fingerprint.hpp"
#include "core/io/image_files.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

/// Adds a file's size and time of last change; returns whether it is a file.
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
  return true;
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
