// SPDX-License-Identifier: Apache-2.0
#include "apps/gathering/gathered_report.hpp"

#include <nlohmann/json.hpp>

#include "apps/cli/command.hpp"
#include "apps/gathering/gathering_assets.hpp"
#include "apps/report/report.hpp"
#include "apps/report/report_assets.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

std::string make_gathered_report(const std::string& folder, const Json& gathered, const std::string& table,
                                 const Json& summary) {
  Json data = gathered;
  data["table"] = table;
  std::string words;
  for (const auto& sentence : summary["words"])
    words += "<p>" + escape_html(sentence.get<std::string>()) + "</p>\n";
  const std::string style = std::string(kReportStyle) + std::string(kGatheredStyle);
  const std::string title = escape_html(folder), command = escape_html(summary.value("command_line", ""));
  return fill_in(kGatheredTemplate, {{"title", title},
                                     {"style", style},
                                     {"command", command},
                                     {"words", words},
                                     {"version", kVersion},
                                     {"data", embed_json(data)},
                                     {"script", kGatheredScript}});
}

}  // namespace emberfold::apps
