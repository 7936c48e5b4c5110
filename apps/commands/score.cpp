// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "core/io/files.hpp"
#include "graph/events/review.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/review_io.hpp"

namespace emberfold::apps {

namespace {

struct Score {
  std::string truth, events;
  graph::ScoreOptions options;
};

void run_score(const Score& asked, const Session& session) {
  check_options(asked.options, "");
  auto truth_file = io::open_file(asked.truth);
  const auto truth = graph::read_truth(truth_file, asked.truth);
  auto events_file = io::open_file(asked.events);
  const auto found = graph::drop_open_events(graph::read_events(events_file, asked.events), truth);
  const auto score = graph::score_events(graph::told_events(truth), found, asked.options);
  session.print(session.common.json ? json_text(score_json(score)) : score_table(score));
}

}  // namespace

void add_score(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "score", "Score found events against true ones: precision, recall, F1", R"(
  emberfold score truth.json out/fire/events.json
  emberfold score truth.json out/fire/events.json --frames 1 --radius 10 --json
  emberfold score review.json out/fire/events.json)");
  const auto asked = std::make_shared<Score>();
  command->add_option("TRUTH", asked->truth, "Read the true events from this truth.json or review.json")
      ->required()
      ->type_name("");
  command->add_option("EVENTS", asked->events, "Read the found events from this events.json")
      ->required()
      ->type_name("");
  add_number(*command, "--frames", asked->options.frames, "N",
             "Count a true event at most this many frames away as a hit");
  add_number(*command, "--radius", asked->options.radius, "PX",
             "Count a true event at most this far away as a hit");
  finish_command(*command, line, asked, run_score);
}

}  // namespace emberfold::apps
