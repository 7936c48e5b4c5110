// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace emberfold::io {

/// A folder whose files appear all together or not at all: they are written into a hidden folder inside it
/// and take their places by commit(). Without commit() everything begun is removed, and the folder too if it
/// was made here. core::IoError, with the final path and the system's reason, where something cannot be
/// written.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where the file or folder `name` is written until commit().
  [[nodiscard]] std::filesystem::path staged(const std::string& name) const { return stage_ / name; }
  /// Writes a file through a stream and checks that all of it arrived.
  void write(const std::string& name, const std::function<void(std::ostream&)>& body);
  void make_subfolder(const std::string& name);
  /// Makes commit() refuse to replace any of these files (see require_apart).
  void protect(std::vector<std::string> inputs) { inputs_ = std::move(inputs); }
  /// A message about a staged file, told of the final one.
  [[nodiscard]] std::string of_final(std::string message) const;
  /// Puts everything in place; a file or folder of the same name is replaced. Throws OverwriteError, with
  /// nothing replaced, where that is a protected input.
  void commit();
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_, stage_;
  std::vector<std::filesystem::path> made_;  // folders that were not there, the innermost first
  std::vector<std::string> inputs_;
  bool committed_ = false;
};

}  // namespace emberfold::io
