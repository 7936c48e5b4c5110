// SPDX-License-Identifier: Apache-2.0
#include "apps/batch/child_process.hpp"

#include <cerrno>
#include <csignal>
#include <system_error>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.hpp"

namespace emberfold::apps {

namespace {

constexpr int kNotStarted = 127;

/// Executes the program in the child, where only async-signal-safe calls are allowed.
[[noreturn]] void become(const char* program, char* const* words, const char* log, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(kNotStarted);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDWR);
  const int messages = ::open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(messages, STDERR_FILENO);
  ::execv(program, words);
  ::_exit(kNotStarted);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const std::filesystem::path& log) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string(), file = log.string();
  std::vector<std::string> words{"emberfold"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ == 0) become(program.c_str(), pointers.data(), file.c_str(), parent);
  if (process_ < 0)
    throw core::IoError("cannot start " + program + ": " + std::generic_category().message(errno));
}

ChildProcess::~ChildProcess() {
  if (end_) return;
  stop();
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
}

std::optional<ProcessEnd> ChildProcess::ended() {
  int status = 0;
  if (end_ || ::waitpid(process_, &status, WNOHANG) != process_) return end_;
  end_ =
      WIFEXITED(status) ? ProcessEnd{WEXITSTATUS(status), false} : ProcessEnd{128 + WTERMSIG(status), true};
  return end_;
}

void ChildProcess::stop() const {
  if (!end_) ::kill(process_, SIGTERM);
}

}  // namespace emberfold::apps
