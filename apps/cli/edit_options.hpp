// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "apps/cli/command.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "pipeline/clip_model.hpp"

namespace emberfold::apps {

/// Options that change a motion model before a clip is drawn.
struct EditOptions {
  mcmc::MotionEdit edit;
  std::string strokes = "all", birth_map, wind;
};

/// Adds --speed, --reverse, --intensity and others, and the rates of events to the settings (synth.births …).
void add_edit_options(CLI::App& command, EditOptions& options, Settings& settings);

/// Checks the options. Throws Misuse that names the option.
void check(EditOptions& options);

/// Returns the edit, reading the picture of --birth-map: births are proportional to its brightness. Throws
/// core::IoError, Misuse.
mcmc::MotionEdit read_edit(const EditOptions& options, const mcmc::MotionModel& model);

/// Returns the changed model (pipeline::edit_model); changes that were not possible become warnings. Throws
/// core::Cancelled, core::IoError, Misuse.
pipeline::ClipModel apply_edits(pipeline::ClipModel model, const EditOptions& options, Session& session);

/// Returns the first given option that requires drawn strokes; empty if there is none.
std::string stroke_option(const EditOptions& options);
/// Returns whether any option changes the model.
bool changes(const EditOptions& options);

nlohmann::ordered_json edit_json(const EditOptions& options);

}  // namespace emberfold::apps
