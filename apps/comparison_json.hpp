// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/clip_spectra.hpp"
#include "apps/output_folder.hpp"

// The parts of measures.json that both kinds of comparison share.
namespace emberfold::apps {

using NamedSpectra = std::vector<std::pair<std::string, const ClipSpectra*>>;

nlohmann::ordered_json begin_measures(int segment, int rings);
/// The curves behind the distances, dB, and their frequencies: cycles a frame, and cycles a pixel of each
/// ring's outer edge.
nlohmann::ordered_json curves_json(const NamedSpectra& clips, int segment, int rings);
void write_measures(const nlohmann::ordered_json& measures, OutputFolder& output);

}  // namespace emberfold::apps
