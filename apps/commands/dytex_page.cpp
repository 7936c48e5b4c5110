// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/page/texture_page.hpp"
#include "core/io/files.hpp"
#include "core/io/require_apart.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;

struct Page {
  std::string model, output;
};

std::string page_text(const TexturePage& page, const std::string& output) {
  char text[160];
  std::snprintf(text, sizeof text, "; %.1f MB, frames within %.1f grey levels of the model's",
                double(page.html.size()) / 1e6, page.largest_error);
  return "the page is " + output + text;
}

void run_page(const Page& asked, Session& session) {
  io::require_apart({asked.model}, {{asked.output}});
  require_new({asked.output}, session.common);
  const io::StagedFile file(asked.output);
  Stages stages;
  stages.begin("read");
  const auto [texture, edits] = read_texture_and_edits(asked.model);
  stages.begin("make");
  const TexturePage page = make_texture_page({&texture, asked.model, edits, kVersion});
  session.check_stop();
  stages.begin("write");
  file.write([&](std::ostream& out) { out << page.html; });
  file.finish();
  stages.end();
  session.console.say(page_text(page, asked.output));
  if (!session.common.json) return;
  Json summary = begin_summary("dytex page", session);
  summary["model"] = asked.model;
  summary["output"] = asked.output;
  summary["bytes"] = page.html.size();
  summary["error"] = {{"rms", page.error}, {"largest", page.largest_error}};
  end_summary(summary, session, stages);
  session.print(json_text(summary));
}

}  // namespace

void add_dytex_page(CLI::App& dytex, CommandLine& line) {
  auto* command =
      add_command(dytex, "page", "Write an HTML page that plays a linear dynamic texture, with sliders", R"(
  emberfold dytex page out/flag -o flag.html
  emberfold dytex page out/sea -o sea.html && xdg-open sea.html)");
  const auto asked = std::make_shared<Page>();
  add_texture_model(*command, asked->model);
  command->add_option("-o,--output", asked->output, "Write this page")->type_name("FILE.html")->required();
  finish_command(*command, line, asked, run_page);
}

}  // namespace emberfold::apps
