// SPDX-License-Identifier: Apache-2.0
#include "apps/report/report_sampler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include <nlohmann/json.hpp>

#include "apps/pictures/draw.hpp"
#include "core/text/format_number.hpp"
#include "core/text/join_names.hpp"

namespace emberfold::apps {

namespace {

using Json = nlohmann::ordered_json;
constexpr double kRhat = 1.05, kDraws = 100, kLargestRhat = 1000;
constexpr std::size_t kTraces = 24, kChains = 8, kPoints = 20'000, kNamed = 4;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Rounds to four digits; null for a missing number.
Json number_json(double value) {
  return std::isfinite(value) ? Json(core::round_significant(value, 4)) : Json(nullptr);
}

// Bounds R-hat, since JSON has no infinity.
double bounded_rhat(double rhat) {
  return std::min(rhat, kLargestRhat);
}

Json diagnosis_json(const TraceDiagnosis& trace) {
  const auto& d = trace.found;
  return {{"name", trace.name},
          {"mean", number_json(d.mean)},
          {"sd", number_json(d.deviation)},
          {"error", number_json(d.error)},
          {"rhat", number_json(bounded_rhat(d.rhat))},
          {"bulk_ess", number_json(d.bulk_ess)},
          {"tail_ess", number_json(d.tail_ess)}};
}

std::size_t trace_length(const mcmc::SamplerRun& result) {
  std::size_t length = 0;
  for (const auto& trace : result.traces)
    for (const auto& chain : trace.chains) length = std::max(length, chain.size());
  return length;
}

double proposals(const mcmc::SamplerRun& result) {
  double sum = 0;
  for (const auto& move : result.moves) sum += move.tried;
  return sum;
}

std::size_t kept_sweeps(const mcmc::SamplerRun& result) {
  const std::size_t length = trace_length(result);
  return length - std::min(length, static_cast<std::size_t>(std::max(0, result.burn_in)));
}

// Lists the traces for which `poor` holds, the worst first, as "name (value)".
template <class Value, class Worse, class Poor>
std::vector<std::string> list_poor_traces(std::vector<TraceDiagnosis> traces, int digits, const Value& value,
                                          const Worse& worse, const Poor& poor) {
  std::erase_if(traces, [&](const TraceDiagnosis& t) { return !poor(value(t)); });
  std::ranges::stable_sort(traces, worse, value);
  std::vector<std::string> names;
  for (const auto& t : traces) names.push_back(t.name + " (" + core::fixed_text(value(t), digits) + ")");
  return names;
}

double rhat_of(const TraceDiagnosis& t) {
  return bounded_rhat(t.found.rhat);
}
double draws_of(const TraceDiagnosis& t) {
  return t.found.bulk_ess;
}

// Keeps the traces with a finite value; it is missing where all draws are equal, or too few.
template <class Value>
std::vector<TraceDiagnosis> comparable_traces(std::vector<TraceDiagnosis> traces, const Value& value) {
  std::erase_if(traces, [&](const TraceDiagnosis& t) { return std::isnan(value(t)); });
  return traces;
}

Json trace_json(const mcmc::Trace& trace, std::size_t step) {
  Json chains = Json::array();
  for (std::size_t c = 0; c < std::min(trace.chains.size(), kChains); ++c) {
    Json line = Json::array();
    for (std::size_t i = 0; i < trace.chains[c].size(); i += step)
      line.push_back(number_json(trace.chains[c][i]));
    chains.push_back(std::move(line));
  }
  return {{"name", trace.name}, {"chains", std::move(chains)}};
}

}  // namespace

std::vector<TraceDiagnosis> diagnose_traces(const mcmc::SamplerRun& result) {
  std::vector<TraceDiagnosis> list;
  for (const auto& trace : result.traces) {
    std::vector<std::vector<double>> kept;
    for (const auto& chain : trace.chains) {
      const auto burnt = std::min(chain.size(), static_cast<std::size_t>(std::max(0, result.burn_in)));
      kept.emplace_back(chain.begin() + static_cast<std::ptrdiff_t>(burnt), chain.end());
    }
    list.push_back({trace.name, mcmc::diagnose(kept)});
  }
  return list;
}

Assurance assurance(const std::vector<TraceDiagnosis>& traces) {
  const auto with_rhat = comparable_traces(traces, rhat_of), with_draws = comparable_traces(traces, draws_of);
  if (with_rhat.empty() && with_draws.empty()) return {false, {}};
  const auto apart =
      list_poor_traces(with_rhat, 2, rhat_of, std::greater{}, [](double v) { return v > kRhat; });
  const auto few =
      list_poor_traces(with_draws, 0, draws_of, std::less{}, [](double v) { return v < kDraws; });
  Assurance result{apart.empty() && few.empty(), {}};
  if (!apart.empty())
    result.sentences.push_back("The chains do not agree well yet: R-hat is above 1.05 for " +
                               core::join_names(apart, kNamed) + ". Take what rests on these as rough.");
  if (!few.empty())
    result.sentences.push_back("The draws are worth fewer than 100 independent ones for " +
                               core::join_names(few, kNamed) +
                               ". Means and intervals of these are uncertain.");
  if (!result.sure) return result;
  double rhat = 0, draws = std::numeric_limits<double>::infinity();
  for (const auto& t : with_rhat) rhat = std::max(rhat, rhat_of(t));
  for (const auto& t : with_draws) draws = std::min(draws, draws_of(t));
  result.sentences.push_back("The chains agree: R-hat is at most " + core::fixed_text(rhat, 3) +
                             ", and the draws are worth at least " + core::fixed_text(draws, 0) +
                             " independent ones.");
  return result;
}

Json sampler_json(const mcmc::SamplerRun& result) {
  const auto traces = diagnose_traces(result);
  Json out = {{"chains", result.chains},
              {"sweeps", kept_sweeps(result)},
              {"burn_in", result.burn_in},
              {"proposals", proposals(result)}};
  out["acceptance"] = Json::object();
  for (const auto& move : result.moves)
    out["acceptance"][move.name] = number_json(move.tried > 0 ? move.accepted / move.tried : kUnknown);
  const auto worst = [&](const char* name, const auto& value, const auto& worse) {
    const auto list = comparable_traces(traces, value);
    const auto found = std::ranges::min_element(list, worse, value);
    out[name] = found == list.end() ? Json(nullptr) : number_json(value(*found));
    out[std::string(name) + "_of"] = found == list.end() ? Json(nullptr) : Json(found->name);
  };
  worst("rhat_max", rhat_of, std::greater{});
  worst("ess_min", draws_of, std::less{});
  out["traces"] = Json::array();
  for (const auto& trace : traces) out["traces"].push_back(diagnosis_json(trace));
  return out;
}

Json report_sampler(const mcmc::SamplerRun& result, std::span<const RateInterval> rates) {
  const auto diagnoses = diagnose_traces(result);
  const auto told = assurance(diagnoses);
  const std::size_t length = trace_length(result), count = std::min(result.traces.size(), kTraces);
  const std::size_t lines = count * std::min(kChains, static_cast<std::size_t>(std::max(1, result.chains)));
  const std::size_t most = std::max<std::size_t>(20, kPoints / std::max<std::size_t>(1, lines));
  const std::size_t step = length / most + 1;
  Json out = {{"chains", result.chains},
              {"burn_in", result.burn_in},
              {"length", length},
              {"step", step},
              {"proposals", proposals(result)},
              {"sure", told.sure},
              {"sentences", told.sentences},
              {"traces_total", result.traces.size()}};
  out["traces"] = Json::array();
  out["table"] = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    out["traces"].push_back(trace_json(result.traces[i], step));
    out["table"].push_back(diagnosis_json(diagnoses[i]));
  }
  out["rates"] = Json::array();
  for (const auto& rate : rates)
    out["rates"].push_back({{"name", rate.name},
                            {"rate", number_json(rate.rate)},
                            {"low", number_json(rate.low)},
                            {"high", number_json(rate.high)},
                            {"unit", rate.unit}});
  return out;
}

Json report_probabilities(std::span<const graph::Event> events) {
  std::array<std::array<std::size_t, 10>, 6> tenths{};
  std::array<double, 6> expected{};
  for (const auto& event : events) {
    const auto type = static_cast<std::size_t>(std::ranges::find(graph::all_event_types(), event.type) -
                                               graph::all_event_types().begin());
    const auto bin = static_cast<std::size_t>(std::clamp(event.probability * 10, 0.0, 9.0));
    ++tenths[type][bin];
    expected[type] += event.probability;
  }
  Json sums = Json::array();
  for (const double value : expected) sums.push_back(number_json(value));
  return {{"tenths", tenths}, {"expected", std::move(sums)}};
}

}  // namespace emberfold::apps
