// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/kept_motion.hpp"

#include <utility>

#include "core/io/column_folder.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "pipeline/stages/analysis_stages.hpp"

namespace emberfold::pipeline {

std::optional<graph::MotionGraph> read_kept_motion(const std::filesystem::path& run, bool weighs_strokes) {
  const auto key = io::read_column_key(run / "stages" / "motion");
  if (!key) return std::nullopt;
  auto found = AnalysisStages(run, {{}, *key, {}}).read_motion();
  if (!found) return std::nullopt;
  if (weighs_strokes) follow_strokes(found->motion, found->all_events);
  return std::move(found->motion);
}

}  // namespace emberfold::pipeline
