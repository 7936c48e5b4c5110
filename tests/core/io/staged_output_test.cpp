// SPDX-License-Identifier: Apache-2.0
#include "core/io/staged_output.hpp"

#include <ostream>

#include <sys/wait.h>
#include <unistd.h>

#include "core/error.hpp"
#include "core/io/require_apart.hpp"
#include "core/io/scratch.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {
std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}
void put(io::OutputFolder& output, const std::string& name, const std::string& text) {
  output.write(name, [&](std::ostream& out) { out << text; });
}
}  // namespace

TEST_CASE("files of an output folder appear together, by commit") {
  const TempFolder temp;
  const auto path = temp / "a";
  io::OutputFolder output(path / "b");
  put(output, "one", "1");
  output.make_subfolder("sub");
  put(output, "sub/two", "2");
  CHECK_FALSE(fs::exists(path / "b" / "one"));
  output.commit();
  CHECK(bytes_of(path / "b" / "one") == "1");
  CHECK(bytes_of(path / "b" / "sub" / "two") == "2");
  CHECK(entries(path / "b") == 3);  // its hidden folder goes with it
}

TEST_CASE("without commit nothing is left, and what was there before stays") {
  const TempFolder temp;
  {
    io::OutputFolder output(temp / "new/deep");
    put(output, "one", "1");
  }
  CHECK_FALSE(fs::exists(temp / "new"));
  fs::create_directory(temp / "old");
  std::ofstream(temp / "old/one") << "before";
  {
    io::OutputFolder output(temp / "old");
    put(output, "one", "after");
  }
  CHECK(bytes_of(temp / "old/one") == "before");
  CHECK(entries(temp / "old") == 1);
}

TEST_CASE("a second run replaces the first one's files and folders, and leaves strangers alone") {
  const TempFolder temp;
  for (const char* text : {"first", "second"}) {
    io::OutputFolder output(temp / "out");
    put(output, "one", text);
    put(output, "summary.json", R"({"format": "emberfold.summary"})");
    output.make_subfolder("sub");
    put(output, std::string("sub/") + text, text);
    output.commit();
    std::ofstream(temp / "out/mine") << "mine";
  }
  CHECK(bytes_of(temp / "out/one") == "second");
  CHECK_FALSE(fs::exists(temp / "out/sub/first"));
  CHECK(bytes_of(temp / "out/mine") == "mine");
}

TEST_CASE("what no run of emberfold wrote is replaced only where that is asked for") {
  const TempFolder temp;
  fs::create_directory(temp / "out");
  std::ofstream(temp / "out/one") << "mine";
  const auto write = [&](io::Existing existing) {
    io::OutputFolder output(temp / "out", existing);
    put(output, "one", "new");
    put(output, "two", "new");
    output.commit();
  };
  const auto message = message_of<io::OverwriteError>([&] { write(io::Existing::own); });
  CHECK(contains(message, (temp / "out/one").string()));
  CHECK(contains(message, "--overwrite"));
  CHECK(bytes_of(temp / "out/one") == "mine");
  CHECK(entries(temp / "out") == 1);
  write(io::Existing::all);
  CHECK(bytes_of(temp / "out/one") == "new");
  std::ofstream(temp / "out/summary.json") << "{\"format\": \"another\"}";
  CHECK_FALSE(message_of<io::OverwriteError>([&] { write(io::Existing::own); }).empty());
}

TEST_CASE("what killed runs left is cleared by the next one, what others are writing is not") {
  const TempFolder temp;
  const fs::path left = temp / "out";
  fs::create_directory(left);
  const pid_t child = ::fork();
  if (child == 0) {
    io::OutputFolder output(left);
    output.write("half", [](std::ostream& out) { out << "x"; });
    std::ofstream(io::scratch_path(left, ".mp4")) << "x";
    ::_exit(0);  // as if killed: no destructor runs
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(entries(left) == 2);
  std::ofstream(left / ".emberfold-otherhost-1-1.part") << "of another machine";
  std::ofstream(left / ".emberfold-notes") << "mine";
  const auto own = io::scratch_path(left);
  fs::create_directory(own);
  {
    io::OutputFolder output(left);
    put(output, "one", "1");
    output.commit();
  }
  CHECK(fs::exists(own));
  CHECK(fs::exists(left / ".emberfold-otherhost-1-1.part"));
  CHECK(fs::exists(left / ".emberfold-notes"));
  CHECK(entries(left) == 4);  // and "one"
}

TEST_CASE("an output folder that cannot be is refused by its own name") {
  const TempFolder temp;
  std::ofstream(temp / "file") << "x";
  const std::string name = (temp / "file").string();
  CHECK(contains(message_of<core::IoError>([&] { io::OutputFolder output(temp / "file"); }), name));
  CHECK(contains(message_of<core::IoError>([&] { io::OutputFolder output(temp / "file/below"); }), name));
  io::OutputFolder output(temp / "out");
  const std::string message = message_of<core::IoError>([&] { put(output, "no/such/folder", "x"); });
  CHECK(contains(message, (temp / "out/no/such/folder").string()));
  CHECK_FALSE(contains(message, ".part"));
}
