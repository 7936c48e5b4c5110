// SPDX-License-Identifier: Apache-2.0
#include "core/io/clip_identity.hpp"

#include <chrono>
#include <fstream>
#include <string>

#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

void write_image(const fs::path& path, const std::string& bytes = "image") {
  std::ofstream(path, std::ios::binary) << bytes;
  fs::last_write_time(path, fs::file_time_type(std::chrono::seconds(1000)));
}

}  // namespace

TEST_CASE("a clip's identity changes with its files' names, sizes and times, not with its place") {
  const TempFolder temp;
  fs::create_directory(temp / "a");
  for (const char* name : {"1.png", "2.png"}) write_image(temp / "a" / name);
  const auto identity = [&](const std::string& name) { return io::clip_identity((temp / name).string()); };
  const std::string first = identity("a");
  REQUIRE(!first.empty());
  fs::rename(temp / "a", temp / "b");
  CHECK(identity("b") == first);
  CHECK(identity("b/%d.png") == first);
  fs::rename(temp / "b/2.png", temp / "b/3.png");
  const std::string renamed = identity("b");
  CHECK(renamed != first);
  write_image(temp / "b/3.png", "longer image");
  const std::string longer = identity("b");
  CHECK(longer != renamed);
  fs::last_write_time(temp / "b/3.png", fs::file_time_type(std::chrono::seconds(1001)));
  CHECK(identity("b") != longer);

  // replaced in place: equal size and time, other content
  const std::string before = identity("b");
  const auto time = fs::last_write_time(temp / "b/3.png");
  write_image(temp / "b/3.png", "edited image");
  fs::last_write_time(temp / "b/3.png", time);
  CHECK(identity("b") != before);
  std::string large(std::size_t{1} << 20, 'a');
  write_image(temp / "large.avi", large);
  const std::string whole = identity("large.avi");
  for (const std::size_t at : {std::size_t{0}, large.size() / 2, large.size() - 1}) {
    std::string changed = large;
    changed[at] = 'b';
    write_image(temp / "large.avi", changed);
    CHECK(identity("large.avi") != whole);
  }
  write_image(temp / "large.avi", large);
  CHECK(identity("large.avi") == whole);

  write_image(temp / "clip.avi");
  const std::string clip = identity("clip.avi");
  CHECK(!clip.empty());
  fs::rename(temp / "clip.avi", temp / "moved.avi");
  CHECK(identity("moved.avi") == clip);
  CHECK(identity("clip.avi").empty());
  CHECK(identity("no such folder").empty());
}
