// SPDX-License-Identifier: Apache-2.0
#include "apps/benchmark/event_benchmark.hpp"

#include <algorithm>
#include <iomanip>
#include <map>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/cli/summary.hpp"
#include "core/io/clip_writer.hpp"
#include "core/io/files.hpp"
#include "core/text/check_range.hpp"
#include "core/text/format_number.hpp"
#include "graph/io/motion_io.hpp"
#include "pipeline/analyze.hpp"

namespace emberfold::apps {

namespace {

constexpr const char* kOwn = "emberfold";

/// Events of all scenes of a kind; the frame numbers of scenes are too far apart for any tolerance.
class Pool {
 public:
  void add(std::vector<graph::Event> events, int scene) {
    constexpr int kApart = 1'000'000;  // frames
    for (graph::Event& event : events) event.frame += scene * kApart, all_.push_back(event);
  }
  [[nodiscard]] const std::vector<graph::Event>& all() const { return all_; }

 private:
  std::vector<graph::Event> all_;
};

std::string scene_name(SceneKind kind, std::uint64_t seed) {
  return std::string(name(kind)) + "_" + std::to_string(seed);
}

void write_scene(const MadeScene& scene, const std::string& where, io::OutputFolder& output,
                 const Session& session) {
  output.make_subfolder("scenes/" + where);
  core::ClipSource source(scene.clip);
  io::write_video(output.staged("scenes/" + where + "/clip.avi"), source,
                  static_cast<int>(scene.clip.frames.size()), session.context.with_progress({}));
  output.write("scenes/" + where + "/truth.json",
               [&](std::ostream& out) { graph::write_events(out, scene.truth); });
}

std::vector<graph::Event> find_own_events(const core::Clip& clip, SceneKind kind, bool bottom_up,
                                          const Session& session) {
  pipeline::AnalyzeOptions options;
  options.bottom_up = bottom_up;
  options.curve_events = kind == SceneKind::filaments;
  core::ClipSource source(clip);
  return pipeline::analyze(source, options, session.context.with_progress({})).events;
}

std::vector<graph::Event> read_entry(const BenchmarkEntry& entry, const std::string& scene) {
  const auto path = (entry.folder / (scene + ".json")).string();
  auto in = io::open_file(path);
  auto events = graph::read_events(in, path);
  std::erase_if(events, [](const graph::Event& event) { return event.probability < 0.5; });
  return events;
}

const graph::ClassScore& all_of(const std::vector<graph::ClassScore>& classes) {
  return classes.back();
}
double false_per_frame(const BenchmarkRow& row) {
  const auto& all = all_of(row.score.four);
  return static_cast<double>(all.found - all.hit) / std::max(1, row.frames);
}

}  // namespace

void BenchmarkOptions::validate() const {
  core::check_range("BenchmarkOptions.scenes", scenes, 1, 100);
  SceneOptions{1, frames, {}}.validate();
  for (const BenchmarkEntry& entry : entries)
    if (entry.name.empty() || entry.name == kOwn)
      throw core::InputError("an entry needs a name of its own, not '" + entry.name + "'");
}

std::vector<BenchmarkRow> run_benchmark(const BenchmarkOptions& options, io::OutputFolder& output,
                                        Session& session) {
  options.validate();
  std::vector<BenchmarkRow> rows;
  std::vector<std::string> names;
  if (!options.make_only) names.emplace_back(kOwn);
  for (const BenchmarkEntry& entry : options.entries) names.push_back(entry.name);
  if (!options.make_only) output.make_subfolder("emberfold");
  output.make_subfolder("scenes");
  const double all = static_cast<double>(options.kinds.size()) * options.scenes;
  double done = 0;
  for (const SceneKind kind : options.kinds) {
    Pool truth;
    std::vector<Pool> found(names.size());
    for (int k = 0; k < options.scenes; ++k) {
      session.context.report("scenes", done++ / all);
      const std::uint64_t seed = session.common.seed + static_cast<std::uint64_t>(k);
      const std::string where = scene_name(kind, seed);
      const MadeScene scene = make_scene(kind, {seed, options.frames, options.picture}, session.context);
      write_scene(scene, where, output, session);
      truth.add(scene.truth, k);
      std::size_t column = 0;
      if (!options.make_only) {
        auto events = find_own_events(scene.clip, kind, options.bottom_up, session);
        output.write("emberfold/" + where + ".json",
                     [&](std::ostream& out) { graph::write_events(out, events); });
        found[column++].add(std::move(events), k);
      }
      for (const BenchmarkEntry& entry : options.entries) found[column++].add(read_entry(entry, where), k);
    }
    for (std::size_t n = 0; n < names.size(); ++n)
      rows.push_back({std::string(name(kind)), names[n], graph::score_events(truth.all(), found[n].all()),
                      options.scenes * options.frames});
  }
  return rows;
}

std::string benchmark_table(const std::vector<BenchmarkRow>& rows) {
  std::ostringstream out;
  std::size_t wide = 8;
  for (const BenchmarkRow& row : rows) wide = std::max(wide, row.entry.size());
  const auto width = static_cast<int>(wide) + 2;
  out << std::left << std::setw(11) << "scenes" << std::setw(width) << "program" << std::right << std::setw(6)
      << "true" << std::setw(7) << "found" << std::setw(6) << "hit" << std::setw(11) << "precision"
      << std::setw(8) << "recall" << std::setw(7) << "F1" << std::setw(8) << "F1 (6)" << std::setw(15)
      << "false a frame" << '\n';
  for (const BenchmarkRow& row : rows) {
    const auto& four = all_of(row.score.four);
    const auto ratio = [&](double value) { return four.in_truth == 0 ? "-" : core::fixed_text(value, 3); };
    out << std::left << std::setw(11) << row.kind << std::setw(width) << row.entry << std::right
        << std::setw(6) << four.in_truth << std::setw(7) << four.found << std::setw(6) << four.hit
        << std::setw(11) << ratio(four.precision()) << std::setw(8) << ratio(four.recall()) << std::setw(7)
        << ratio(four.f1()) << std::setw(8) << ratio(all_of(row.score.six).f1()) << std::setw(15)
        << core::fixed_text(false_per_frame(row), 3) << '\n';
  }
  return out.str();
}

std::string benchmark_csv(const std::vector<BenchmarkRow>& rows) {
  std::string text = "kind,entry,frames,true,found,hit,precision,recall,f1,f1_six,false_per_frame\n";
  for (const BenchmarkRow& row : rows) {
    const auto& four = all_of(row.score.four);
    text += row.kind + ',' + row.entry + ',' + std::to_string(row.frames);
    for (const std::size_t count : {four.in_truth, four.found, four.hit}) text += ',' + std::to_string(count);
    for (const double value :
         {four.precision(), four.recall(), four.f1(), all_of(row.score.six).f1(), false_per_frame(row)})
      text += ',' + core::number_text(value);
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json benchmark_json(const std::vector<BenchmarkRow>& rows) {
  auto list = nlohmann::ordered_json::array();
  for (const BenchmarkRow& row : rows) {
    nlohmann::ordered_json one = {{"kind", row.kind},
                                  {"entry", row.entry},
                                  {"frames", row.frames},
                                  {"false_per_frame", core::round_to(false_per_frame(row), 6)}};
    one.update(score_json(row.score));
    list.push_back(std::move(one));
  }
  return {{"rows", std::move(list)}};
}

}  // namespace emberfold::apps
