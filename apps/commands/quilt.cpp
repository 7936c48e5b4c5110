// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "apps/cli/command_line.hpp"
#include "apps/quilting/job.hpp"

namespace emberfold::apps {

namespace {

struct Asked {
  Reading reading;
  QuiltRequest request;
  std::vector<std::string> others;
  std::string size, block;
};

void add_options(CLI::App& command, Asked& asked) {
  auto& request = asked.request;
  add_clip_output(command, request.output,
                  "Write a folder with report, or a clip .mp4, .avi (.png: one frame)");
  command.add_option("--size", asked.size, "Make the output of this size; default: twice the clip's")
      ->type_name("WxH");
  command.add_option("--block", asked.block, "Copy blocks of this size; elongated ones suit grass")
      ->type_name("N|WxH")
      ->default_str("64");
  command.add_flag("--tileable", request.quilt.tileable, "Fit opposite sides of the output to each other");
  command.add_option("--also", asked.others, "Take blocks from this clip too; may be repeated")
      ->type_name("CLIP");
  command
      .add_option("--mask", request.masks, "Do not copy pixels where this image is not 0; one for each clip")
      ->type_name("IMAGE");
  command.add_option("--guide", request.guide, "Follow the brightness of this image")->type_name("IMAGE");
  command.add_option("--apply", request.apply, "Render this map, the layout of another quilt")
      ->type_name("MAP.npy");
  command
      .add_option("--control", request.control.rate,
                  "Set the speed of time: a number, .npy, image, gradient:right, depth:IMAGE")
      ->type_name("MAP");
  command
      .add_option_function<int>(
          "--frames", [&request](int frames) { request.frames = frames; },
          "Render this many frames; default: as many as the clip has")
      ->type_name("N");
  command
      .add_option_function<int>(
          "--frame", [&request](int frame) { request.frame = frame; }, "Render this frame alone, from 0")
      ->type_name("N");
}

void add_quilt_settings(Settings& settings, QuiltRequest& request) {
  settings.add("quilt", "overlap", &request.quilt.overlap, "PX",
               "Overlap of blocks; default: a quarter of a block", "1 to half a block");
  settings.add("quilt", "flatten", &request.flatten, "PX",
               "Remove gradients wider than this from the clips; 0: none", "0, 1 to 4096");
  settings.add("quilt", "memory", &request.memory, "MB",
               "Keep at most this much of the clips in memory, the rest in a file next to OUT",
               "0 to 1000000");
  settings.add_word("quilt", "seams", request.seams, {"still", "moving"}, "",
                    "Join blocks along the same path in every frame, or let seams move in space and time");
  settings.add_word("quilt", "surface", request.surface, {}, "MESH.obj",
                    "Make the texture of this mesh, 1024x1024 unless --size is given");
  settings.add_word("quilt", "format", request.format, {"mp4", "avi", "png"}, "",
                    "Write the clip of a folder in this format; default: mp4, or png for 16 bits");
}

void add_time_settings(Settings& settings, ControlRequest& control) {
  settings.add_word("control", "offset", control.offset, {}, "MAP",
                    "Begin time later by this many frames: a map as for --control, white: 30");
  settings.add("control", "jitter", &control.jitter, "FRAMES",
               "Shift blocks in time, smoothly, by up to this", "0 to 10000");
  settings.add_word("control", "ends", control.ends, {"clamp", "loop", "ping-pong"}, "",
                    "Continue time before and after the clip");
}

void run_asked(Asked asked, Session& session) {
  auto& request = asked.request;
  request.read = check_reading(asked.reading, session);
  request.clips = {asked.reading.clip};
  request.clips.insert(request.clips.end(), asked.others.begin(), asked.others.end());
  request.quilt.seed = session.common.seed;
  request.quilt.seams = request.seams == "moving" ? dytex::Seams::moving : dytex::Seams::still;
  if (request.own_size) request.quilt.size = parse_size("--size", asked.size);
  if (request.own_block) request.quilt.block = parse_size("--block", asked.block);
  check_request(request);
  run_quilt(request, session);
}

}  // namespace

void add_quilt(CLI::App& app, CommandLine& line) {
  auto* command =
      add_command(app, "quilt", "Extend a time-lapse in space, and vary the speed of time over it", R"(
  emberfold quilt stone.png -o tile.png --size 1024 --tileable
  emberfold quilt builtin:rust -o out/pot --set quilt.surface=pot.obj
  emberfold quilt normals.avi --apply out/pot/map.npy -o out/normals)");
  const auto asked = std::make_shared<Asked>();
  add_reading(*command, asked->reading, false);
  add_options(*command, *asked);
  const auto settings = add_settings(*command, line);
  add_quilt_settings(*settings, asked->request);
  add_time_settings(*settings, asked->request.control);
  finish_command(*command, line, asked, run_asked, [asked, command, settings] {
    auto& request = asked->request;
    request.own_size = command->count("--size") > 0;
    request.own_block = command->count("--block") > 0;
    request.own_overlap = settings->is_given("quilt.overlap");
  });
}

}  // namespace emberfold::apps
