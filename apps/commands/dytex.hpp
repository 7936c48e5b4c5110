// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "apps/textures/texture_folder.hpp"
#include "core/io/clip_writer.hpp"
#include "dytex/linear_dynamic_texture.hpp"
#include "dytex/synthesize.hpp"

namespace emberfold::apps {

/// Adds one command under `emberfold dytex`; each has its own file.
void add_dytex_learn(CLI::App& dytex, CommandLine& line);
void add_dytex_edit(CLI::App& dytex, CommandLine& line);
void add_dytex_synth(CLI::App& dytex, CommandLine& line);
void add_dytex_compose(CLI::App& dytex, CommandLine& line);
void add_dytex_page(CLI::App& dytex, CommandLine& line);
void add_dytex_info(CLI::App& dytex, CommandLine& line);
void add_dytex_forecast(CLI::App& dytex, CommandLine& line);
void add_dytex_curve(CLI::App& dytex, CommandLine& line);
void add_dytex_distance(CLI::App& dytex, CommandLine& line);
void add_dytex_classify(CLI::App& dytex, CommandLine& line);
void add_dytex_compress(CLI::App& dytex, CommandLine& line);

/// Adds the argument MODEL.
void add_texture_model(CLI::App& command, std::string& model);

/// Adds --start: "stationary", "mean", or a frame of the training clip.
CLI::Option* add_start(CLI::App& command, std::string& start);
/// Sets the start that the text names. Throws Misuse, naming the option, for other texts. `model` names the
/// texture in messages.
void set_start(dytex::SynthesisOptions& options, const std::string& start,
               const dytex::LinearDynamicTexture& texture, const std::string& model);

/// Creates the writer of --output. Throws Misuse where the name is not that of a clip.
std::unique_ptr<io::VideoWriter> create_output(const std::string& path, const core::ClipInfo& info);

}  // namespace emberfold::apps
