// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/clip_writer.hpp"
#include "apps/command_line.hpp"
#include "apps/texture_folder.hpp"

namespace emberfold::apps {

/// The commands under `emberfold dytex`, a file each.
void add_dytex_learn(CLI::App& dytex, Chosen& chosen);
void add_dytex_synth(CLI::App& dytex, Chosen& chosen);
void add_dytex_info(CLI::App& dytex, Chosen& chosen);
void add_dytex_forecast(CLI::App& dytex, Chosen& chosen);
void add_dytex_curve(CLI::App& dytex, Chosen& chosen);
void add_dytex_distance(CLI::App& dytex, Chosen& chosen);
void add_dytex_classify(CLI::App& dytex, Chosen& chosen);
void add_dytex_compress(CLI::App& dytex, Chosen& chosen);

/// The argument MODEL.
void add_texture_model(CLI::App& command, std::string& model);

/// A writer for the clip `path`, the value of --output; Misuse where it cannot be one.
std::unique_ptr<ClipWriter> create_output(const std::string& path, const core::ClipInfo& info);

}  // namespace emberfold::apps
