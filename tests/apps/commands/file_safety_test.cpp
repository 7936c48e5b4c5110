// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <map>

#include "tests/apps/commands/command_check.hpp"

using namespace emberfold;
using namespace emberfold::test;

namespace {

/// Inputs of the commands, under several names.
struct Sources {
  TempFolder temp;
  std::string frames = write_strokes(temp / "frames", {32, 24}, 4);
  std::string clip = (temp / "z.avi").string(), mask = (temp / "mask.png").string(),
              model = (temp / "model").string();

  Sources() {
    const auto writer = io::create_video(clip, {32, 24}, 25, true);
    for (int t = 0; t < 4; ++t) writer->write(noise_frame({32, 24}, CV_8UC3, static_cast<std::uint64_t>(t)));
    writer->finish();
    fs::copy_file(fs::path(frames) / "frame_00000.png", mask);
    fs::create_directory(model);
    std::ofstream(fs::path(model) / "model.json") << R"({"format": "emberfold.motion_model"})";
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (temp / name).string(); }

  /// Exit 2, one line that names both, and every byte as it was.
  void refuse(const std::vector<std::string>& command, const std::string& output,
              const std::string& input) const {
    INFO("output " << output << ", input " << input << ", command " << command[0] << " " << command[1]);
    const auto before = snapshot(temp.path());
    const auto result = run_command(command);
    INFO(result.err);
    CHECK(result.exit == 2);
    CHECK(result.err.starts_with("emberfold: cannot write "));
    CHECK(std::ranges::count(result.err, '\n') == 1);
    CHECK(contains(result.err, output));
    CHECK(contains(result.err, input));
    CHECK(snapshot(temp.path()) == before);
  }
};

}  // namespace

TEST_CASE("no command writes its clip onto the clip that it reads, whatever the name") {
  const Sources made;
  fs::create_symlink(made.clip, made.at("symbolic.avi"));
  fs::create_hard_link(made.clip, made.at("hard.avi"));
  for (const auto& name : {made.clip, made.at("symbolic.avi"), made.at("hard.avi"), made.at("./z.avi")}) {
    made.refuse({"quilt", made.clip, "-o", name, "--block", "8", "--size", "16"}, name, made.clip);
    made.refuse({"dytex", "compose", made.clip, "--layer", made.model, "-o", name}, name, made.clip);
    made.refuse({"dytex", "learn", made.clip, "-o", made.at("m"), "--missing", made.frames, "--filled", name},
                name, made.clip);
  }
  made.refuse({"quilt", made.clip, "--also", made.at("hard.avi"), "-o", made.at("symbolic.avi")},
              made.at("symbolic.avi"), made.clip);
  made.refuse({"quilt", made.mask, "-o", made.mask}, made.mask, made.mask);
}

TEST_CASE("no command writes into the folder or the pattern of images that it reads", "[slow]") {
  const Sources made;
  fs::create_directory_symlink(made.frames, made.at("link"));
  for (const std::string& input :
       {made.frames, made.frames + "/frame_*.png", made.frames + "/frame_%05d.png"})
    for (const auto& folder : {made.frames, made.at("link"), made.frames + "/"}) {
      for (const char* command : {"analyze", "sketch", "compare", "quilt"})
        made.refuse({command, input, "-o", folder}, folder, input);
      made.refuse({"dytex", "learn", input, "-o", folder}, folder, made.frames);
      made.refuse({"dytex", "curve", input, "-o", folder}, folder, input);
      made.refuse({"dytex", "forecast", made.model, input, "-o", folder}, folder, input);
      made.refuse({"dytex", "compose", input, "--layer", made.model, "-o", folder}, folder, made.frames);
      made.refuse({"dytex", "compress", made.model, input, "-o", folder}, folder, made.frames);
    }
  made.refuse({"compare", made.clip, made.frames, "-o", made.frames}, made.frames, made.frames);
  made.refuse({"quilt", made.frames, "-o", made.frames + "/tile.png", "--frame", "0"}, "tile.png",
              made.frames);
}

