// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/commands/analysis.hpp"

namespace emberfold::apps {

/// Learns a linear dynamic texture of the clip, compares both models with the clip, and draws edited new
/// clips: twice the splits, half the births, wind, slower, backwards. Takes an analysis that kept its sketch,
/// and adds the comparison to its report and summary. Writes dytex/, the files of compare_clip() and
/// edited_….avi. Throws core::Cancelled.
void add_model_clips(core::FrameSource& source, const AnalyzeOptions& options, Analysis& analysis,
                     io::OutputFolder& output, Session& session);

/// Returns the report's table of measures.json: a column for each model and one for the reference.
ReportMeasures measures_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
