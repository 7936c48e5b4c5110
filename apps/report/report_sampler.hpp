// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/events.hpp"
#include "mcmc/sampler/diagnostics.hpp"
#include "mcmc/sampler/sampler_run.hpp"

// Writes the sampler's results as JSON of bounded size, for the summary and the report.
namespace emberfold::apps {

/// A rate with its central 90 % posterior interval.
struct RateInterval {
  std::string name;  ///< "birth"
  double rate = 0, low = 0, high = 0;
  std::string unit;  ///< "in a frame", "a frame and pair of ends"
};

/// The convergence of one traced quantity.
struct TraceDiagnosis {
  std::string name;
  mcmc::Diagnosis found;  ///< of the draws after burn-in
};
/// Diagnoses every trace of a result without its burn-in.
std::vector<TraceDiagnosis> diagnose_traces(const mcmc::SamplerRun& result);

/// The verdict on convergence, in sentences.
struct Assurance {
  bool sure = true;
  std::vector<std::string> sentences;
};
/// Names the traces with R-hat above 1.05 and those with fewer than 100 effective draws, a sentence each, the
/// worst traces first; otherwise reports convergence. Empty where no trace can be judged.
Assurance assurance(const std::vector<TraceDiagnosis>& traces);

/// Writes the object `sampler` of summary.json.
nlohmann::ordered_json sampler_json(const mcmc::SamplerRun& result);

/// Writes the report's section: traces thinned to about 20 000 numbers in all, diagnoses, sentences, rates.
nlohmann::ordered_json report_sampler(const mcmc::SamplerRun& result, std::span<const RateInterval> rates);

/// Counts the events of each class (by all_event_types) by tenths of probability, 1 in the last, and sums
/// their probabilities: {"tenths": [[…10] …6], "expected": […6]}.
nlohmann::ordered_json report_probabilities(std::span<const graph::Event> events);

}  // namespace emberfold::apps
