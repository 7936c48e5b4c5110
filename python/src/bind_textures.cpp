// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "core/error.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/distances/window_spectra.hpp"
#include "dytex/estimation/em.hpp"
#include "dytex/estimation/forecast.hpp"
#include "dytex/estimation/observations.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/learning_curve.hpp"
#include "dytex/model/layers.hpp"
#include "dytex/synthesize.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/options.hpp"

// Binds linear dynamic textures, except for learning, editing and drawing them.
namespace emberfold::python {

namespace {

using Texture = dytex::LinearDynamicTexture;
using MaybeClip = std::optional<ClipData>;

dytex::Missing missing_of(const MaybeClip& mask, const core::ClipInfo& info, const core::Context& context) {
  if (!mask) return {};
  const auto source = mask->open();
  return {*source, info, context};
}

py::dict em_dict(dytex::EmResult found) {
  py::dict result;
  result["log_likelihood"] = found.log_likelihood;
  result["converged"] = found.converged;
  result["likelihood_r"] = found.likelihood_r;
  result["passes"] = found.passes;
  result["notes"] = found.notes;
  result["texture"] = std::move(found.texture);
  return result;
}

py::dict maximise_likelihood(const ClipData& clip, const Texture& start, const dytex::EmOptions& options,
                             const MaybeClip& missing, const py::object& progress) {
  return em_dict(call(progress, [&](const core::Context& context) {
    const auto hidden = missing_of(missing, clip.info(), context);
    return dytex::maximise_likelihood(*clip.open(), start, options, hidden, context);
  }));
}

py::dict learn_missing(const ClipData& clip, const ClipData& missing, const dytex::LearnOptions& learning,
                       const dytex::EmOptions& options, const py::object& progress) {
  return em_dict(call(progress, [&](const core::Context& context) {
    const auto hidden = missing_of(missing, clip.info(), context);
    return dytex::learn_missing(*clip.open(), hidden, learning, options, context);
  }));
}

/// Frames 1 … steps after those of `clip`, or after those that the texture was learned from.
py::tuple forecast(const Texture& texture, int steps, const MaybeClip& clip, const py::object& progress) {
  const auto found = call(progress, [&](const core::Context& context) {
    const auto from =
        clip ? dytex::last_state(dytex::filter(dytex::state_space(texture),
                                               dytex::observe(texture, *clip->open(), {}, context)))
             : dytex::last_training_state(texture);
    auto ahead = dytex::forecast(texture, from, steps);
    std::vector<cv::Mat> frames;
    for (Eigen::Index k = 0; k < ahead.states.cols(); ++k)
      frames.push_back(dytex::draw(texture, ahead.states.col(k)));
    return std::pair(std::move(frames), std::move(ahead));
  });
  return py::make_tuple(to_array(found.first), found.second.states, found.second.error);
}

py::dict learning_curve(const ClipData& clip, const dytex::CurveOptions& options,
                        const py::object& progress) {
  const auto curve = call(progress, [&](const core::Context& context) {
    return dytex::learning_curve(*clip.open(), options, context);
  });
  py::list points;
  for (const auto& point : curve.points)
    points.append(py::make_tuple(point.length, point.error, point.spread, point.left_out));
  py::dict result;
  result["points"] = points;
  result["targets"] = curve.targets;
  result["plateau"] = curve.plateau;
  result["critical"] = curve.critical;
  result["frame_before"] = curve.frame_before;
  return result;
}

/// Square matrices of the distances of all pairs, by the name of their measure.
py::dict distance_matrices(const std::vector<Texture>& textures, const py::object& progress) {
  const auto pairs =
      call(progress, [&](const core::Context& context) { return dytex::all_distances(textures, context); });
  py::dict matrices;
  for (const auto measure : dytex::kMeasures) {
    matrices[dytex::name(measure)] = dytex::distance_matrix(pairs, measure);
  }
  return matrices;
}

void bind_learning(py::module_& module) {
  using Em = dytex::EmOptions;
  OptionsClass<Em>(module, "EmOptions", "dytex::EmOptions")
      .field("iterations", &Em::iterations)
      .field("tolerance", &Em::tolerance)
      .field("noise_per_value", &Em::noise_per_value)
      .field("least_noise", &Em::least_noise)
      .field("memory", &Em::memory)
      .finish();
  using Curve = dytex::CurveOptions;
  OptionsClass<Curve>(module, "CurveOptions", "dytex::CurveOptions")
      .field("components", &Curve::components)
      .field("lengths", &Curve::lengths)
      .field("targets", &Curve::targets)
      .field("longest", &Curve::longest)
      .field("tolerance", &Curve::tolerance)
      .field("memory", &Curve::memory)
      .finish();
  module.def("maximise_likelihood", maximise_likelihood, py::arg("clip"), py::arg("start"),
             py::arg("options") = Em{}, py::arg("missing") = py::none(), py::arg("progress") = py::none(),
             doc("dytex::maximise_likelihood"));
  module.def("learn_missing", learn_missing, py::arg("clip"), py::arg("missing"),
             py::arg("learning") = dytex::LearnOptions{}, py::arg("options") = Em{},
             py::arg("progress") = py::none(), doc("dytex::learn_missing"));
  module.def("forecast", forecast, py::arg("texture"), py::arg("steps"), py::arg("clip") = py::none(),
             py::arg("progress") = py::none(), doc("dytex::forecast"));
  module.def("learning_curve", learning_curve, py::arg("clip"), py::arg("options") = Curve{},
             py::arg("progress") = py::none(), doc("dytex::learning_curve"));
}

void bind_distances(py::module_& module) {
  module.def(
      "window_spectrum_of_model", [](const Texture& texture) { return dytex::window_spectrum(texture); },
      py::arg("texture"), py::call_guard<py::gil_scoped_release>(), doc("dytex::WindowSpectrum"));
  module.def(
      "window_spectrum",
      [](const ClipData& clip, const py::object& progress) {
        return call(progress, [&](const core::Context& context) {
          return dytex::window_spectrum(*clip.open(), context);
        });
      },
      py::arg("clip"), py::arg("progress") = py::none(), doc("dytex::WindowSpectrum"));
  module.def(
      "window_distance",
      [](const Eigen::VectorXd& p, const Eigen::VectorXd& q) { return dytex::window_distance(p, q); },
      py::arg("p"), py::arg("q"), doc("dytex::window_distance"));
  module.def("distance_matrices", distance_matrices, py::arg("textures"), py::arg("progress") = py::none(),
             doc("dytex::all_distances"));
}

void bind_regions(py::module_& module) {
  module.def(
      "learn_region",
      [](const ClipData& clip, const py::array& mask, const dytex::LearnOptions& options,
         const py::object& progress) {
        const cv::Mat region = to_mask(mask, "mask");
        return call(progress, [&](const core::Context& context) {
          const auto source = clip.open();
          dytex::RegionSource part(*source, region);
          auto texture = dytex::learn(part, options, context).texture;
          dytex::confine(texture, region);
          return texture;
        });
      },
      py::arg("clip"), py::arg("mask"), py::arg("options") = dytex::LearnOptions{},
      py::arg("progress") = py::none(), doc("dytex::confine"));
}

}  // namespace

void bind_textures(py::module_& module) {
  bind_learning(module);
  bind_distances(module);
  bind_regions(module);
}

}  // namespace emberfold::python
