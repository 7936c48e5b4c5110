// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace emberfold::apps {

/// Holds how a process ended.
struct ProcessEnd {
  int exit = 0;  ///< its exit status, or 128 + the signal that ended it
  bool by_signal = false;
};

/// Runs this program again with other arguments.
/// Terminal signals reach it only through stop(); it is stopped when this process dies.
class ChildProcess {
 public:
  /// Starts it with standard output closed and messages written to the file `log`. Throws core::IoError.
  ChildProcess(const std::vector<std::string>& arguments, const std::filesystem::path& log);
  /// Stops it and waits for its end.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Returns how it ended; nothing while it is running.
  std::optional<ProcessEnd> ended();
  /// Asks it to stop (SIGTERM).
  void stop() const;

 private:
  pid_t process_ = -1;
  std::optional<ProcessEnd> end_;
};

}  // namespace emberfold::apps
