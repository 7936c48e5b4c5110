// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/clip_fixture.hpp"

namespace emberfold::test {

using Json = nlohmann::json;

/// Exit code and output of the real program.
struct CommandResult {
  int exit = -1;  ///< 128 + the signal where one ended it
  std::string out, err;
};

struct CommandOptions {
  long long most_file_bytes = -1;      ///< writing a file beyond this fails, as on a full disk
  std::function<bool()> interrupt_if;  ///< Ctrl-C is sent once this holds
  std::string out_file;                ///< standard output goes here instead
  int signal = SIGINT;
};

/// Runs `emberfold` with these arguments and waits for its end.
inline CommandResult run_command(const std::vector<std::string>& arguments,
                                 const CommandOptions& options = {}) {
  const TempFolder folder;
  const std::string out = options.out_file.empty() ? (folder / "out").string() : options.out_file;
  const std::string err = (folder / "err").string();
  std::vector<std::string> words{EMBERFOLD_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    if (options.most_file_bytes >= 0) {
      const auto most = static_cast<rlim_t>(options.most_file_bytes);
      const rlimit limit{most, most};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execv(pointers[0], pointers.data());
    ::_exit(127);
  }
  int status = 0;
  bool sent = false;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!sent && options.interrupt_if && options.interrupt_if()) {
      ::kill(child, options.signal);
      sent = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CommandResult result;
  result.exit = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = options.out_file.empty() ? bytes_of(out) : std::string();
  result.err = bytes_of(err);
  return result;
}

/// The number of files and folders in a folder.
inline std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// The bytes of all files below a folder, by path; folders are empty.
inline std::map<std::string, std::string> snapshot(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::error_code unknown;
    files[entry.path().string()] = entry.is_regular_file(unknown) ? bytes_of(entry.path()) : "";
  }
  return files;
}

inline Json json_of(const fs::path& file) {
  return Json::parse(bytes_of(file));
}

/// The summary a command left in its folder.
inline Json summary_of(const fs::path& folder) {
  return json_of(folder / "summary.json");
}

}  // namespace emberfold::test
