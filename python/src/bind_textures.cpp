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
#include "dytex/baselines/star.hpp"
#include "dytex/distances/distances.hpp"
#include "dytex/distances/window_spectra.hpp"
#include "dytex/estimation/em.hpp"
#include "dytex/estimation/forecast.hpp"
#include "dytex/estimation/observations.hpp"
#include "dytex/learn.hpp"
#include "dytex/learning/learning_curve.hpp"
#include "dytex/model/compression.hpp"
#include "dytex/model/layers.hpp"
#include "dytex/synthesize.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/options.hpp"

// What there is of linear dynamic textures beside learning, editing and drawing them.
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
py::dict distance_matrices(const std::vector<Texture>& textures, const dytex::BinetCauchyOptions& options,
                           const py::object& progress) {
  const auto pairs = call(progress, [&](const core::Context& context) {
    return dytex::all_distances(textures, options, context);
  });
  py::dict matrices;
  for (const auto measure : dytex::kMeasures) {
    matrices[dytex::name(measure)] = dytex::distance_matrix(pairs, measure);
  }
  return matrices;
}

dytex::Precision precision(const std::string& name) {
  if (const auto found = dytex::precision_of(name)) return *found;
  throw py::value_error("precision is '" + name + "'; allowed is f32, f16 or u8");
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
  using Kernel = dytex::BinetCauchyOptions;
  OptionsClass<Kernel>(module, "BinetCauchyOptions", "dytex::BinetCauchyOptions")
      .field("discount", &Kernel::discount)
      .field("first_frame", &Kernel::first_frame)
      .finish();
  module.def("binet_cauchy", &dytex::binet_cauchy, py::arg("p"), py::arg("q"), py::arg("options") = Kernel{},
             py::call_guard<py::gil_scoped_release>(), doc("dytex::binet_cauchy"));
  module.def(
      "kl_growth",
      [](const Texture& p, const Texture& q, int length, const py::object& progress) {
        return call(progress,
                    [&](const core::Context& context) { return dytex::kl_growth(p, q, length, context); });
      },
      py::arg("p"), py::arg("q"), py::arg("length"), py::arg("progress") = py::none(),
      doc("dytex::kl_growth"));
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
  module.def("distance_matrices", distance_matrices, py::arg("textures"), py::arg("options") = Kernel{},
             py::arg("progress") = py::none(), doc("dytex::all_distances"));
}

void bind_compression(py::module_& module) {
  module.def(
      "rounded",
      [](const Texture& texture, const std::string& to) { return dytex::rounded(texture, precision(to)); },
      py::arg("texture"), py::arg("precision"), doc("dytex::rounded"));
  module.def(
      "stored_bytes",
      [](const Texture& texture, std::optional<Eigen::Index> components, const std::string& to) {
        return dytex::stored_bytes(texture, components.value_or(texture.components()), precision(to));
      },
      py::arg("texture"), py::arg("components") = py::none(), py::arg("precision") = "f32",
      doc("dytex::stored_bytes"));
  module.def(
      "projection_errors",
      [](const Texture& texture, const std::string& to) {
        return dytex::projection_errors(texture, precision(to));
      },
      py::arg("texture"), py::arg("precision") = "f32", doc("dytex::projection_errors"));
  module.def(
      "moving_region", [](const Texture& texture) { return to_array(dytex::moving_region(texture)); },
      py::arg("texture"), doc("dytex::moving_region"));
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

py::array draw_star(const dytex::Star& star, int frames, std::uint64_t seed, const py::object& progress) {
  if (frames < 1 || frames > 1'000'000)
    throw py::value_error("frames is " + std::to_string(frames) + "; allowed is 1 to 1000000");
  FrameArray out(frames, star.info.height, star.info.width, star.info.channels, CV_8U);
  run_interruptibly(progress, [&](const core::Context& context) {
    dytex::StarSynthesis synthesis(star, seed);
    for (int t = 0; t < frames; ++t) {
      context.check();
      out.put(t, synthesis.next());
      context.report("synthesize", (t + 1.0) / frames);
    }
  });
  return out.array();
}

py::tuple star_state(const dytex::Star& star) {
  std::vector<std::array<int, 3>> terms;
  for (const auto& term : star.terms) terms.push_back({term.x, term.y, term.lag});
  const auto& info = star.info;
  return py::make_tuple(info.width, info.height, info.channels, info.fps, info.frames, star.mean, terms,
                        star.coefficients, star.noise);
}

dytex::Star star_from(const py::tuple& state) {
  dytex::Star star;
  star.info.width = state[0].cast<int>(), star.info.height = state[1].cast<int>();
  star.info.channels = state[2].cast<int>(), star.info.fps = state[3].cast<double>();
  star.info.frames = state[4].cast<std::optional<std::int64_t>>();
  star.mean = state[5].cast<Eigen::VectorXf>();
  for (const auto& [x, y, lag] : state[6].cast<std::vector<std::array<int, 3>>>())
    star.terms.push_back({x, y, lag});
  star.coefficients = state[7].cast<Eigen::VectorXd>(), star.noise = state[8].cast<Eigen::MatrixXd>();
  dytex::validate(star);
  return star;
}

void bind_star(py::module_& module) {
  OptionsClass<dytex::StarOptions>(module, "StarOptions", "dytex::StarOptions")
      .field("reach", &dytex::StarOptions::reach)
      .field("lags", &dytex::StarOptions::lags)
      .finish();
  py::class_<dytex::Star>(module, "Star", doc("dytex::Star"))
      .def_readonly("coefficients", &dytex::Star::coefficients, doc("dytex::Star::coefficients"))
      .def_readonly("noise", &dytex::Star::noise, doc("dytex::Star::noise"))
      .def_property_readonly(
          "terms",
          [](const dytex::Star& star) {
            py::list terms;
            for (const auto& term : star.terms) terms.append(py::make_tuple(term.x, term.y, term.lag));
            return terms;
          },
          doc("dytex::StarTerm"))
      .def("synthesize", draw_star, py::arg("frames"), py::arg("seed") = 1, py::arg("progress") = py::none(),
           doc("dytex::StarSynthesis"))
      .def("__copy__", [](const dytex::Star& star) { return star; })
      .def(py::pickle([](const dytex::Star& star) { return star_state(star); },
                      [](const py::tuple& state) { return star_from(state); }));
  module.def(
      "learn_star",
      [](const ClipData& clip, const dytex::StarOptions& options, const py::object& progress) {
        return call(progress,
                    [&](const core::Context& context) {
                      auto found = dytex::learn_star(*clip.open(), options, context);
                      for (const auto& note : found.notes) context.warn(note);
                      return found;
                    })
            .star;
      },
      py::arg("clip"), py::arg("options") = dytex::StarOptions{}, py::arg("progress") = py::none(),
      doc("dytex::learn_star"));
}

}  // namespace

void bind_textures(py::module_& module) {
  bind_learning(module);
  bind_distances(module);
  bind_compression(module);
  bind_star(module);
}

}  // namespace emberfold::python
