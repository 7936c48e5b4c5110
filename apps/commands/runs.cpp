// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/command_line.hpp"

namespace emberfold::apps {

void add_runs(CLI::App& app, CommandLine& line) {
  auto* command = add_command(app, "runs", "Analyse many clips, compare groups of them, and benchmark", R"(
  emberfold runs batch 'clips/*.avi' -o runs --jobs 2
  emberfold runs gather runs
  emberfold runs bench-events -o out/bench)");
  command->require_subcommand(0, 1);
  add_batch(*command, line);
  add_gather(*command, line);
  add_bench_events(*command, line);
}

}  // namespace emberfold::apps
