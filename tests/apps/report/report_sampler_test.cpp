// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_sampler.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/pictures/draw.hpp"
#include "apps/report/report.hpp"
#include "core/rng.hpp"
#include "tests/apps/report/page_data.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/clip_fixture.hpp"
#include "tests/support/drawn_motion.hpp"
#include "tests/support/messages.hpp"

using namespace emberfold;
using namespace emberfold::apps;
using namespace emberfold::test;

namespace {

/// Traces that begin far away and come to rest about `level` after burn-in; `apart` moves the last chain.
mcmc::Trace made_trace(const std::string& name, int chains, int burn_in, int sweeps, double level,
                       double apart = 0) {
  mcmc::Trace trace{name, {}};
  for (int c = 0; c < chains; ++c) {
    core::Rng rng(17, {static_cast<std::uint32_t>(c)});
    trace.chains.emplace_back();
    for (int i = 0; i < burn_in + sweeps; ++i)
      trace.chains.back().push_back(level + rng.normal() + (c + 1 == chains ? apart : 0) -
                                    (i < burn_in ? 50.0 * (burn_in - i) / burn_in : 0));
  }
  return trace;
}

mcmc::SamplerRun made_result(int chains = 4, int burn_in = 40, int sweeps = 200) {
  mcmc::SamplerRun result;
  result.chains = chains, result.burn_in = burn_in;
  result.traces = {made_trace("log posterior", chains, burn_in, sweeps, -1000),
                   made_trace("a1", chains, burn_in, sweeps, 1.5)};
  result.moves = {{"birth", 3e6, 1e6}};
  return result;
}

}  // namespace

TEST_CASE("traces are diagnosed without their burn-in") {
  const auto result = made_result();
  const auto traces = diagnose_traces(result);
  REQUIRE(traces.size() == 2);
  CHECK(traces[0].name == "log posterior");
  CHECK(std::abs(traces[0].found.mean + 1000) < 0.2);
  CHECK(traces[0].found.rhat < 1.05);
  auto with_all = result;
  with_all.burn_in = 0;
  CHECK(diagnose_traces(with_all)[0].found.mean < -1003);
  with_all.burn_in = 1000;  // more than there is
  CHECK(std::isnan(diagnose_traces(with_all)[0].found.mean));
  CHECK(assurance(diagnose_traces(with_all)).sentences.empty());
  CHECK_FALSE(assurance(diagnose_traces(with_all)).sure);
}

TEST_CASE("plain sentences tell which traces are to be doubted") {
  auto result = made_result();
  const auto well = assurance(diagnose_traces(result));
  CHECK(well.sure);
  REQUIRE(well.sentences.size() == 1);
  CHECK(contains(well.sentences[0], "The chains agree: R-hat is at most 1.0"));

  result.traces.push_back(made_trace("noise", 4, 40, 200, 0, 2));
  result.traces.push_back(made_trace("patches", 4, 40, 200, 0, 5));
  const auto doubt = assurance(diagnose_traces(result));
  CHECK_FALSE(doubt.sure);
  REQUIRE(doubt.sentences.size() == 2);
  CHECK(contains(doubt.sentences[0], "above 1.05 for patches ("));
  CHECK(doubt.sentences[0].find("patches (") < doubt.sentences[0].find("noise ("));
  CHECK_FALSE(contains(doubt.sentences[0], "a1"));
  CHECK(contains(doubt.sentences[1], "fewer than 100 independent ones for "));

  // a trace that never changes is no reason to doubt
  auto still = made_result();
  still.traces.push_back({"junctions", std::vector(4, std::vector<double>(240, 7.0))});
  CHECK(assurance(diagnose_traces(still)).sure);
}

TEST_CASE("the summary has the sampler's figures") {
  auto result = made_result();
  result.traces.push_back(made_trace("noise", 4, 40, 200, 0, 2));
  result.moves = {{"switch", 1000, 250}, {"birth", 0, 0}};
  const OrderedJson json = sampler_json(result);
  CHECK(json["chains"] == 4);
  CHECK(json["sweeps"] == 200);
  CHECK(json["burn_in"] == 40);
  CHECK(json["proposals"] == 1000);
  CHECK(json["acceptance"]["switch"] == 0.25);
  CHECK(json["acceptance"]["birth"].is_null());
  CHECK(json["rhat_max_of"] == "noise");
  CHECK(json["ess_min_of"] == "noise");
  CHECK_THAT(json["rhat_max"].get<double>(), WithinRel(diagnose_traces(result)[2].found.rhat, 1e-3));
  CHECK(json["traces"].size() == 3);
  CHECK(json["traces"][1]["name"] == "a1");
}

