// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <utility>

#include <pybind11/stl.h>

#include "pipeline/compare.hpp"
#include "pipeline/comparison/clip_measures.hpp"
#include "pipeline/comparison/clip_strokes.hpp"
#include "pipeline/comparison/visible_measures.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using pipeline::ClipDistances;

/// Distances by the key of their measure; None where one could not be measured.
py::dict distances(const ClipDistances& found) {
  const auto& p = found.pixels;
  const std::array pixels{
      p.temporal_db, p.radial_db, p.autocorrelation, p.patterns, p.flow_px, p.crease_sharpness, p.si, p.ti};
  py::dict all;
  std::size_t i = 0;
  for (const auto& measure : pipeline::pixel_measures()) all[measure.key] = pixels.at(i++);
  if (found.strokes) {
    const auto& s = *found.strokes;
    const std::array<std::optional<double>, 3> strokes{s.event_rates, s.lifetime, s.length};
    i = 0;
    for (const auto& measure : pipeline::stroke_measures()) all[measure.key] = strokes.at(i++);
  }
  return all;
}

/// Returns the visible figures of a drawn clip, by key; None where no clip was drawn.
py::object visible(const ClipDistances& found) {
  if (!found.visible) return py::none();
  const auto& v = *found.visible;
  const std::array figures{v.complete, v.coherent, v.flow, v.variance, v.difference, v.copied};
  py::dict all;
  std::size_t i = 0;
  for (const auto& measure : pipeline::visible_measures()) all[measure.key] = figures.at(i++);
  all["moves_alike"] = v.moves_alike();
  all["apart"] = v.apart();
  return all;
}

using Measures = std::span<const pipeline::MeasureDescription>;

py::list measure_list(std::initializer_list<Measures> lists) {
  py::list all;
  for (const auto& list : lists)
    for (const auto& m : list) all.append(py::make_tuple(m.key, m.name, m.unit, m.about));
  return all;
}

py::dict compare(const ClipData& a, const ClipData& b, const pipeline::CompareOptions& options,
                 const py::object& progress) {
  const auto found = call(progress, [&](const core::Context& context) {
    return pipeline::compare(*a.open(), *b.open(), options, context);
  });
  py::dict result;
  result["distances"] = distances(found.distances);
  result["noise_floor"] = distances(found.noise_floor);
  result["visible"] = visible(found.distances);
  result["psnr"] = found.psnr;
  result["ssim"] = found.ssim;
  result["no_psnr_reason"] = found.no_psnr_reason;
  result["frames"] = py::make_tuple(found.frames_a, found.frames_b);
  return result;
}

py::list predictions(const pipeline::PredictionMeasures& measured) {
  py::list rows;
  for (const auto& method : measured.methods)
    for (std::size_t i = 0; i < method.by_step.size(); ++i)
      if (const auto& quality = method.by_step[i])
        rows.append(py::make_tuple(method.key, measured.steps[i], quality->psnr, quality->ssim));
  return rows;
}

py::dict compare_models(const ClipData& clip, const pipeline::CompareOptions& options, std::uint64_t seed,
                        const py::object& progress) {
  const auto found = call(progress, [&](const core::Context& context) {
    return pipeline::compare_models(*clip.open(), options, {}, seed, context);
  });
  py::dict result, models, seen, parameters;
  for (const auto& model : found.models) {
    const py::str label(model.label);
    models[label] = distances(model.distances);
    seen[label] = visible(model.distances);
    parameters[label] = model.parameters;
  }
  result["models"] = models;
  result["visible"] = seen;
  result["parameters"] = parameters;
  result["noise_floor"] = distances(found.noise_floor);
  result["predictions"] = found.prediction ? predictions(*found.prediction) : py::list();
  result["frames"] = found.frames;
  result["learned_frames"] = found.learned_frames;
  return result;
}

}  // namespace

void bind_compare(py::module_& module) {
  using Options = pipeline::CompareOptions;
  OptionsClass<Options>(module, "CompareOptions", "pipeline::CompareOptions")
      .field("sketch", &Options::sketch)
      .field("match", &Options::match)
      .field("learn", &Options::learn)
      .described_fields()
      .finish();
  module.attr("MEASURES") =
      py::tuple(measure_list({pipeline::pixel_measures(), pipeline::stroke_measures()}));
  module.attr("VISIBLE_MEASURES") = py::tuple(measure_list({pipeline::visible_measures()}));
  module.def("compare", compare, py::arg("a"), py::arg("b"), py::arg("options") = Options{},
             py::arg("progress") = py::none(), doc("pipeline::compare"));
  module.def("compare_models", compare_models, py::arg("clip"), py::arg("options") = Options{},
             py::arg("seed") = 1, py::arg("progress") = py::none(), doc("pipeline::compare_models"));
}

}  // namespace emberfold::python
