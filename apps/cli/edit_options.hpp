// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "apps/cli/command.hpp"
#include "mcmc/simulation/edit_model.hpp"
#include "mcmc/simulation/synthesize.hpp"

namespace emberfold::apps {

/// How a motion model is changed before anything is drawn from it, and where the clip begins.
struct EditOptions {
  mcmc::MotionEdit edit;
  std::string strokes = "all", birth_map, start_name = "data";

  [[nodiscard]] mcmc::Start start() const {
    return start_name == "stationary" ? mcmc::Start::stationary : mcmc::Start::data;
  }
};

/// Adds --speed, --reverse, --intensity and others, and the rates of events to the settings (synth.births …).
void add_edit_options(CLI::App& command, Settings& settings, EditOptions& options);

/// Throws Misuse, in the options' names.
void check(EditOptions& options);

/// The model changed; what could not be had becomes warnings. Reads the picture of --birth-map: births as
/// bright as it is there, fitted to the frame. Throws core::Cancelled, core::IoError, Misuse.
mcmc::MotionModel edited(mcmc::MotionModel model, const EditOptions& options, Session& session);

nlohmann::ordered_json edit_json(const EditOptions& options);

}  // namespace emberfold::apps
