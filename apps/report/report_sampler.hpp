// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "graph/events/events.hpp"
#include "mcmc/sampler/diagnostics.hpp"
#include "mcmc/sampler/infer.hpp"

// What the summary and the report tell of the sampler, as JSON of bounded size.
namespace emberfold::apps {

/// A rate with an interval that holds it with 90 % of its probability.
struct RateInterval {
  std::string name;  ///< "birth"
  double rate = 0, low = 0, high = 0;
  std::string unit;  ///< "in a frame", "a frame and pair of ends"
};

struct TraceDiagnosis {
  std::string name;
  mcmc::Diagnosis found;  ///< of the draws after burn-in
};
std::vector<TraceDiagnosis> diagnose_traces(const mcmc::InferResult& result);

/// Plain sentences: for R-hat above 1.05 and fewer than 100 effective draws one each, naming the traces, the
/// worst first; else one that says that all is well. Empty where nothing can be told.
struct Assurance {
  bool sure = true;
  std::vector<std::string> sentences;
};
Assurance assurance(const std::vector<TraceDiagnosis>& traces);

/// The object `sampler` of summary.json (docs/architecture.md).
nlohmann::ordered_json sampler_json(const mcmc::InferResult& result);

/// What the report's section shows: traces thinned to some 20 000 numbers in all, their diagnoses, sentences,
/// rates.
nlohmann::ordered_json report_sampler(const mcmc::InferResult& result, std::span<const RateInterval> rates);

/// How many events of each class (by all_event_types) have a probability in each tenth, 1 in the last, and
/// how many of a class are expected to be true: {"tenths": [[…10] …6], "expected": […6]}.
nlohmann::ordered_json report_probabilities(std::span<const graph::Event> events);

}  // namespace emberfold::apps
