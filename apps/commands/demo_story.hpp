// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/commands/analysis.hpp"

namespace emberfold::apps {

/// Learns a linear dynamic texture of the clip and compares both models with the clip. Takes an analysis that
/// kept its sketch, and adds the comparison to its report and summary. Writes dytex/ and the files of
/// compare_clip(). Throws core::Cancelled.
void add_model_clips(core::FrameSource& source, const AnalyzeOptions& options, Analysis& analysis,
                     io::OutputFolder& output, Session& session);

/// Returns the table of the report from measures.json: a column for each model and one for the reference.
ReportMeasures measures_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
