// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "dytex/estimation/em.hpp"
#include "dytex/estimation/missing_pixels.hpp"
#include "dytex/learn.hpp"

namespace emberfold::apps {

/// What `dytex learn` is asked for beyond the closed form.
struct EmAsked {
  bool em = false;
  std::string missing, filled;
  dytex::EmOptions options;
  [[nodiscard]] bool wanted() const { return em || options.noise_per_value || !missing.empty(); }
};

/// Adds --em, --missing, --filled, and the settings em.iterations, em.tolerance and em.noise_per_value.
void add_em_options(CLI::App& command, Settings& settings, EmAsked& asked);
/// Misuse where they cannot be, or not with what the closed form is asked for.
void check_em(const EmAsked& asked, const dytex::LearnOptions& learning);

/// Maximum likelihood on top of what `dytex learn` learns in closed form; nothing where it is not asked for.
class EmStage {
 public:
  /// Reads the mask, if any. `source`, `asked` and `session` must outlive it.
  EmStage(const EmAsked& asked, core::FrameSource& source, const io::ReadOptions& read, Session& session);

  /// What the closed form is to be learned from: the clip, what is hidden filled in for a beginning.
  [[nodiscard]] core::FrameSource& source() { return held_ ? *held_ : source_; }
  /// Improves the texture; notes become warnings. Throws core::Cancelled.
  void improve(dytex::LinearDynamicTexture& texture);
  /// Writes the clip with what is hidden filled in, where --filled asks for it.
  void write_filled(const dytex::LinearDynamicTexture& texture);
  /// For the summary; null where EM was not asked for.
  [[nodiscard]] const nlohmann::ordered_json& figures() const { return figures_; }

 private:
  const EmAsked& asked_;
  core::FrameSource& source_;
  Session& session_;
  dytex::Missing missing_;
  std::unique_ptr<dytex::HeldSource> held_;
  nlohmann::ordered_json figures_;
};

}  // namespace emberfold::apps
