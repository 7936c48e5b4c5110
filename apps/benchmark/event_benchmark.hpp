// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/benchmark/scene_kinds.hpp"
#include "apps/cli/command.hpp"
#include "core/io/staged_output.hpp"
#include "graph/events/event_score.hpp"

namespace emberfold::apps {

/// A program whose events are scored: FOLDER/SCENE.json for each scene.
struct BenchmarkEntry {
  std::string name;
  std::filesystem::path folder;
};

/// Options of run_benchmark().
struct BenchmarkOptions {
  std::vector<SceneKind> kinds = all_scene_kinds();
  int scenes = 1;  ///< of each kind, with consecutive seeds, 1…100
  int frames = 100;
  cv::Mat picture;         ///< the picture of `sway`; empty: a drawn one
  bool make_only = false;  ///< make the scenes, find no events
  bool bottom_up = false;  ///< emberfold reports the match unchanged
  std::vector<BenchmarkEntry> entries;
  /// Throws InputError naming field, value and range.
  void validate() const;
};

/// The score of one program on the scenes of one kind.
struct BenchmarkRow {
  std::string kind, entry;
  graph::Score score;
  int frames = 0;  ///< of all scenes of the kind
};

/// Makes the scenes, finds their events and scores them and those of the entries.
/// Writes into `output` scenes/SCENE/clip.avi and truth.json, and emberfold/SCENE.json. Networks of filaments
/// are analysed with the events of curves. Throws core::IoError for an entry that lacks a scene,
/// core::Cancelled.
std::vector<BenchmarkRow> run_benchmark(const BenchmarkOptions& options, io::OutputFolder& output,
                                        Session& session);

/// Returns the rows as one table of text: true, found and hit events, precision, recall and F1 of the four
/// classes, F1 of the six, false events per frame.
std::string benchmark_table(const std::vector<BenchmarkRow>& rows);
/// Returns the same as CSV.
std::string benchmark_csv(const std::vector<BenchmarkRow>& rows);
/// Returns {"rows": [{"kind", "entry", "frames", "false_per_frame", "four", "six"}]}.
nlohmann::ordered_json benchmark_json(const std::vector<BenchmarkRow>& rows);

}  // namespace emberfold::apps
