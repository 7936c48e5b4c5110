// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <variant>

#include <nlohmann/json.hpp>

#include "apps/cli/command.hpp"
#include "core/clip.hpp"
#include "core/clip/masked_source.hpp"
#include "core/io/staged_output.hpp"
#include "core/option_field.hpp"
#include "graph/events/event_score.hpp"

// Parts of summary.json that the commands share.
namespace emberfold::apps {

/// Begins a summary with format, command, version and seed.
nlohmann::ordered_json begin_summary(const std::string& command, const Session& session);

/// Ends a summary with warnings, seconds and peak memory.
void end_summary(nlohmann::ordered_json& summary, const Session& session, const Stages& stages);
/// Writes summary.json.
void write_summary(io::OutputFolder& output, const nlohmann::ordered_json& summary);

/// Describes the input clip.
nlohmann::ordered_json clip_json(const std::string& clip, const core::ClipInfo& info, int frames);

/// Returns the fields of an options struct by name.
template <class Options>
nlohmann::ordered_json options_json(const Options& options) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (const auto& field : Options::fields())
    std::visit([&](const auto member) { out[field.name] = options.*member; }, field.member);
  return out;
}
nlohmann::ordered_json reading_json(const io::ReadOptions& read);

/// Writes drift.csv where --stabilize removed motion from the clip, which must have been read to its end.
void write_drift(io::OutputFolder& output, const core::FrameSource& source);

/// Returns {"four": {class: {"true", "found", "hit", "precision", "recall", "f1"}}, "six": …}
nlohmann::ordered_json score_json(const graph::Score& score);

/// Returns the score as a table for each of the two sets of classes.
std::string score_table(const graph::Score& score);

/// Returns {"mean", "min", "max", "frames"}, null where there is no value.
nlohmann::ordered_json spread_json(std::span<const double> values);

/// Writes indented JSON with a newline at the end. Bytes that are not UTF-8 are replaced.
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace emberfold::apps
