// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace emberfold::io {

class FolderLock;

/// Selects which files an output folder may replace.
enum class Existing {
  own,  ///< those in a folder that emberfold made: whose summary.json, model.json or stages are its own
  all,
};

/// Throws OverwriteError that names the first of these files and folders that already exists, unless the
/// folder is one that emberfold made.
void require_own(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// Writes files that appear in a folder all together or not at all. They are staged in a hidden folder inside
/// it that no other process uses; commit() moves them. Without commit() they are removed, and the folder too
/// if it was made here. Throws core::IoError, with the final path and the system's reason, where something
/// cannot be written, or another process writes into the folder (FolderLock).
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder, Existing existing = Existing::own);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Returns the path of the file or folder `name` until commit().
  [[nodiscard]] std::filesystem::path staged(const std::string& name) const { return stage_ / name; }
  /// Writes a file through a stream and checks that all of it arrived.
  void write(const std::string& name, const std::function<void(std::ostream&)>& body);
  void make_subfolder(const std::string& name);
  /// Makes commit() refuse to replace any of these files (see require_apart).
  void protect(std::vector<std::string> inputs) { inputs_ = std::move(inputs); }
  /// Replaces the names of staged files in a message by their final ones.
  [[nodiscard]] std::string with_final_name(std::string message) const;
  /// Puts everything in place; a file or folder of the same name is replaced. Throws OverwriteError, with
  /// nothing replaced, where that is a protected input, or must not be replaced.
  void commit();
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_, stage_;
  std::unique_ptr<const FolderLock> lock_;
  Existing existing_;
  std::vector<std::filesystem::path> made_;  // folders that did not exist, the innermost first
  std::vector<std::string> inputs_;
  bool committed_ = false;
};

}  // namespace emberfold::io