TEST_CASE("what cannot be told of a sampler is null, not missing, and no infinity is written") {
  mcmc::SamplerRun none;
  const OrderedJson json = sampler_json(none);
  for (const char* name : {"rhat_max", "rhat_max_of", "ess_min", "ess_min_of"}) CHECK(json[name].is_null());
  CHECK(json["sweeps"] == 0);
  mcmc::SamplerRun apart;
  apart.chains = 2;
  apart.traces = {{"event", {std::vector<double>(20, 0.0), std::vector<double>(20, 1.0)}}};
  CHECK(sampler_json(apart)["rhat_max"] == 1000);
  CHECK(contains(assurance(diagnose_traces(apart)).sentences[0], "event (1000.00)"));
  CHECK(report_sampler(none, {})["traces"].empty());
}

TEST_CASE("the report carries traces of any length in bounded size") {
  const auto result = made_result(3, 5, 10);
  const OrderedJson short_one = report_sampler(result, {});
  CHECK(short_one["step"] == 1);
  REQUIRE(short_one["traces"].size() == 2);
  REQUIRE(short_one["traces"][1]["chains"].size() == 3);
  REQUIRE(short_one["traces"][1]["chains"][2].size() == 15);
  for (std::size_t i = 0; i < 15; ++i)
    CHECK_THAT(short_one["traces"][1]["chains"][2][i].get<double>(),
               WithinRel(result.traces[1].chains[2][i], 1e-3));

  auto large = made_result(8, 1000, 4000);
  for (int i = 0; i < 40; ++i) large.traces.push_back(large.traces[1]);
  const OrderedJson bounded = report_sampler(large, {});
  CHECK(bounded.dump().size() < 300'000);
  CHECK(bounded["traces_total"] == 42);
  CHECK(bounded["length"] == 5000);
  const auto step = bounded["step"].get<std::size_t>();
  CHECK(bounded["traces"][0]["chains"][0].size() == (5000 + step - 1) / step);
}

TEST_CASE("probabilities are counted by tenths and classes") {
  std::vector<graph::Event> events(6);
  const double probabilities[] = {1, 0.95, 0.9, 0.05, 0.5, 0.3};
  for (std::size_t i = 0; i < events.size(); ++i) events[i].probability = probabilities[i];
  events[4].type = graph::EventType::split;
  events[5].type = graph::EventType::disconnect;
  const OrderedJson json = report_probabilities(events);
  CHECK(json["tenths"][0] == OrderedJson({1, 0, 0, 0, 0, 0, 0, 0, 0, 3}));
  CHECK(json["tenths"][2] == OrderedJson({0, 0, 0, 0, 0, 1, 0, 0, 0, 0}));
  CHECK(json["tenths"][5][3] == 1);
  CHECK_THAT(json["expected"][0].get<double>(), WithinRel(2.9, 1e-9));
  CHECK(json["expected"][1] == 0);
}

TEST_CASE("the page has the section where there was a sampler, and no text of it becomes markup") {
  const auto motion = made_motion(made_strokes(2, 60, 60, 4), 60, 60, 4);
  const auto events = graph::stroke_events(motion);
  ReportInput input;
  input.motion = &motion;
  input.clip = "a.avi";
  const OrderedJson summary = {
      {"seed", 1}, {"options", OrderedJson::object()}, {"warnings", OrderedJson::array()}};
  CHECK_FALSE(data_of(make_report(input, summary)).contains("sampler"));

  const std::string evil = "</script><script>alert(1)</script>";
  auto result = made_result();
  result.traces.push_back(made_trace(evil, 4, 40, 200, 0, 9));
  input.sampled = &result;
  input.all_events = events;
  input.rates = {{"birth", 0.5, 0.4, 0.6, evil}};
  const std::string page = make_report(input, summary);
  CHECK_FALSE(contains(page, "alert(1)<"));
  const OrderedJson data = data_of(page);
  CHECK(data["sampler"]["table"][2]["name"] == evil);
  CHECK(data["sampler"]["rates"][0]["low"] == 0.4);
  CHECK(data["sampler"]["sure"] == false);
  std::size_t counted = 0;
  for (const auto& list : data["sampler"]["probabilities"]["tenths"])
    for (const auto& count : list) counted += count.get<std::size_t>();
  CHECK(counted == events.size());
}
