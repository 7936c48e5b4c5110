// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "apps/commands/analysis.hpp"

namespace emberfold::apps {

/// Goes on from an analysis that kept its sketch: learns a linear dynamic texture of the clip, holds both
/// models against it, and adds to report and summary what came of it. Writes dytex/ and the files of
/// compare_clip(). Throws core::Cancelled.
void tell_story(core::FrameSource& source, const AnalyzeOptions& options, Analysis& analysis,
                io::OutputFolder& output, Session& session);

/// The table of the report: a comparison's measures.json, a column for each model and one for what they are
/// held against.
ReportMeasures measures_table(const nlohmann::ordered_json& measures);

}  // namespace emberfold::apps
