// SPDX-License-Identifier: Apache-2.0
#include "apps/runs/run_folder.hpp"

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <system_error>

#include <nlohmann/json.hpp>

#include "apps/cli/summary.hpp"
#include "core/fingerprint.hpp"
#include "core/io/clip_identity.hpp"
#include "core/io/column_folder.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;

namespace {

fs::path whole_run(const std::string& folder) {
  return fs::path(folder) / "stages" / "run";
}

std::string hash(std::initializer_list<std::string> texts) {
  core::Fingerprint sum;
  for (const auto& text : texts) sum.add(text);
  return sum.text();
}

/// Returns whether the folder still holds all files that its summary lists; an unreadable summary lists none.
bool has_all_files(const fs::path& folder) {
  std::ifstream in(folder / "summary.json");
  const auto summary = nlohmann::json::parse(in, nullptr, false);
  if (!summary.is_object() || !summary.contains("files") || !summary["files"].is_object()) return true;
  for (const auto& file : summary["files"].items()) {
    std::error_code error;
    if (!fs::exists(folder / file.key(), error)) return false;
  }
  return true;
}

}  // namespace

std::optional<RunKeys> run_keys(const std::string& clip, const std::string& review,
                                const AnalyzeOptions& options, std::uint64_t seed) {
  const std::string number = std::to_string(seed);
  const auto input = clip.starts_with("builtin:") ? clip + number : io::clip_identity(clip);
  if (input.empty()) return std::nullopt;
  const auto flags = [](std::initializer_list<bool> list) {
    std::string text;
    for (const bool flag : list) text += flag ? '1' : '0';
    return text;
  };
  RunKeys keys;
  keys.stages.sketch = hash({kVersion, input, io::clip_identity(options.read.mask),
                             reading_json(options.read).dump(), options_json(options.sketch).dump()});
  keys.stages.motion = hash({keys.stages.sketch, number, options_json(options.match).dump(),
                             flags({options.bottom_up, options.curve_events, options.figures})});
  keys.stages.model =
      hash({keys.stages.motion, std::to_string(options.least_probability), io::clip_identity(review)});
  keys.run = hash({keys.stages.model, clip, flags({options.reconstruction, options.jsonl})});
  return keys;
}

bool is_done(const std::string& folder, const std::string& key) {
  std::error_code error;
  return fs::exists(fs::path(folder) / "summary.json", error) &&
         fs::exists(fs::path(folder) / "report.html", error) &&
         io::read_columns(whole_run(folder), key).has_value() && has_all_files(folder);
}

void note_done(const std::string& folder, const std::string& key) {
  io::write_columns(whole_run(folder), {key, {}, {}});
}

void note_events(const std::string& folder) {
  io::write_columns(whole_run(folder), {"events", {}, {}});
}

void note_begun(const std::string& folder) {
  std::error_code error;
  if (fs::exists(whole_run(folder), error)) io::write_columns(whole_run(folder), {"begun", {}, {}});
}

}  // namespace emberfold::apps
