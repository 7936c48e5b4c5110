// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "apps/benchmark/event_benchmark.hpp"
#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"

namespace emberfold::apps {

namespace {

struct BenchEvents {
  std::string output, picture;
  std::vector<std::string> kinds, entries;
  BenchmarkOptions options;
};

BenchmarkOptions check_asked(const BenchEvents& asked) {
  BenchmarkOptions options = asked.options;
  if (!asked.kinds.empty()) options.kinds.clear();
  for (const SceneKind kind : all_scene_kinds())
    if (std::ranges::find(asked.kinds, name(kind)) != asked.kinds.end()) options.kinds.push_back(kind);
  for (const std::string& entry : asked.entries) {
    const auto sign = entry.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == entry.size())
      throw Misuse("--entry is '" + entry + "'; it is to be NAME=FOLDER");
    options.entries.push_back({entry.substr(0, sign), entry.substr(sign + 1)});
  }
  if (!asked.picture.empty()) {
    options.picture = cv::imread(asked.picture, cv::IMREAD_COLOR);
    if (options.picture.empty()) throw core::IoError(asked.picture + " cannot be read as an image");
  }
  try {
    options.validate();
  } catch (const core::InputError& error) {
    misuse(error.what(), {"scenes", "frames"}, "");
  }
  return options;
}

void run_bench_events(const BenchEvents& asked, Session& session) {
  const BenchmarkOptions options = check_asked(asked);
  std::vector<std::string> inputs{asked.picture};
  for (const BenchmarkEntry& entry : options.entries) inputs.push_back(entry.folder.string());
  require_apart(inputs, asked.output, {"scenes", "emberfold", "bench.csv", "bench.json", "summary.json"},
                session.common);
  io::OutputFolder output(asked.output, session.common.existing());
  Stages stages;
  stages.begin("scenes");
  const auto rows = run_benchmark(options, output, session);
  stages.end();
  const auto json = benchmark_json(rows);
  if (!rows.empty()) {
    output.write("bench.csv", [&](std::ostream& out) { out << benchmark_csv(rows); });
    output.write("bench.json", [&](std::ostream& out) { out << json_text(json); });
  }
  auto summary = begin_summary("runs bench-events", session);
  summary["scenes"] = options.scenes, summary["frames"] = options.frames;
  end_summary(summary, session, stages);
  write_summary(output, summary);
  output.commit();
  if (session.common.json)
    session.print(json_text(json));
  else if (!rows.empty())
    session.print(benchmark_table(rows));
}

}  // namespace

void add_bench_events(CLI::App& runs, CommandLine& line) {
  auto* command = add_command(runs, "bench-events",
                              "Make scenes whose events are known, and score programs that look for them", R"(
  emberfold runs bench-events -o out/bench
  emberfold runs bench-events -o out/bench --scenes 5 --only folds,networks
  emberfold runs bench-events -o out/bench --make-only
  emberfold runs bench-events -o out/bench --entry tracker=out/tracker)");
  const auto asked = std::make_shared<BenchEvents>();
  add_output(*command, asked->output);
  std::vector<std::string> names;
  for (const SceneKind kind : all_scene_kinds()) names.emplace_back(name(kind));
  command
      ->add_option("--only", asked->kinds,
                   "Only these: strokes, flames, folds, ripples, networks, filaments, sway")
      ->delimiter(',')
      ->type_name("KIND,...")
      ->check(CLI::IsMember(names).description(""));
  add_number(*command, "--scenes", asked->options.scenes, "N",
             "Make this number of each kind, with seeds from --seed on");
  add_number(*command, "--frames", asked->options.frames, "N", "Frames of a scene, 60 to 1000");
  command->add_option("--picture", asked->picture, "Let this image sway; unless given, a drawn one")
      ->type_name("FILE");
  command->add_option("--entry", asked->entries, "Score FOLDER/SCENE.json of another program too; may repeat")
      ->type_name("NAME=FOLDER");
  command->add_flag("--make-only", asked->options.make_only, "Find no events; score the entries, if any");
  command->add_flag("--bottom-up", asked->options.bottom_up, "Report emberfold's match unchanged");
  finish_command(*command, line, asked, run_bench_events);
}

}  // namespace emberfold::apps
