// SPDX-License-Identifier: Apache-2.0
#include "apps/gathering/gathered_runs.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/batch/batch_manifest.hpp"
#include "core/error.hpp"
#include "core/io/files.hpp"

namespace emberfold::apps {

namespace fs = std::filesystem;
using Summary = nlohmann::json;

namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 28;

Summary read_summary(const fs::path& path) {
  std::error_code error;
  if (fs::file_size(path, error) > kMostBytes)
    throw core::IoError(path.string() + " is too large for a summary");
  auto in = io::open_file(path);
  Summary value = Summary::parse(in, nullptr, false);
  if (!value.is_object()) throw core::IoError(path.string() + " is no summary: it is cut off or no JSON");
  return value;
}

std::optional<double> number(const Summary& holder, const char* key) {
  const auto found = holder.find(key);
  return found != holder.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

GatheredRun read_run(const Summary& summary, const fs::path& path) {
  GatheredRun run;
  try {
    run.clip = summary.at("clip").at("name").get<std::string>();
    run.frames = summary.at("clip").at("frames").get<int>();
    const auto& rates = summary.at("rates");
    const auto& counted = rates.at("counted_in");
    run.counted_frames = counted.at("frames").get<double>();
    run.seconds = number(counted, "s");
    run.area_seconds = number(counted, "s_mm2");
    for (const auto& [name, rate] : rates.at("classes").items())
      run.counts[name] = rate.at("count").get<double>();
    run.sure = number(summary.at("events"), "sure");
    for (const auto& warning : summary.at("warnings")) run.warnings.push_back(warning.get<std::string>());
  } catch (const Summary::exception&) {
    throw core::IoError(path.string() +
                        " lacks figures that are gathered: an older version wrote it; analyze again");
  }
  return run;
}

/// Finds the folders with an analysis. Folders below one belong to it.
void find_runs(const fs::path& folder, std::vector<fs::path>& found, int depth = 0) {
  constexpr int kDeepest = 12;
  std::error_code error;
  if (depth > 0 && fs::is_regular_file(folder / "summary.json", error)) {
    found.push_back(folder);
    return;
  }
  if (depth == kDeepest) return;
  std::vector<fs::path> inner;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.is_directory(error) && !entry.path().filename().string().starts_with('.'))
      inner.push_back(entry.path());
  std::ranges::sort(inner);
  for (const auto& path : inner) find_runs(path, found, depth + 1);
}

std::string trimmed(std::string text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '"'; };
  while (!text.empty() && is_space(text.back())) text.pop_back();
  const auto first = std::ranges::find_if_not(text, is_space);
  return {first, text.end()};
}

/// Reads lines "run,group" after a header.
std::map<std::string, std::string> read_groups(const std::string& file) {
  auto in = io::open_file(file);
  std::map<std::string, std::string> groups;
  std::string line;
  std::getline(in, line);
  for (int number = 2; std::getline(in, line); ++number) {
    if (trimmed(line).empty()) continue;
    const auto comma = line.rfind(',');
    if (comma == std::string::npos || trimmed(line.substr(comma + 1)).empty())
      throw core::IoError(file + ", line " + std::to_string(number) + ": it has to be RUN,GROUP");
    groups[trimmed(line.substr(0, comma))] = trimmed(line.substr(comma + 1));
  }
  return groups;
}

void assign_groups(std::vector<GatheredRun>& runs, const std::string& file) {
  if (file.empty()) return;
  auto groups = read_groups(file);
  std::set<std::string> used;
  for (auto& run : runs)
    if (const auto found = groups.find(run.run); found != groups.end())
      run.group = found->second, used.insert(found->first);
  for (const auto& [name, group] : groups)
    if (!used.contains(name))
      throw core::IoError(
          std::string(file).append(" names the run ").append(name).append(", which is not there"));
}

}  // namespace

GatheredRuns gather_runs(const fs::path& folder, const std::string& groups) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw core::IoError(folder.string() + " is no folder");
  GatheredRuns gathered;
  std::vector<fs::path> found;
  find_runs(folder, found);
  for (const auto& path : found) {
    const Summary summary = read_summary(path / "summary.json");
    if (summary.value("format", "") != "emberfold.summary" || summary.value("command", "") != "analyze")
      continue;
    GatheredRun run = read_run(summary, path / "summary.json");
    const fs::path below = path.lexically_relative(folder);
    run.run = below.string();
    run.group = below.has_parent_path() ? below.parent_path().string() : "all";
    gathered.runs.push_back(std::move(run));
  }
  if (gathered.runs.empty())
    throw core::IoError(folder.string() + " holds no run: no folder below it has a summary.json of analyze");
  assign_groups(gathered.runs, groups);
  for (const auto& entry : read_manifest(folder))
    if (entry.state == "failed") gathered.failed.push_back(entry.run + ": " + entry.message);
  return gathered;
}

}  // namespace emberfold::apps
