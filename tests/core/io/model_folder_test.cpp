// SPDX-License-Identifier: Apache-2.0
#include "core/io/model_folder.hpp"

#include <algorithm>
#include <fstream>

#include <opencv2/core.hpp>

#include "core/error.hpp"
#include "core/io/clip_reader.hpp"
#include "core/io/clip_writer.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

const std::string kTextureText = R"({"format": "emberfold.linear_dynamic_texture", "version": 1})";

core::ModelArchive made_archive() {
  core::ModelArchive archive{kTextureText, {}};
  archive.arrays["A"] = {{2, 3}, false, std::vector<double>{1, 2, 3, 4, 5, 6}};
  archive.arrays["mean"] = {{4}, false, std::vector<float>{1, 2, 3, 4}};
  return archive;
}

void write(const fs::path& folder, const core::ModelArchive& archive) {
  io::ModelFolder model(folder);
  io::write_model(model.output(), "", archive);
  model.commit();
}

std::vector<std::string> names(const fs::path& folder) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) found.push_back(entry.path().filename().string());
  std::ranges::sort(found);
  return found;
}

void put(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// Refused in one line that holds all of these.
void check_unreadable(const fs::path& path, const std::vector<std::string>& what,
                      const io::ModelLimits& limits = {}) {
  const auto message =
      message_of<core::IoError>([&] { static_cast<void>(io::read_model(path, io::kTextureFormat, limits)); });
  INFO(message);
  CHECK_FALSE(message.empty());
  CHECK_FALSE(contains(message, "\n"));
  for (const auto& part : what) CHECK(contains(message, part));
}

}  // namespace

TEST_CASE("a model comes back as it was written") {
  const TempFolder temp;
  const auto archive = made_archive();
  write(temp / "deep/model", archive);
  CHECK(names(temp / "deep/model") == std::vector<std::string>{"A.npy", "mean.npy", "model.json"});
  const auto again = io::read_model(temp / "deep/model", io::kTextureFormat);
  CHECK(again.text == archive.text);
  CHECK(again.arrays == archive.arrays);
  CHECK(io::model_format(temp / "deep/model") == std::string(io::kTextureFormat));
}

TEST_CASE("a model inside an output lies in its folder") {
  const TempFolder temp;
  {
    io::OutputFolder output(temp / "out");
    io::write_model(output, "model", made_archive());
    output.commit();
  }
  CHECK(io::read_model(temp / "out/model", io::kTextureFormat).arrays == made_archive().arrays);
  check_unreadable(temp / "out", {"no model", (temp / "out/model").string()});
}

TEST_CASE("a model replaces a model and what lay with it and nothing else") {
  const TempFolder temp;
  auto old = made_archive();
  old.arrays["B"] = old.arrays["A"];
  write(temp / "model", old);
  put(temp / "model/summary.json", "{}");
  write(temp / "model", made_archive());
  CHECK(names(temp / "model") == std::vector<std::string>{"A.npy", "mean.npy", "model.json"});

  fs::create_directory(temp / "empty");
  write(temp / "empty", made_archive());
  CHECK(names(temp / "empty").size() == 3);

  const auto refused = [&](const fs::path& folder, const std::string& stranger) {
    const auto before = names(folder);
    const auto message = message_of<core::IoError>([&] { write(folder, made_archive()); });
    CHECK(contains(message, folder.string()));
    CHECK(contains(message, stranger));
    CHECK(names(folder) == before);
  };
  put(temp / "model/notes.txt", "mine");
  refused(temp / "model", "notes.txt");
  fs::create_directory(temp / "arrays");
  put(temp / "arrays/data.npy", "mine");
  refused(temp / "arrays", "data.npy");
  put(temp / "file", "x");
  CHECK(contains(message_of<core::IoError>([&] { write(temp / "file", made_archive()); }),
                 (temp / "file").string()));
}

TEST_CASE("a model that is not finished leaves the older one as it was") {
  const TempFolder temp;
  write(temp / "model", made_archive());
  {
    io::ModelFolder model(temp / "model");
    auto other = made_archive();
    other.arrays["B"] = other.arrays["A"];
    io::write_model(model.output(), "", other);
  }
  CHECK(names(temp / "model").size() == 3);
  {
    io::ModelFolder model(temp / "new");
    io::write_model(model.output(), "", made_archive());
  }
  CHECK_FALSE(fs::exists(temp / "new"));
}

