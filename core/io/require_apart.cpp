// SPDX-License-Identifier: Apache-2.0
#include "core/io/require_apart.hpp"

#include <compare>
#include <map>
#include <optional>
#include <set>

#include <sys/stat.h>

#include "core/io/image_files.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

struct FileId {
  dev_t device = 0;
  ino_t inode = 0;
  auto operator<=>(const FileId&) const = default;
};

struct FoundFile {
  FileId id;
  bool is_folder = false;
};

/// Finds a file or folder, following links; nothing for anything else.
std::optional<FoundFile> find_file(const fs::path& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  if (!S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode)) return std::nullopt;
  return FoundFile{{found.st_dev, found.st_ino}, S_ISDIR(found.st_mode)};
}

/// The entries of a folder; none where it cannot be read.
std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    found.push_back(entry->path());
  return found;
}

class Inputs {
 public:
  explicit Inputs(const std::vector<std::string>& names) {
    for (const auto& name : names)
      if (!name.empty() && !name.starts_with("builtin:")) add(name);
  }

  [[nodiscard]] const std::string* file(const FileId& id) const { return find(files_, id); }
  [[nodiscard]] const std::string* folder(const FileId& id) const { return find(folders_, id); }

 private:
  using Names = std::map<FileId, std::string>;

  static const std::string* find(const Names& names, const FileId& id) {
    const auto at = names.find(id);
    return at == names.end() ? nullptr : &at->second;
  }

  void add(const fs::path& path) {
    const auto found = find_file(path);
    if (found && found->is_folder) {
      add_folder(path, found->id);
    } else if (found) {
      files_.emplace(found->id, path.string());
    } else if (is_pattern(path)) {
      add_pattern(path);
    }
  }

  void add_folder(const fs::path& path, const FileId& id) {
    if (!folders_.emplace(id, path.string()).second) return;
    const bool is_model = find_file(path / "model.json").has_value();
    for (const auto& entry : entries(path)) {
      const auto found = find_file(entry);
      if (found && !found->is_folder) files_.emplace(found->id, entry.string());
      if (found && found->is_folder && is_model) add_folder(entry, found->id);
    }
  }

  void add_pattern(const fs::path& pattern) {
    const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
    if (const auto found = find_file(folder)) folders_.emplace(found->id, pattern.string());
    for (const auto& entry : entries(folder))
      if (fits_pattern(pattern.filename().string(), entry.filename().string()))
        if (const auto found = find_file(entry)) files_.emplace(found->id, entry.string());
  }

  Names files_, folders_;
};

[[noreturn]] void refuse(const fs::path& output, const std::string& what, const std::string& input) {
  throw OverwriteError("cannot write " + output.string() + ": " + what + " " + input +
                       ", which is read; give the output another name");
}

void check_contents(const Inputs& inputs, const fs::path& output, const fs::path& folder) {
  for (const auto& entry : entries(folder)) {
    const auto found = find_file(entry);
    if (!found) continue;
    if (const auto* input = found->is_folder ? inputs.folder(found->id) : inputs.file(found->id))
      refuse(output, "it holds", *input);
    if (found->is_folder && !fs::is_symlink(entry)) check_contents(inputs, output, entry);
  }
}

void check_replaced(const Inputs& inputs, const fs::path& output, const fs::path& path, const char* what) {
  const auto found = find_file(path);
  if (!found) return;
  if (const auto* input = inputs.file(found->id)) refuse(output, what, *input);
  if (!found->is_folder) return;
  if (const auto* input = inputs.folder(found->id)) refuse(output, what, *input);
  check_contents(inputs, output, path);
}

/// Returns the path resolved by the system and as given: a writer may use either.
std::set<fs::path> spellings(const fs::path& path) {
  std::error_code error;
  fs::path normal = fs::absolute(path, error).lexically_normal();
  if (!normal.has_filename()) normal = normal.parent_path();  // a slash at the end
  return {path.has_filename() ? path : path.parent_path(), normal};
}

/// Returns whether an image of this name belongs to the folder or pattern that is read.
bool joins(const fs::path& input, const fs::path& image) {
  std::error_code error;
  return fs::is_directory(input, error) || fits_pattern(input.filename().string(), image.filename().string());
}

void check_output(const Inputs& inputs, const OutputPath& output) {
  for (const auto& path : spellings(output.path)) {
    if (output.is_folder) {
      const auto found = find_file(path);
      const auto* input = !found             ? nullptr
                          : found->is_folder ? inputs.folder(found->id)
                                             : inputs.file(found->id);
      if (input != nullptr) refuse(output.path, "it is the place of", *input);
      continue;
    }
    check_replaced(inputs, output.path, path, "it is");
    const auto parent = find_file(path.has_parent_path() ? path.parent_path() : fs::path("."));
    if (parent && is_image_name(path))
      if (const auto* input = inputs.folder(parent->id); input != nullptr && joins(*input, path))
        refuse(output.path, "it would be an image of", *input);
  }
}

}  // namespace

fs::path replaced_path(const fs::path& output) {
  return is_pattern(output) && output.has_parent_path() ? output.parent_path() : output;
}

void require_apart(const std::vector<std::string>& inputs, const std::vector<OutputPath>& outputs) {
  const Inputs read(inputs);
  std::map<fs::path, fs::path> written;
  for (const auto& asked : outputs) {
    if (asked.path.empty()) continue;
    const OutputPath output{replaced_path(asked.path), asked.is_folder};
    check_output(read, output);
    if (output.is_folder) continue;
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(*spellings(output.path).rbegin(), error);
    const auto [other, is_new] = written.emplace(error ? output.path : whole, output.path);
    if (!is_new)
      throw OverwriteError("two outputs have one name: " + other->second.string() + " and " +
                           output.path.string());
  }
}

}  // namespace emberfold::io