TEST_CASE("no command writes onto models, masks and maps that it reads") {
  const Sources made;
  fs::create_directory_symlink(made.model, made.at("other"));
  for (const auto& folder : {made.model, made.at("other")}) {
    made.refuse({"synth", made.model, "-o", folder}, folder, made.model);
    made.refuse({"dytex", "edit", made.model, "-o", folder, "--speed", "2"}, folder, made.model);
    made.refuse({"dytex", "synth", made.model, "-o", folder}, folder, made.model);
    made.refuse({"dytex", "distance", made.model, made.frames, "-o", folder}, folder, made.model);
    made.refuse({"dytex", "forecast", made.model, "-o", folder}, folder, made.model);
  }
  const std::string json = made.model + "/model.json";
  made.refuse({"dytex", "page", made.model, "-o", json}, json, json);
  made.refuse({"synth", made.model, "-o", made.at("new.mp4"), "--motion", json}, json, json);
  made.refuse(
      {"synth", made.model, "-o", made.at("new.mp4"), "--birth-map", made.mask, "--overlay", made.mask},
      made.mask, made.mask);
  made.refuse({"dytex", "learn", made.clip, "--mask", made.mask, "-o", made.at("m"), "--missing", made.clip,
               "--filled", made.mask},
              made.mask, made.mask);
  made.refuse({"quilt", made.clip, "--control", "depth:" + made.mask, "-o", made.mask}, made.mask, made.mask);
  made.refuse({"dytex", "compose", made.clip, "--layer", made.model + ":" + made.mask, "-o", made.mask},
              made.mask, made.mask);
}

TEST_CASE("a clip that lies in the output folder under a name that is written is refused") {
  const Sources made;
  fs::create_directory(made.at("out"));
  for (const char* name : {"overlay.mp4", "side_by_side.mp4", "forecast.avi"})
    fs::copy_file(made.clip, made.at("out") + "/" + name);
  const std::string out = made.at("out");
  made.refuse({"analyze", out + "/overlay.mp4", "-o", out}, out + "/overlay.mp4", out + "/overlay.mp4");
  made.refuse({"sketch", out + "/overlay.mp4", "-o", out}, out + "/overlay.mp4", out + "/overlay.mp4");
  made.refuse({"compare", made.clip, out + "/side_by_side.mp4", "-o", out}, out + "/side_by_side.mp4",
              out + "/side_by_side.mp4");
  made.refuse({"dytex", "forecast", made.model, out + "/forecast.avi", "-o", out}, out + "/forecast.avi",
              out + "/forecast.avi");
  // beside the output a clip is safe
  fs::copy_file(made.clip, out + "/mine.avi");
  const auto source = bytes_of(out + "/mine.avi");
  CHECK(run_command({"sketch", out + "/mine.avi", "-o", out, "-q", "--overwrite"}).exit == 0);
  CHECK(bytes_of(out + "/mine.avi") == source);
}

TEST_CASE("dytex classify writes into none of the folders that it reads") {
  const Sources made;
  for (const char* name : {"fire", "water"})
    for (const char* clip : {"a", "b"})
      write_strokes(
          (fs::create_directories(made.temp / "classes" / name), made.temp / "classes" / name / clip),
          {16, 16}, 3, 2);
  for (const char* folder : {"classes", "classes/fire", "classes/fire/a"})
    made.refuse({"dytex", "classify", made.at("classes"), "-o", made.at(folder)}, made.at(folder),
                made.at(folder));
}

TEST_CASE("synth gives each of its outputs a name of its own") {
  const Sources made;
  check_one_line({"synth", made.model, "-o", made.at("a.mp4"), "--overlay", made.at("./a.mp4")}, 2,
                 {"two outputs", "a.mp4"}, made.at("a.mp4"));
}
