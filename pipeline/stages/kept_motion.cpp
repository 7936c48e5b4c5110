// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/kept_motion.hpp"

#include <utility>

#include "core/io/column_folder.hpp"
#include "pipeline/inference/event_posterior.hpp"
#include "pipeline/stages/analysis_stages.hpp"

namespace emberfold::pipeline {

std::optional<graph::MotionGraph> read_kept_motion(const std::filesystem::path& run,
                                                   std::optional<double> least_probability) {
  const auto key = io::read_column_key(run / "stages" / "motion");
  if (!key) return std::nullopt;
  auto found = AnalysisStages(run, {{}, *key, {}}).read_motion();
  if (!found) return std::nullopt;
  if (least_probability) settle_graph(found->motion, found->all_events, found->cuts, *least_probability);
  return std::move(found->motion);
}

}  // namespace emberfold::pipeline
