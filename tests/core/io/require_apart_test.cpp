// SPDX-License-Identifier: Apache-2.0
#include "core/io/require_apart.hpp"

#include <fstream>

#include "core/io/staged_output.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

void write(const fs::path& path, const std::string& text = "x") {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

std::string refusal(const std::vector<std::string>& inputs, const std::vector<io::OutputPath>& outputs) {
  return message_of<io::OverwriteError>([&] { io::require_apart(inputs, outputs); });
}

}  // namespace

TEST_CASE("an output that is an input is found under every name") {
  const TempFolder temp;
  const auto clip = temp / "z.mp4";
  write(clip);
  fs::create_symlink(clip, temp / "symbolic.mp4");
  fs::create_symlink("symbolic.mp4", temp / "twice.mp4");
  fs::create_hard_link(clip, temp / "hard.mp4");
  fs::create_directory(temp / "sub");
  fs::create_directory_symlink(temp.path(), temp / "sub/up");
  for (const auto& name : {temp / "z.mp4", temp / "symbolic.mp4", temp / "twice.mp4", temp / "hard.mp4",
                           temp / "./sub/../z.mp4", temp / "sub/up/z.mp4", temp / "sub/up/sub/../z.mp4"}) {
    INFO(name);
    const auto message = refusal({clip.string()}, {{name}});
    CHECK(contains(message, name.string()));
    CHECK(contains(message, clip.string()));
    CHECK_FALSE(refusal({name.string()}, {{clip}}).empty());
  }
  CHECK(refusal({clip.string()}, {{temp / "new.mp4"}}).empty());
  CHECK(refusal({clip.string(), "", "builtin:fire", (temp / "no such").string()}, {{temp / "sub"}, {""}})
            .empty());
}

TEST_CASE("folders, patterns and models stand for what is in them") {
  const TempFolder temp;
  const auto frames = temp / "frames";
  for (const char* name : {"img_0.png", "img_1.png", "notes.txt"}) write(frames / name);
  write(temp / "model/model.json");
  write(temp / "model/texture/model.json");
  write(temp / "other/x.png");
  fs::create_hard_link(frames / "img_1.png", temp / "other/frame_00000.png");
  const std::string folder = frames.string(), pattern = (frames / "img_*.png").string();
  for (const auto& input : {folder, pattern}) {
    INFO(input);
    CHECK_FALSE(refusal({input}, {{frames, true}}).empty());
    CHECK_FALSE(refusal({input}, {{frames}}).empty());
    CHECK_FALSE(refusal({input}, {{frames / "img_1.png"}}).empty());
    CHECK_FALSE(refusal({input}, {{frames / "img_2.png"}}).empty());  // would join the clip
    CHECK_FALSE(refusal({input}, {{temp / "other"}}).empty());        // would be replaced with all in it
    CHECK(refusal({input}, {{temp / "other", true}}).empty());
    CHECK(refusal({input}, {{frames / "out", true}, {frames / "new.mp4"}}).empty());
  }
  CHECK(refusal({pattern}, {{frames / "tile.png"}}).empty());
  CHECK(refusal({pattern}, {{frames / "notes.txt"}}).empty());
  CHECK_FALSE(refusal({folder}, {{frames / "notes.txt"}}).empty());
  CHECK_FALSE(refusal({(temp / "model").string()}, {{temp / "model/texture/model.json"}}).empty());
  CHECK_FALSE(refusal({(temp / "model").string()}, {{temp / "model/texture", true}}).empty());
}

TEST_CASE("two outputs of one name are refused") {
  const TempFolder temp;
  CHECK(contains(refusal({}, {{temp / "a.mp4"}, {temp / "./a.mp4"}}), "two outputs"));
  CHECK(refusal({}, {{temp / "a.mp4"}, {temp / "b.mp4"}, {""}, {""}}).empty());
}

TEST_CASE("an output folder replaces no protected input") {
  const TempFolder temp;
  write(temp / "out/clip.avi", "source");
  io::OutputFolder output(temp / "out");
  output.protect({(temp / "out/clip.avi").string()});
  output.write("a.txt", [](std::ostream& out) { out << "new"; });
  output.write("clip.avi", [](std::ostream& out) { out << "new"; });
  CHECK_FALSE(message_of<io::OverwriteError>([&] { output.commit(); }).empty());
  CHECK(bytes_of(temp / "out/clip.avi") == "source");
  CHECK_FALSE(fs::exists(temp / "out/a.txt"));
}
