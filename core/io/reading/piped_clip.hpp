// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace emberfold::io {

/// Returns whether the name is "-" (standard input), or that of a pipe or a device, which can be read only
/// once.
bool is_piped(const std::string& name);

/// Copies the content of a pipe into a temporary file without a name, so that it can be read repeatedly; the
/// file vanishes with this object, and with the process.
class PipedClip {
 public:
  /// Reads the pipe to its end. Throws core::IoError that names it: it cannot be read, is empty, or the
  /// folder of temporary files (TMPDIR) has no room for it.
  explicit PipedClip(const std::string& name);
  ~PipedClip();
  PipedClip(const PipedClip&) = delete;
  PipedClip& operator=(const PipedClip&) = delete;

  /// Returns a path by which the file can be opened while this object lives.
  [[nodiscard]] std::filesystem::path path() const;

 private:
  int file_ = -1;
};

}  // namespace emberfold::io