TEST_CASE("what is no model is told apart") {
  const TempFolder temp;
  const std::string clip = "is a clip, not a model; learn one with 'emberfold dytex learn'";
  check_unreadable(temp / "no", {(temp / "no").string(), "no such"});
  check_unreadable("", {"empty"});
  check_unreadable("builtin:fire", {"builtin:fire", clip});
  check_unreadable(temp / "img_*.png", {"img_*.png", clip});
  put(temp / "a.mp4", "x");
  check_unreadable(temp / "a.mp4", {"a.mp4", clip});
  const auto writer = io::create_video(temp / "frames", {8, 8}, 25, false);
  writer->write(noise_frame({8, 8}, CV_8UC1, 1));
  writer->finish();
  check_unreadable(temp / "frames", {"frames", clip});
  fs::create_directory(temp / "empty");
  check_unreadable(temp / "empty", {"empty", "model.json"});
  put(temp / "text", "x");
  check_unreadable(temp / "text", {"text", "is a file"});
  write(temp / "model", made_archive());
  check_unreadable(temp / "model/model.json", {"model.json", "the folder"});
}

TEST_CASE("a model.json that is none is refused by name") {
  const TempFolder temp;
  const auto folder = temp / "model";
  fs::create_directory(folder);
  const auto refused = [&](const std::string& text, const std::vector<std::string>& what,
                           const io::ModelLimits& limits = {}) {
    put(folder / "model.json", text);
    check_unreadable(folder, what, limits);
    CHECK_FALSE(io::model_format(folder).has_value());
  };
  refused("", {"model.json", "JSON"});
  refused("MODEL", {"model.json", "JSON"});
  refused(kTextureText.substr(0, kTextureText.size() - 2), {"model.json", "JSON"});
  refused("[1, 2]", {"model.json", "format"});
  refused(R"({"version": 1})", {"model.json", "format"});
  refused(R"({"format": 3})", {"model.json", "format"});
  refused(R"({"format": "some\nthing"})", {"model.json", "some?thing"});
  refused(std::string(100, '[') + std::string(100, ']'), {"model.json", "nested"});
  put(folder / "model.json", kTextureText);
  CHECK_NOTHROW(io::read_model(folder, io::kTextureFormat, {kTextureText.size(), 0}));
  check_unreadable(folder, {"model.json", "larger"}, {kTextureText.size() - 1, 0});
  put(folder / "model.json", R"({"format": "emberfold.motion_model"})");
  check_unreadable(folder, {"is a motion model; 'emberfold synth' draws from it"});
  CHECK(io::model_format(folder) == std::string(io::kMotionFormat));
  const auto other = message_of<core::IoError>([&] {
    write(folder, made_archive());
    static_cast<void>(io::read_model(folder, io::kMotionFormat));
  });
  CHECK(contains(other, "is a linear dynamic texture; 'emberfold dytex synth' draws from it"));
}

TEST_CASE("an array that is broken or too large is refused by its file's name") {
  const TempFolder temp;
  const auto folder = temp / "model";
  write(folder, made_archive());
  const auto whole = bytes_of(folder / "A.npy");
  for (const auto size : {std::size_t{0}, std::size_t{5}, std::size_t{40}, whole.size() - 1}) {
    put(folder / "A.npy", whole.substr(0, size));
    check_unreadable(folder, {"A.npy"});
  }
  put(folder / "A.npy", whole + "x");
  check_unreadable(folder, {"A.npy", "more"});
  put(folder / "A.npy", "this is no array, but a text of some length that goes on for a while");
  check_unreadable(folder, {"A.npy"});
  put(folder / "A.npy", whole);
  const auto total =
      static_cast<std::size_t>(fs::file_size(folder / "A.npy") + fs::file_size(folder / "mean.npy"));
  CHECK_NOTHROW(io::read_model(folder, io::kTextureFormat, {1000, total}));
  check_unreadable(folder, {std::to_string(total - 1), "arrays"}, {1000, total - 1});
}

TEST_CASE("a model given as a clip is told so") {
  const TempFolder temp;
  write(temp / "model", made_archive());
  put(temp / "model/components.png", "not looked at");
  const auto message = message_of<core::IoError>([&] { io::open_video((temp / "model").string(), {}, {}); });
  CHECK(contains(message, "is no clip but a linear dynamic texture; 'emberfold dytex synth' draws from it"));
}
