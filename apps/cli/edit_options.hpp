// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "apps/cli/command.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "mcmc/simulation/synthesize.hpp"

namespace emberfold::apps {

/// Options that change a motion model before a clip is drawn, and that choose the first frames.
struct EditOptions {
  mcmc::MotionEdit edit;
  std::string strokes = "all", birth_map, start_name = "data";

  [[nodiscard]] mcmc::Start start() const {
    return start_name == "stationary" ? mcmc::Start::stationary : mcmc::Start::data;
  }
};

/// Adds --speed, --reverse, --intensity and others, and the rates of events to the settings (synth.births …).
void add_edit_options(CLI::App& command, Settings& settings, EditOptions& options);

/// Checks the options. Throws Misuse that names the option.
void check(EditOptions& options);

/// Returns the changed model; what could not be achieved becomes warnings. Reads the picture of --birth-map,
/// fitted to the frame: births are proportional to its brightness. Throws core::Cancelled, core::IoError,
/// Misuse.
mcmc::MotionModel apply_edits(mcmc::MotionModel model, const EditOptions& options, Session& session);

nlohmann::ordered_json edit_json(const EditOptions& options);

}  // namespace emberfold::apps
