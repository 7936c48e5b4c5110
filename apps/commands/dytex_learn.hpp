// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/commands/dytex_em.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "dytex/learn.hpp"

namespace emberfold::apps {

class MpiJob;

/// Request of `dytex learn`.
struct TextureLearning {
  Reading reading;
  std::string output, mask;
  dytex::LearnOptions options;
  bool asked_components = false, asked_energy = false, asked_order = false;
  double energy = 0.95;
  EmRequest em;
  int block = 0;  ///< frames decomposed at a time; 0: all, or a size that suits a long clip
  std::string order, channels = "joint", method = "closed-form", stable = "yule-walker", noise = "normal";
};

/// Checks the options and parses the textual ones into `options`. Throws Misuse.
io::ReadOptions check_learning(TextureLearning& asked, const Session& session);
/// Reduces the default number of components for a short clip. Throws IoError for a clip of one frame, Misuse
/// where more are requested than possible.
void fit_to_length(TextureLearning& asked, const core::ClipInfo& info, const Session& session);
/// Rewrites the message of a learning InputError for the user.
std::string learning_message(const TextureLearning& asked, const std::string& message);

/// Writes components.png.
void write_components(io::OutputFolder& output, const dytex::LinearDynamicTexture& texture);
nlohmann::ordered_json learn_summary(const TextureLearning& asked, const io::ReadOptions& read,
                                     const core::ClipInfo& info, const dytex::LearnResult& learned,
                                     const Session& session);
/// Reports what was learned.
void say_learned(const TextureLearning& asked, const dytex::LinearDynamicTexture& texture,
                 const Session& session);

/// Runs the command on the ranks of a job, or on this process alone (`job` null), by stripes of the frames.
void learn_on_ranks(const TextureLearning& asked, Session& session, MpiJob* job);

}  // namespace emberfold::apps
