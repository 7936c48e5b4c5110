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

/// Options of `dytex learn` beyond the closed form.
struct EmRequest {
  bool em = false;
  std::string missing, filled;
  [[nodiscard]] bool is_needed() const { return em || !missing.empty(); }
};

/// Adds --em, --missing and --filled.
void add_em_options(CLI::App& command, EmRequest& asked);
/// Checks the options, also for consistency with those of the closed form. Throws Misuse.
void check_em(const EmRequest& asked, const dytex::LearnOptions& learning);

/// Improves the closed form of `dytex learn` by maximum likelihood, where the options ask for it.
class EmStage {
 public:
  /// Reads the mask of --missing, if any. `source`, `asked` and `session` must outlive it.
  EmStage(const EmRequest& asked, core::FrameSource& source, const io::ReadOptions& read, Session& session);

  /// Returns the clip from which the closed form is learned, with missing pixels interpolated.
  [[nodiscard]] core::FrameSource& source() { return held_ ? *held_ : source_; }
  /// Improves the texture by EM; notes become warnings. Throws core::Cancelled.
  void improve(dytex::LinearDynamicTexture& texture);
  /// Writes the clip with missing pixels filled in, where --filled is given.
  void write_filled(const dytex::LinearDynamicTexture& texture);
  /// Returns the figures for summary.json; null without EM.
  [[nodiscard]] const nlohmann::ordered_json& figures() const { return figures_; }

 private:
  const EmRequest& asked_;
  core::FrameSource& source_;
  Session& session_;
  dytex::Missing missing_;
  std::unique_ptr<dytex::HeldSource> held_;
  nlohmann::ordered_json figures_;
};

}  // namespace emberfold::apps
