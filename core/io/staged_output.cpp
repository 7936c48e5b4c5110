// SPDX-License-Identifier: Apache-2.0
#include "core/io/staged_output.hpp"

#include <array>
#include <cerrno>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/require_apart.hpp"
#include "core/io/scratch.hpp"
#include "core/io/writing/folder_lock.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

/// Returns whether one of the files that describe a result begins as emberfold writes it.
bool is_own_folder(const fs::path& folder) {
  for (const char* name : {"summary.json", "model.json", "matrix.json", "stages/sketch/columns.json",
                           "stages/run/columns.json"}) {
    std::array<char, 256> head{};
    std::ifstream in(folder / name, std::ios::binary);
    in.read(head.data(), head.size());
    const std::string_view text(head.data(), static_cast<std::size_t>(in.gcount()));
    if (text.find("\"emberfold.") != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace

void require_own(const fs::path& folder, const std::vector<std::string>& names) {
  if (is_own_folder(folder)) return;
  std::error_code ignored;
  for (const auto& name : names)
    if (fs::exists(fs::symlink_status(folder / name, ignored)))
      throw OverwriteError("cannot write " + (folder / name).string() +
                           ": it is there already, and no earlier result; --overwrite replaces it");
}

OutputFolder::OutputFolder(fs::path folder, Existing existing)
    : folder_(std::move(folder)), existing_(existing) {
  if (folder_.empty()) throw core::InputError("the output folder has no name");
  std::error_code ignored;
  for (fs::path missing = fs::absolute(folder_).lexically_normal();
       missing.has_relative_path() && !fs::exists(missing, ignored); missing = missing.parent_path())
    if (missing.has_filename()) made_.push_back(missing);
  try {
    make_folder(folder_);
    lock_ = std::make_unique<const FolderLock>(folder_);
    stage_ = scratch_path(folder_);
    make_folder(stage_);
  } catch (const core::IoError& error) {
    for (const auto& path : made_) fs::remove(path, ignored);
    throw core::IoError(with_final_name(error.what()));
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(stage_, ignored);
  if (committed_) return;
  for (const auto& path : made_) fs::remove(path, ignored);  // removes empty ones only
}

void OutputFolder::write(const std::string& name, const std::function<void(std::ostream&)>& body) {
  const auto fail = [&] {
    throw core::IoError("cannot write " + (folder_ / name).string() + ": " +
                        (errno != 0 ? std::generic_category().message(errno) : "the disk may be full"));
  };
  errno = 0;
  std::ofstream stream(staged(name), std::ios::binary | std::ios::trunc);
  if (!stream) fail();
  try {
    body(stream);
  } catch (const core::IoError&) {
    if (!stream) fail();  // the writer does not know the file or the reason
    throw;
  }
  stream.close();
  if (!stream) fail();
}

void OutputFolder::make_subfolder(const std::string& name) {
  try {
    make_folder(staged(name));
  } catch (const core::IoError& error) {
    throw core::IoError(with_final_name(error.what()));
  }
}

std::string OutputFolder::with_final_name(std::string message) const {
  const std::string staged_prefix = stage_.string(), final_prefix = folder_.string();
  if (staged_prefix.empty()) return message;
  for (auto at = message.find(staged_prefix); at != std::string::npos;
       at = message.find(staged_prefix, at + 1))
    message.replace(at, staged_prefix.size(), final_prefix);
  return message;
}

void OutputFolder::commit() {
  const auto check = [&](const std::error_code& error, const fs::path& path) {
    if (error) throw core::IoError("cannot write " + path.string() + ": " + error.message());
  };
  std::error_code error;
  std::vector<OutputPath> targets;
  for (const auto& entry : fs::directory_iterator(stage_, error))
    targets.push_back({folder_ / entry.path().filename()});
  check(error, folder_);
  if (!inputs_.empty()) require_apart(inputs_, targets);
  if (existing_ == Existing::own) {
    std::vector<std::string> names;
    for (const auto& target : targets) names.push_back(target.path.filename().string());
    require_own(folder_, names);
  }
  for (const auto& entry : fs::directory_iterator(stage_, error)) {
    const fs::path target = folder_ / entry.path().filename();
    if (entry.is_directory()) fs::remove_all(target, error);
    check(error, target);
    fs::rename(entry.path(), target, error);
    check(error, target);
  }
  check(error, folder_);
  committed_ = true;
}

}  // namespace emberfold::io
