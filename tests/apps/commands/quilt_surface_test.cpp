// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/builtin/rust.hpp"
#include "core/io/clip_reader.hpp"
#include "core/npy.hpp"
#include "tests/apps/commands/command_check.hpp"
#include "tests/dytex/surface/surface_make.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

// Two stacks of one scene: its colours, and 16 bits that could be its normals.
std::string write_stack(const fs::path& path, bool deep, std::uint64_t seed) {
  BuiltinOptions options;
  options.width = 80, options.height = 72, options.frames = 6, options.seed = seed;
  const auto clip = make_rust(options);
  const auto writer = io::create_video(path, {80, 72}, 25, true);
  for (auto frame : clip.frames) {
    if (deep) frame.convertTo(frame, CV_16U, 257);
    writer->write(frame);
  }
  writer->finish();
  return path.string();
}

std::string write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path.string();
}

Json laid(const std::string& clip, const fs::path& out, const std::vector<std::string>& more) {
  const auto result = run_command(joined({"quilt", clip, "-o", out.string(), "--json", "-q"}, more, {}));
  INFO(result.err);
  REQUIRE(result.exit == 0);
  return Json::parse(result.out);
}

std::vector<std::string> mesh_warnings(const Json& summary) {
  std::vector<std::string> found;
  for (const std::string warning : summary["warnings"])
    if (contains(warning, ".obj")) found.push_back(warning);
  return found;
}

const std::vector<std::string> kTexture{"--size", "144x96", "--block", "20", "--set", "quilt.format=png"};

}  // namespace

TEST_CASE("quilt lays a time-lapse over a mesh and its map takes other stacks there") {
  const TempFolder temp;
  const auto clip = write_stack(temp / "colours", false, 1), deep = write_stack(temp / "normals", true, 2);
  const auto mesh = write_text(temp / "cube.obj", cube_obj());
  const auto options = joined(kTexture, {"--set", "quilt.surface=" + mesh}, {});
  const auto summary = laid(clip, temp / "cube", options);
  CHECK(summary["surface"]["charts"] == 6);
  CHECK(summary["surface"]["glued_edges"] == 12);
  CHECK(summary["quilt"]["border_ratio"] > 0);
  CHECK(summary["quilt"]["seam_ratio"] < 2.5);
  CHECK(summary["options"]["quilt"]["surface"] == mesh);
  CHECK(mesh_warnings(summary).empty());
  CHECK(contains(bytes_of(temp / "cube/report.html"), "Border gradient ratio"));
  CHECK(cv::imread((temp / "cube/frames/frame_00005.png").string()).size() == cv::Size(144, 96));
  // The same bytes at any number of threads.
  laid(clip, temp / "threads", joined(options, {"--threads", "3"}, {}));
  CHECK(bytes_of(temp / "threads/map.npy") == bytes_of(temp / "cube/map.npy"));
  CHECK(bytes_of(temp / "threads/seams.png") == bytes_of(temp / "cube/seams.png"));
  const auto map = (temp / "cube/map.npy").string();
  laid(deep, temp / "other", {"--apply", map});
  std::ifstream in(map, std::ios::binary);
  const auto array = core::read_npy(in);
  REQUIRE(array.shape == std::vector<std::size_t>{96, 144, 3});
  const auto& values = std::get<std::vector<std::int32_t>>(array.data);
  const cv::Mat source = cv::imread((temp / "normals/frame_00004.png").string(), cv::IMREAD_UNCHANGED),
                drawn = cv::imread((temp / "other/frames/frame_00004.png").string(), cv::IMREAD_UNCHANGED);
  REQUIRE(drawn.type() == CV_16UC3);
  int wrong = 0;
  for (std::size_t i = 0; i < 144 * 96; ++i) {
    const auto& from = source.at<cv::Vec3w>(values[3 * i + 2], values[3 * i + 1]);
    wrong += drawn.at<cv::Vec3w>(static_cast<int>(i / 144), static_cast<int>(i % 144)) == from ? 0 : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("meshes and options that do not go together are refused in one line") {
  const TempFolder temp;
  const auto clip = write_stack(temp / "colours", false, 1);
  const auto out = (temp / "out").string();
  const auto cube = write_text(temp / "cube.obj", cube_obj());
  const auto refused = [&](const std::vector<std::string>& more, int exit,
                           const std::vector<std::string>& what) {
    check_one_line(joined({"quilt", clip, "-o", out, "-q", "--block", "20"}, more, {}), exit, what, out);
  };
  refused({"--set", "quilt.surface=" + (temp / "none.obj").string()}, 1, {"none.obj"});
  refused({"--set", "quilt.surface=" + write_text(temp / "bad.obj", "v 0 0 0\nv 1 x 0\n")}, 1,
          {"bad.obj", "line 2", "\"x\""});
  refused({"--set", "quilt.surface=" +
                        write_text(temp / "flat.obj", "v 0 0 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 1/2 1/3\n")},
          1, {"flat.obj", "no area"});
  refused({"--set", "quilt.surface=" + cube, "--tileable"}, 2, {"quilt.surface", "--tileable"});
  refused({"--set", "quilt.surface=" + cube, "--apply", "map.npy"}, 2, {"quilt.surface", "--apply"});
  refused({"--set", "quilt.surface=" + cube, "--set", "quilt.seams=moving"}, 2, {"quilt.surface", "seams"});
  // Faces between the texels, and over each other.
  std::string small = cube_obj() + "v 0 0 9\nv 1 0 9\nv 0 1 9\nvt 0.5 0.001\nvt 0.501 0.001\nvt 0.5 0.002\n";
  small += "f -3/-3 -2/-2 -1/-1\n";
  const auto summary =
      laid(clip, temp / "small",
           joined(kTexture, {"--set", "quilt.surface=" + write_text(temp / "small.obj", small)}, {}));
  const auto warnings = mesh_warnings(summary);
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "1 of 7 charts"));
}
