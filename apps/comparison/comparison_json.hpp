// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/io/staged_output.hpp"
#include "pipeline/compare.hpp"
#include "pipeline/comparison/clip_measures.hpp"

// The parts of measures.json ("emberfold.measures", version 2).
namespace emberfold::apps {

/// Begins measures.json: its format and the lengths of its curves.
nlohmann::ordered_json begin_measures(const pipeline::MeasureScale& scale);

using NamedCurves = std::vector<std::pair<std::string, const pipeline::MeasureCurves*>>;

/// Lists the curves of clips by name: spectra, dB, with their frequencies (cycles per frame, and cycles per
/// pixel at each ring's outer edge), and autocorrelations by lag.
nlohmann::ordered_json curves_json(const NamedCurves& clips, const pipeline::MeasureScale& scale);

/// Returns a rounded measure, three decimals; null where there is none.
nlohmann::ordered_json rounded_or_null(const std::optional<double>& value);

/// Describes one clip: {"figures", "strokes"}, the latter where strokes were sought.
nlohmann::ordered_json profile_json(const pipeline::ClipProfile& profile);

/// Lists distances by the keys of all_measures(), with "inside", the stroke figures within the reference's
/// intervals, and "visible", pipeline::VisibleFigures.
nlohmann::ordered_json distances_json(const pipeline::ClipDistances& distances);

/// Lists the quality of each method's predictions, by steps and by frames.
nlohmann::ordered_json prediction_json(const pipeline::PredictionMeasures& prediction);

/// Lists the quality of each model's reconstruction of a given frame.
nlohmann::ordered_json reconstruction_json(const pipeline::PredictionMeasures& prediction);

void write_measures(const nlohmann::ordered_json& measures, io::OutputFolder& output);

/// Returns all measures in the order of tables and reports: pixels, then strokes.
std::vector<pipeline::MeasureDescription> all_measures();

/// Names a column of a table of distances: a model, another clip, or the noise floor.
struct DistanceColumn {
  std::string key, label;
};
/// Returns the columns for which `measures` has distances, in order.
std::vector<DistanceColumn> distance_columns(const nlohmann::ordered_json& measures);
/// Returns the distances of one column; null where there are none.
const nlohmann::ordered_json& distances_of(const nlohmann::ordered_json& measures, const std::string& key);

}  // namespace emberfold::apps
