// SPDX-License-Identifier: Apache-2.0
#include "core/io/staged_output.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include <unistd.h>

#include "core/error.hpp"
#include "core/io/files.hpp"
#include "core/io/require_apart.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) throw core::InputError("the output folder has no name");
  std::error_code ignored;
  for (fs::path missing = fs::absolute(folder_).lexically_normal();
       missing.has_relative_path() && !fs::exists(missing, ignored); missing = missing.parent_path())
    if (missing.has_filename()) made_.push_back(missing);
  stage_ = folder_ / (".emberfold-" + std::to_string(getpid()) + ".part");
  try {
    make_folder(folder_);
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
                        (errno != 0 ? std::strerror(errno) : "the disk may be full"));
  };
  errno = 0;
  std::ofstream stream(staged(name), std::ios::binary | std::ios::trunc);
  if (!stream) fail();
  body(stream);
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
