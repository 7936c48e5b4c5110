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

/// The commands under `emberfold dytex`, a file each.
void add_dytex_learn(CLI::App& dytex, Chosen& chosen);
void add_dytex_edit(CLI::App& dytex, Chosen& chosen);
void add_dytex_synth(CLI::App& dytex, Chosen& chosen);
void add_dytex_compose(CLI::App& dytex, Chosen& chosen);
void add_dytex_page(CLI::App& dytex, Chosen& chosen);
void add_dytex_info(CLI::App& dytex, Chosen& chosen);
void add_dytex_forecast(CLI::App& dytex, Chosen& chosen);
void add_dytex_curve(CLI::App& dytex, Chosen& chosen);
void add_dytex_distance(CLI::App& dytex, Chosen& chosen);
void add_dytex_classify(CLI::App& dytex, Chosen& chosen);
void add_dytex_compress(CLI::App& dytex, Chosen& chosen);

/// The argument MODEL.
void add_texture_model(CLI::App& command, std::string& model);

/// --start, where a synthesis begins: "stationary", "mean", or a frame of the clip that was learned from.
CLI::Option* add_start(CLI::App& command, std::string& start);
/// What it asks for; Misuse, naming the option, where the text is none of these. `model` names the texture.
void set_start(dytex::SynthesisOptions& options, const std::string& start,
               const dytex::LinearDynamicTexture& texture, const std::string& model);

/// A writer for the clip `path`, the value of --output; Misuse where it cannot be one.
std::unique_ptr<io::VideoWriter> create_output(const std::string& path, const core::ClipInfo& info);

}  // namespace emberfold::apps
