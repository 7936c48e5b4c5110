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
  std::string size, block, rates, offsets;
  double frames = 0, frame = 0;
};

void add_blocks(CLI::App& command, Asked& asked) {
  auto& quilt = asked.request.quilt;
  const char* group = "Quilting";
  command.add_option("--size", asked.size, "Size of the output; twice the source's")
      ->type_name("WxH")
      ->group(group);
  command.add_option("--block", asked.block, "Size of the blocks; elongated ones suit grass and the like")
      ->type_name("N|WxH")
      ->default_str("64")
      ->group(group);
  add_number(command, "--overlap", quilt.overlap, "PX", "How far blocks overlap; a quarter of a block")
      ->group(group);
  add_number(command, "--components", quilt.components, "N", "Rank of the basis that places are compared in")
      ->group(group);
  add_number(command, "--tolerance", quilt.tolerance, "SHARE",
             "Blocks with so much more error than the best are as good")
      ->group(group);
  add_number(command, "--floor", quilt.floor, "LEVELS", "... and so are those below this RMS error")
      ->group(group);
  add_number(command, "--apart", quilt.apart, "PX",
             "Do not show again what blocks nearby show, or what is nearer to it than this; half a block")
      ->default_str("32")
      ->group(group);
  command.add_flag("--tileable", quilt.tileable, "Opposite sides of the output fit each other")->group(group);
  command.add_flag("--exact", quilt.exact, "Compare every place over all of time: slow, chooses the same")
      ->group(group);
}

void add_sources(CLI::App& command, Asked& asked) {
  auto& request = asked.request;
  const char* group = "Sources";
  command.add_option("--also", asked.others, "Another clip to take blocks from; as often as one likes")
      ->type_name("CLIP")
      ->group(group);
  command
      .add_option("--mask", request.masks, "White pixels of this image must not be copied; one for each clip")
      ->type_name("IMAGE")
      ->group(group);
  add_number(command, "--flatten", request.flatten, "PX",
             "Remove gradients wider than this from the source; 0: none")
      ->group(group);
  command.add_option("--guide", request.guide, "An image whose brightness the quilt follows")
      ->type_name("IMAGE")
      ->group(group);
  add_number(command, "--guide-weight", request.quilt.guide_weight, "SHARE",
             "Of the guide against the overlap")
      ->group(group);
  command
      .add_option("--apply", request.apply,
                  "Render this map instead of seeking one: the layout of another quilt")
      ->type_name("MAP.npy")
      ->group(group);
}

void add_time(CLI::App& command, Asked& asked) {
  auto& control = asked.request.control;
  const char* group = "Time";
  const auto one_of = [&](const char* name, std::string& value, std::vector<std::string> names,
                          const char* about) {
    std::string types;
    for (const auto& one : names) types += (types.empty() ? "" : "|") + one;
    command.add_option(name, value, about)
        ->type_name(types)
        ->check(CLI::IsMember(std::move(names)).description(""))
        ->default_str(value)
        ->group(group);
  };
  command
      .add_option("--control", control.rate,
                  "How fast time goes where: a number, a .npy map, an image, gradient:right|left|up|down, "
                  "depth:IMAGE, distance:MASK")
      ->type_name("MAP")
      ->group(group);
  command.add_option("--rates", asked.rates, "Rates of an image's black and white")
      ->type_name("A:B")
      ->default_str("0:1")
      ->group(group);
  command.add_option("--offset", control.offset, "How many frames later time begins where: as --control")
      ->type_name("MAP")
      ->group(group);
  command.add_option("--offsets", asked.offsets, "Offsets of an image's black and white, frames")
      ->type_name("A:B")
      ->default_str("0:30")
      ->group(group);
  one_of("--fit", control.fit, {"exact", "stretch", "centre"},
         "What becomes of maps of another size than the output");
  add_number(command, "--jitter", control.jitter, "FRAMES",
             "Shift blocks in time, smoothly, by up to so much")
      ->group(group);
  one_of("--between", control.between, {"linear", "nearest"}, "What is shown between two frames");
  one_of("--ends", control.ends, {"clamp", "loop", "ping-pong"}, "What is shown before and behind the clip");
}

void add_output_options(CLI::App& command, Asked& asked) {
  auto& request = asked.request;
  const char* group = "Output";
  command
      .add_option(
          "-o,--output", request.output,
          "A folder for clip, map, pictures and report; or the clip's name (.mp4, .avi; .png for one frame), "
          "with map.npy beside it")
      ->type_name("OUT")
      ->required()
      ->group(group);
  command.add_option("--map", request.map, "Write the map to this file instead")
      ->type_name("FILE.npy")
      ->group(group);
  command.add_option("--format", request.format, "Of the clip in a folder; mp4, or png for 16 bits")
      ->type_name("mp4|avi|png")
      ->check(CLI::IsMember({"mp4", "avi", "png"}).description(""))
      ->group(group);
  command
      .add_option_function<int>(
          "--frames", [&request](int frames) { request.frames = frames; },
          "How many; as many as the source has")
      ->type_name("N")
      ->group(group);
  command
      .add_option_function<int>(
          "--frame", [&request](int frame) { request.frame = frame; }, "Render this frame alone, from 0")
      ->type_name("N")
      ->group(group);
  command.add_flag("--resume", request.resume, "Go on from what an interrupted run has left")->group(group);
  add_number(command, "--memory", request.memory, "MB",
             "For the clip; what is beyond goes into a file beside OUT")
      ->group(group);
}

void run_asked(Asked asked, Session& session) {
  auto& request = asked.request;
  request.read = check_reading(asked.reading, session);
  request.clips = {asked.reading.clip};
  request.clips.insert(request.clips.end(), asked.others.begin(), asked.others.end());
  request.quilt.seed = session.common.seed;
  if (request.own_size) request.quilt.size = parse_size("--size", asked.size);
  if (request.own_block) request.quilt.block = parse_size("--block", asked.block);
  if (!asked.rates.empty()) parse_pair("--rates", asked.rates, request.control.slow, request.control.fast);
  if (!asked.offsets.empty())
    parse_pair("--offsets", asked.offsets, request.control.early, request.control.late);
  check_request(request);
  run_quilt(request, session);
}

}  // namespace

void add_quilt(CLI::App& app, Chosen& chosen) {
  auto* command = app.add_subcommand(
      "quilt", "Grow a time-lapse in space, and let time go differently from place to place");
  command->footer(
      "  emberfold quilt builtin:rust -o out/rust\n"
      "  emberfold quilt clouds.mp4 -o out/clouds --size 1024x1024 --block 48x96\n"
      "  emberfold quilt builtin:rust -o rust.mp4 --control gradient:right --rates 0:1\n"
      "  emberfold quilt normals.avi --apply out/rust/map.npy -o out/normals\n"
      "  emberfold quilt stone.png -o tile.png --size 1024 --tileable");
  const auto asked = std::make_shared<Asked>();
  add_reading(*command, asked->reading);
  add_output_options(*command, *asked);
  add_blocks(*command, *asked);
  add_sources(*command, *asked);
  add_time(*command, *asked);
  add_common(*command, chosen.common, "Print the content of summary.json");
  command->callback([asked, &chosen, command] {
    auto& request = asked->request;
    request.own_size = command->count("--size") > 0;
    request.own_block = command->count("--block") > 0;
    request.own_overlap = command->count("--overlap") > 0;
    request.own_apart = command->count("--apart") > 0;
    chosen.run = [asked](Session& session) { run_asked(*asked, session); };
  });
}

}  // namespace emberfold::apps
