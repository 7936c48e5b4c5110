// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/stages/analysis_stages.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/held_model.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"
#include "python/src/reviews.hpp"

namespace emberfold::python {

namespace {

void bind_options(py::module_& module) {
  using Options = pipeline::AnalyzeOptions;
  OptionsClass<Options>(module, "AnalyzeOptions", "pipeline::AnalyzeOptions")
      .field("sketch", &Options::sketch)
      .field("match", &Options::match)
      .field("bottom_up", &Options::bottom_up)
      .field("curve_events", &Options::curve_events)
      .field("figures", &Options::figures)
      .field("least_probability", &Options::least_probability)
      .field("review", &Options::review)
      .field("seed", &Options::seed)
      .field("clip", &Options::clip)
      .finish();
}

/// Returns the results of a review: the answers used, and counts and rates by class, "all" last.
py::object reviewed_dict(const std::optional<pipeline::ReviewedClip>& found) {
  if (!found) return py::none();
  const auto row = [](const core::Interval& i) { return py::make_tuple(i.mean, i.low, i.high); };
  py::list counts, rates;
  for (const auto& count : found->counts) counts.append(row(count));
  for (const auto& rate : found->rates) rates.append(row(rate));
  return py::dict(py::arg("yes") = found->yes, py::arg("no") = found->no, py::arg("other") = found->other,
                  py::arg("added") = found->added, py::arg("unmatched") = found->unmatched,
                  py::arg("counts") = counts, py::arg("rates") = rates);
}

/// All that Python keeps of an analysis: a dict, which the package makes a Run of.
py::dict to_dict(pipeline::Analysis found) {
  py::dict run;
  run["events"] = event_list(found.events);
  run["all_events"] = event_list(found.all_events);
  py::list rates, stages;
  for (const auto& rate : found.rates) rates.append(py::make_tuple(rate.mean, rate.low, rate.high));
  for (const auto& stage : found.stages) stages.append(py::make_tuple(stage.name, stage.seconds));
  run["rates"] = rates;
  run["stages"] = stages;
  run["reviewed"] = reviewed_dict(found.reviewed);
  run["model"] = HeldModel(std::move(found.model));
  run["motion"] = hold(std::move(found.motion));
  return run;
}

using Keys = std::array<std::string, 3>;

/// Analyses a clip. With a folder what each stage makes is kept there, and taken from there where its key (of
/// sketch, motion and model) is the same.
py::dict analyze(const ClipData& clip, const pipeline::AnalyzeOptions& options, const py::object& progress,
                 const std::optional<std::string>& folder, const Keys& keys) {
  return to_dict(call(progress, [&](const core::Context& context) {
    std::optional<pipeline::AnalysisStages> stages;
    if (folder) stages.emplace(*folder, pipeline::StageKeys{keys[0], keys[1], keys[2]});
    return pipeline::analyze(*clip.open(), options, context, stages ? &*stages : nullptr);
  }));
}

}  // namespace

void bind_pipeline(py::module_& module) {
  bind_options(module);
  module.def("analyze", analyze, py::arg("clip"), py::arg("options") = pipeline::AnalyzeOptions{},
             py::arg("progress") = py::none(), py::arg("folder") = py::none(), py::arg("keys") = Keys{},
             doc("pipeline::analyze"));
  module.def(
      "set_quality",
      [](pipeline::AnalyzeOptions& options, const std::string& name) {
        const auto quality = pipeline::quality(name);
        if (!quality) throw py::value_error("quality is '" + name + "'; allowed is draft or normal");
        pipeline::set_quality(options, *quality);
      },
      py::arg("options"), py::arg("quality"), doc("pipeline::set_quality"));
}

}  // namespace emberfold::python
