// SPDX-License-Identifier: Apache-2.0
#include "apps/gathering/gathered_table.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text/format_number.hpp"

namespace emberfold::apps {

using Json = nlohmann::ordered_json;

namespace {

constexpr int kDigits = 6;

std::string cell(double value) {
  return std::isfinite(value) ? core::number_text(core::round_significant(value, kDigits)) : std::string();
}

std::string quoted_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

Json number_json(double value) {
  return std::isfinite(value) ? Json(core::round_significant(value, kDigits)) : Json(nullptr);
}

std::string joined(const std::vector<std::string>& texts, const char* between) {
  std::string all;
  for (const auto& text : texts) all += (all.empty() ? "" : between) + text;
  return all;
}

const GatheredRun* run_of(const GatheredRuns& gathered, const std::string& name) {
  const auto found = std::ranges::find(gathered.runs, name, &GatheredRun::run);
  return found == gathered.runs.end() ? nullptr : &*found;
}

std::string rounded(double value) {
  return std::isfinite(value) ? core::number_text(core::round_significant(value, 2)) : "any number";
}

std::string plural(std::size_t count, const std::string& word) {
  return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

}  // namespace

void write_gathered_table(std::ostream& out, const GatheredRuns& gathered,
                          const GroupStatistics& statistics) {
  out << "of,group,run,clip,type,count,exposure,per,rate,low,high,dispersion,frames,warnings\n";
  for (const auto& rate : statistics.rates) {
    const auto* const run = run_of(gathered, rate.run);
    out << (run != nullptr ? "clip" : "group") << ',' << quoted_cell(rate.group) << ','
        << quoted_cell(rate.run) << ',' << (run != nullptr ? quoted_cell(run->clip) : "") << ',' << rate.type
        << ',' << cell(rate.count) << ',' << cell(rate.exposure) << ',' << name(statistics.unit) << ','
        << cell(rate.rate.mean) << ',' << cell(rate.rate.low) << ',' << cell(rate.rate.high) << ','
        << (run != nullptr ? "" : cell(rate.dispersion)) << ','
        << (run != nullptr ? std::to_string(run->frames) : "") << ','
        << (run != nullptr ? quoted_cell(joined(run->warnings, "; ")) : "") << '\n';
  }
}

Json gathered_json(const GatheredRuns& gathered, const GroupStatistics& statistics) {
  Json runs = Json::array(), groups = Json::array(), tests = Json::array();
  const auto rates_of = [&](const std::string& group, const std::string& run) {
    Json rates = Json::object();
    for (const auto& rate : statistics.rates)
      if (rate.group == group && rate.run == run) {
        rates[rate.type] = {{"count", rate.count},
                            {"mean", number_json(rate.rate.mean)},
                            {"low", number_json(rate.rate.low)},
                            {"high", number_json(rate.rate.high)}};
        if (run.empty()) rates[rate.type]["dispersion"] = number_json(rate.dispersion);
      }
    return rates;
  };
  for (const auto& run : gathered.runs)
    runs.push_back({{"run", run.run},
                    {"group", run.group},
                    {"clip", run.clip},
                    {"frames", run.frames},
                    {"sure", run.sure ? Json(*run.sure) : Json(nullptr)},
                    {"rates", rates_of(run.group, run.run)},
                    {"warnings", run.warnings}});
  for (const auto& group : statistics.groups)
    groups.push_back({{"group", group},
                      {"clips", std::ranges::count(gathered.runs, group, &GatheredRun::group)},
                      {"rates", rates_of(group, "")}});
  for (const auto& test : statistics.tests)
    tests.push_back({{"first", test.first},
                     {"second", test.second},
                     {"type", test.type},
                     {"ratio", number_json(test.found.ratio.mean)},
                     {"low", number_json(test.found.ratio.low)},
                     {"high", number_json(test.found.ratio.high)},
                     {"p", number_json(test.found.p)},
                     {"test", test.found.permuted ? "permutation of clips" : "counts of independent events"},
                     {"dispersion", number_json(test.found.dispersion)}});
  return {{"level", 0.9},
          {"per", name(statistics.unit)},
          {"runs", std::move(runs)},
          {"groups", std::move(groups)},
          {"tests", std::move(tests)},
          {"failed", gathered.failed}};
}

std::vector<std::string> gathered_words(const GatheredRuns& gathered, const GroupStatistics& statistics) {
  std::vector<std::string> words;
  double events = 0;
  for (const auto& run : gathered.runs) events += run.counts.contains("all") ? run.counts.at("all") : 0;
  words.push_back(
      plural(static_cast<std::size_t>(events), "event") + " in " + plural(gathered.runs.size(), "clip") +
      (statistics.groups.size() > 1 ? " of " + plural(statistics.groups.size(), "group") : "") + ".");
  std::vector<const GatheredTest*> apart;
  for (const auto& test : statistics.tests)
    if (test.found.p < 0.05) apart.push_back(&test);
  std::ranges::stable_sort(apart, {}, [](const GatheredTest* test) { return test->found.p; });
  constexpr std::size_t kTold = 8;
  for (std::size_t i = 0; i < std::min(kTold, apart.size()); ++i) {
    const auto& test = *apart[i];
    const auto& ratio = test.found.ratio;
    words.push_back(
        (test.type == "all" ? std::string("Events of all kinds") : "Events of the kind " + test.type) +
        " are " + rounded(ratio.mean) + " times as frequent in " + test.second + " as in " + test.first +
        " (90 % interval " + rounded(ratio.low) + " to " + rounded(ratio.high) +
        ", p = " + rounded(test.found.p) + ").");
  }
  if (!statistics.tests.empty() && apart.empty()) words.emplace_back("No two groups differ at p < 0.05.");
  if (apart.size() > 1)
    words.push_back("Of " + std::to_string(statistics.tests.size()) +
                    " tests one in twenty has p < 0.05 by chance alone.");
  if (std::ranges::any_of(statistics.tests, [](const auto& test) { return !test.found.permuted; }))
    words.emplace_back(
        "Some groups are too small for a test that allows for differences between clips: their p is "
        "of independent events, and too small where clips of one group differ.");
  const auto warned =
      std::ranges::count_if(gathered.runs, [](const auto& run) { return !run.warnings.empty(); });
  if (warned > 0)
    words.push_back(plural(static_cast<std::size_t>(warned), "clip") + " came with warnings, below.");
  if (!gathered.failed.empty())
    words.push_back(plural(gathered.failed.size(), "clip") + " failed and are not among them.");
  return words;
}

}  // namespace emberfold::apps
