// SPDX-License-Identifier: Apache-2.0
#include "apps/commands/dytex.hpp"

namespace emberfold::apps {

CLI::Option* add_start(CLI::App& command, std::string& start) {
  return command.add_option("--start", start, "Start at a random state, the mean frame or a learned frame")
      ->type_name("stationary|mean|N")
      ->default_str(start);
}

void set_start(dytex::SynthesisOptions& options, const std::string& start,
               const dytex::LinearDynamicTexture& texture, const std::string& model) {
  if (start == "stationary") return;
  if (start == "mean") {
    options.from_mean = true;
    return;
  }
  const auto last = texture.states.cols() - 1;
  const auto refuse = [&] {
    throw Misuse("--start is " + one_line(start) +
                 "; allowed is stationary, mean, or a frame of the clip that " + model +
                 " was learned from, 0 to " + std::to_string(last));
  };
  int frame = 0;
  try {
    parse_number("--start", start, frame);
  } catch (const Misuse&) {
    refuse();
  }
  if (frame < 0 || frame > last) refuse();
  options.first_frame = frame;
}

std::unique_ptr<io::VideoWriter> create_output(const std::string& path, const core::ClipInfo& info) {
  try {
    return io::create_video(path, {info.width, info.height}, info.fps, info.channels == 3);
  } catch (const core::InputError& error) {
    throw Misuse("--output: " + std::string(error.what()));
  }
}

void add_texture_model(CLI::App& command, std::string& model) {
  command.add_option("MODEL", model, "Read the model from this folder of 'dytex learn'")
      ->required()
      ->type_name("");
}

void add_dytex(CLI::App& app, CommandLine& line) {
  auto* command =
      add_command(app, "dytex", "Learn, edit, draw, forecast and compare linear dynamic textures", R"(
  emberfold dytex learn flag.avi -o out/flag
  emberfold dytex edit out/flag -o out/storm --speed 1.5 --intensity 2
  emberfold dytex synth out/storm -o storm.mp4
  emberfold dytex info out/flag
  emberfold dytex page out/flag -o flag.html)");
  command->require_subcommand(0, 1);
  add_dytex_learn(*command, line);
  add_dytex_edit(*command, line);
  add_dytex_synth(*command, line);
  add_dytex_compose(*command, line);
  add_dytex_page(*command, line);
  add_dytex_info(*command, line);
  add_dytex_forecast(*command, line);
  add_dytex_curve(*command, line);
  add_dytex_distance(*command, line);
  add_dytex_classify(*command, line);
  add_dytex_compress(*command, line);
}

}  // namespace emberfold::apps
