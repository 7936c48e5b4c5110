// SPDX-License-Identifier: Apache-2.0
#include "core/io/writing/folder_lock.hpp"

#include <optional>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.hpp"
#include "core/io/staged_output.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Returns whether another process could lock a folder: a file that is opened anew is as good as one.
bool is_free(const fs::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  const bool locked = ::flock(file, LOCK_EX | LOCK_NB) == 0;
  ::close(file);
  return locked;
}

}  // namespace

TEST_CASE("a folder that one process writes into is refused to others, until it ends in any way") {
  const TempFolder temp;
  const fs::path folder = temp / "out";
  fs::create_directory(folder);
  int ready[2], end[2];
  REQUIRE(::pipe(ready) == 0);
  REQUIRE(::pipe(end) == 0);
  const pid_t child = ::fork();
  char byte = 0;
  if (child == 0) {
    ::close(end[1]);
    const io::OutputFolder output(folder);
    static_cast<void>(::write(ready[1], &byte, 1) + ::read(end[0], &byte, 1));
    ::_exit(0);  // as if killed: no destructor runs
  }
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  const auto message = message_of<core::IoError>([&] { const io::OutputFolder second(folder); });
  CHECK(contains(message, "another emberfold is writing into " + folder.string()));
  ::close(end[0]), ::close(end[1]);
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(is_free(folder));
}

TEST_CASE("calls of one process share a folder, and no file shows that it is held") {
  const TempFolder temp;
  {
    std::optional<io::FolderLock> first(std::in_place, temp.path()), second(std::in_place, temp.path());
    CHECK(fs::is_empty(temp.path()));
    first.reset();
    CHECK_FALSE(is_free(temp.path()));
  }
  CHECK(is_free(temp.path()));
}
