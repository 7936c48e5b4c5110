// SPDX-License-Identifier: Apache-2.0
#include "apps/command_dytex.hpp"

namespace emberfold::apps {

std::unique_ptr<ClipWriter> create_output(const std::string& path, const core::ClipInfo& info) {
  try {
    return create_clip(path, {info.width, info.height}, info.fps, info.channels == 3);
  } catch (const core::InputError& error) {
    throw Misuse("--output: " + std::string(error.what()));
  }
}

void add_texture_model(CLI::App& command, std::string& model) {
  command.add_option("MODEL", model, "The folder that 'emberfold dytex learn' wrote")
      ->required()
      ->type_name("");
}

void add_dytex(CLI::App& app, Chosen& chosen) {
  auto* command =
      app.add_subcommand("dytex", "Linear dynamic textures: learn, synthesize, foretell, look into");
  command->footer(
      "  emberfold dytex learn flag.avi -o out/flag\n"
      "  emberfold dytex synth out/flag -o flag.mp4\n"
      "  emberfold dytex info out/flag\n"
      "  emberfold dytex distance out/flag out/river\n"
      "  emberfold dytex classify clips -o out/classes\n"
      "  emberfold dytex compress out/flag -o out/small --precision f16");
  command->require_subcommand(0, 1);
  add_dytex_learn(*command, chosen);
  add_dytex_synth(*command, chosen);
  add_dytex_info(*command, chosen);
  add_dytex_forecast(*command, chosen);
  add_dytex_curve(*command, chosen);
  add_dytex_distance(*command, chosen);
  add_dytex_classify(*command, chosen);
  add_dytex_compress(*command, chosen);
  for (auto* one : command->get_subcommands([](CLI::App*) { return true; })) one->group("Commands");
}

}  // namespace emberfold::apps
