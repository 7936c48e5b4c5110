// SPDX-License-Identifier: Apache-2.0
#include "core/io/reading/piped_clip.hpp"

#include <cerrno>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.hpp"

namespace emberfold::io {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& shown, const std::string& reason) {
  throw core::IoError("cannot read " + shown + ": " + reason);
}

/// Opens a temporary file and removes its name at once.
int open_nameless(const std::string& shown) {
  std::error_code error;
  fs::path folder = fs::temp_directory_path(error);
  if (error) folder = "/tmp";
  std::string name = (folder / "emberfold-clip-XXXXXX").string();
  const int file = ::mkostemp(name.data(), O_CLOEXEC);
  if (file < 0)
    fail(shown, "no temporary file can be made in " + folder.string() + ": " +
                    std::generic_category().message(errno));
  ::unlink(name.c_str());
  return file;
}

void write_whole(int file, const char* data, std::size_t count, const std::string& shown) {
  while (count > 0) {
    const auto written = ::write(file, data, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0)
      fail(shown, std::string("its temporary copy cannot be written: ") +
                      std::generic_category().message(errno) + "; TMPDIR names another folder for it");
    data += written;
    count -= static_cast<std::size_t>(written);
  }
}

}  // namespace

bool is_piped(const std::string& name) {
  if (name == "-") return true;
  std::error_code error;
  const auto status = fs::status(name, error);
  return fs::is_fifo(status) || fs::is_socket(status) || fs::is_character_file(status);
}

PipedClip::PipedClip(const std::string& name) {
  const std::string shown = name == "-" ? "standard input" : name;
  const int pipe = name == "-" ? ::dup(STDIN_FILENO) : ::open(name.c_str(), O_RDONLY | O_CLOEXEC);
  if (pipe < 0) fail(shown, std::generic_category().message(errno));
  std::size_t total = 0;
  try {
    if (::isatty(pipe) == 1) fail(shown, "it is a terminal; pipe a clip into it");
    file_ = open_nameless(shown);
    std::vector<char> buffer(std::size_t{1} << 18);
    while (true) {
      const auto count = ::read(pipe, buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(shown, std::generic_category().message(errno));
      if (count == 0) break;
      write_whole(file_, buffer.data(), static_cast<std::size_t>(count), shown);
      total += static_cast<std::size_t>(count);
    }
    if (total == 0) fail(shown, "it is empty");
  } catch (...) {
    ::close(pipe);
    if (file_ >= 0) ::close(file_);
    throw;
  }
  ::close(pipe);
}

PipedClip::~PipedClip() {
  if (file_ >= 0) ::close(file_);
}

fs::path PipedClip::path() const {
  return "/proc/self/fd/" + std::to_string(file_);
}

}  // namespace emberfold::io
