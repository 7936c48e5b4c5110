// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include <nlohmann/json.hpp>

#include "apps/cli/summary.hpp"
#include "apps/commands/dytex.hpp"
#include "apps/textures/texture_modes.hpp"

namespace emberfold::apps {

namespace {

struct Info {
  std::string model;
};

void run_info(const Info& asked, const Session& session) {
  constexpr std::size_t kSlowest = 10;
  const auto texture = read_texture(asked.model);
  session.print(session.common.json ? json_text(texture_json(texture)) : texture_table(texture, kSlowest));
}

}  // namespace

void add_dytex_info(CLI::App& dytex, CommandLine& line) {
  auto* command = add_command(dytex, "info", "Print the modes and figures of a linear dynamic texture", R"(
  emberfold dytex info out/flag
  emberfold dytex info out/flag --json | jq .modes)");
  const auto asked = std::make_shared<Info>();
  add_texture_model(*command, asked->model);
  finish_command(*command, line, asked, run_info);
}

}  // namespace emberfold::apps
