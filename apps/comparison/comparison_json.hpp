// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/cli/command.hpp"
#include "core/clip.hpp"
#include "core/io/staged_output.hpp"
#include "mcmc/learning/stroke_statistics.hpp"
#include "pipeline/clip_measures.hpp"

// The parts of measures.json that both kinds of comparison share.
namespace emberfold::apps {

using NamedMeasures = std::vector<std::pair<std::string, const pipeline::ClipMeasures*>>;

nlohmann::ordered_json begin_measures(const pipeline::MeasureScale& scale);
/// The curves behind the distances: spectra, dB, and their frequencies (cycles a frame, and cycles a pixel of
/// each ring's outer edge), and autocorrelations by lag.
nlohmann::ordered_json curves_json(const NamedMeasures& clips, const pipeline::MeasureScale& scale);
/// core::IoError for a clip with too few frames to compare.
void need_frames(const std::string& clip, std::int64_t frames);
void write_measures(const nlohmann::ordered_json& measures, io::OutputFolder& output);

/// What a clip is like: {"figures", "strokes"}, these where they were sought.
nlohmann::ordered_json own_json(const pipeline::ClipMeasures& clip,
                                const std::optional<mcmc::StrokeStatistics>& strokes);
/// Its distances from a source, too; of strokes where those of both are known.
nlohmann::ordered_json held_json(const pipeline::ClipMeasures& clip,
                                 const std::optional<mcmc::StrokeStatistics>& strokes,
                                 const pipeline::ClipMeasures& source,
                                 const std::optional<mcmc::StrokeStatistics>& of_source);
/// How far a source's halves lie apart. `strokes`: of all its frames; null where they were not sought.
nlohmann::ordered_json noise_floor_json(const pipeline::SourceMeasures& source,
                                        const mcmc::StrokeSeries* strokes);

/// A source's next frames as levels, at most so many. Throws core::Cancelled.
std::vector<cv::Mat> next_levels(core::FrameSource& source, int most, const Session& session);

/// All measures in the order in which they are told: of pixels, then of strokes.
std::vector<pipeline::Measure> all_measures();

/// Key and label of what may stand in a table beside the source: models, another clip, the noise floor.
struct Held {
  std::string key, label;
};
/// Those that `measures` has distances of, in order.
std::vector<Held> held_clips(const nlohmann::ordered_json& measures);
/// The distances of one of them; null where there are none.
const nlohmann::ordered_json& distances_of(const nlohmann::ordered_json& measures, const std::string& key);

}  // namespace emberfold::apps
