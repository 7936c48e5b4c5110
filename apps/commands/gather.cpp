// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <sstream>

#include <nlohmann/json.hpp>

#include "apps/cli/command_line.hpp"
#include "apps/cli/summary.hpp"
#include "apps/gathering/gathered_report.hpp"
#include "apps/gathering/gathered_runs.hpp"
#include "apps/gathering/gathered_table.hpp"
#include "apps/gathering/group_statistics.hpp"

namespace emberfold::apps {

namespace {

namespace fs = std::filesystem;

struct Gather {
  std::string runs, output, groups;
};

/// Returns the URL of a file, with every byte escaped that could have another meaning.
std::string link_to(const fs::path& file) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~/";
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string link;
  for (const char c : file.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (kPlain.find(c) != std::string_view::npos)
      link += c;
    else
      link += std::string("%") + kDigits[byte >> 4U] + kDigits[byte & 15U];
  }
  return link;
}

void run_gather(const Gather& asked, Session& session) {
  const fs::path folder = asked.output.empty() ? fs::path(asked.runs) / "gathered" : fs::path(asked.output);
  require_apart({asked.groups}, folder.string(), {"table.csv", "summary.json", "report.html"},
                session.common);
  Stages stages;
  stages.begin("gather");
  const auto gathered = gather_runs(asked.runs, asked.groups);
  const auto statistics = measure_groups(gathered.runs, session.common.seed);
  if (statistics.tests.empty() && statistics.groups.size() > 1)
    session.warn(std::to_string(statistics.groups.size()) + " groups are too many to compare every two");
  auto json = gathered_json(gathered, statistics);
  io::OutputFolder output(folder, session.common.existing());
  std::ostringstream table;
  write_gathered_table(table, gathered, statistics);
  output.write("table.csv", [&](std::ostream& out) { out << table.str(); });
  stages.end();
  auto summary = begin_summary("runs gather", session);
  summary["words"] = gathered_words(gathered, statistics);
  summary["gathered"] = json;
  summary["files"] = {{"table.csv", "a line for each clip and group, and kind of event"},
                      {"report.html", "the same to look at"}};
  end_summary(summary, session, stages);
  write_summary(output, summary);
  for (auto& run : json["runs"])
    run["link"] = link_to(fs::absolute(fs::path(asked.runs) / run["run"].get<std::string>() / "report.html")
                              .lexically_relative(fs::absolute(folder)));
  output.write("report.html", [&](std::ostream& out) {
    out << make_gathered_report(asked.runs, json, table.str(), summary);
  });
  output.commit();
  for (const auto& sentence : summary["words"]) session.console.say(sentence.get<std::string>());
  session.console.say("the table is " + (folder / "table.csv").string() + ", the report " +
                      (folder / "report.html").string());
  if (session.common.json) session.print(json_text(summary));
}

}  // namespace

void add_gather(CLI::App& runs, CommandLine& line) {
  auto* command =
      add_command(runs, "gather", "Make one table and report of many analysed clips, and compare groups", R"(
  emberfold runs gather runs
  emberfold runs gather runs -o out/gathered --groups groups.csv)");
  const auto asked = std::make_shared<Gather>();
  command->add_option("RUNS", asked->runs, "Folder of runs; those in one folder are a group")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", asked->output, "Write into this folder [RUNS/gathered]")
      ->type_name("DIR");
  command->add_option("--groups", asked->groups, "Take groups from lines RUN,GROUP of this file")
      ->type_name("FILE");
  finish_command(*command, line, asked, run_gather);
}

}  // namespace emberfold::apps
