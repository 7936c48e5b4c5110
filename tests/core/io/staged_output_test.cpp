// SPDX-License-Identifier: Apache-2.0
#include "core/io/staged_output.hpp"

#include <ostream>

#include <unistd.h>

#include "core/error.hpp"
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
    output.make_subfolder("sub");
    put(output, std::string("sub/") + text, text);
    output.commit();
    std::ofstream(temp / "out/mine") << "mine";
  }
  CHECK(bytes_of(temp / "out/one") == "second");
  CHECK_FALSE(fs::exists(temp / "out/sub/first"));
  CHECK(bytes_of(temp / "out/mine") == "mine");
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
