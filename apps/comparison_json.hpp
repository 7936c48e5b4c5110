// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/clip_measures.hpp"
#include "apps/output_folder.hpp"

// The parts of measures.json that both kinds of comparison share.
namespace emberfold::apps {

using NamedMeasures = std::vector<std::pair<std::string, const ClipMeasures*>>;

nlohmann::ordered_json begin_measures(const MeasureScale& scale);
/// The curves behind the distances: spectra, dB, and their frequencies (cycles a frame, and cycles a pixel of
/// each ring's outer edge), and autocorrelations by lag.
nlohmann::ordered_json curves_json(const NamedMeasures& clips, const MeasureScale& scale);
/// core::IoError for a clip with too few frames to compare.
void need_frames(const std::string& clip, std::int64_t frames);
void write_measures(const nlohmann::ordered_json& measures, OutputFolder& output);

/// All measures in the order in which they are told: of pixels, then of strokes.
std::vector<Measure> all_measures();

/// Key and label of what may stand in a table beside the source: models, another clip, the noise floor.
struct Held {
  std::string key, label;
};
/// Those that `measures` has distances of, in order.
std::vector<Held> held_clips(const nlohmann::ordered_json& measures);
/// The distances of one of them; null where there are none.
const nlohmann::ordered_json& distances_of(const nlohmann::ordered_json& measures, const std::string& key);

}  // namespace emberfold::apps
