// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/edit_model.hpp"
#include "pipeline/parameter_count.hpp"
#include "python/src/archives.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/held_model.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using pipeline::ClipModel;

py::array synthesize(const HeldModel& given, int frames, const py::object& progress,
                     const py::kwargs& options) {
  if (frames < 1 || frames > 1'000'000)
    throw py::value_error("frames is " + std::to_string(frames) + "; allowed is 1 to 1000000");
  auto how = py::type::of<pipeline::ClipSynthesisOptions>()(**options).cast<pipeline::ClipSynthesisOptions>();
  if (!how.method && given.is_changed()) how.method = pipeline::SynthesisMethod::diffusion;
  // A copy, since the model's rates may be changed by another thread meanwhile.
  const ClipModel model = static_cast<const ClipModel&>(given);
  mcmc::validate(model.motion);
  if (const auto why = pipeline::why_undrawable(model.motion); !why.empty()) throw core::InputError(why);
  const auto info = pipeline::ClipSynthesis(model, how).info();
  FrameArray out(frames, info.height, info.width, info.channels, CV_8U);
  run_interruptibly(progress, [&](const core::Context& context) {
    pipeline::ClipSynthesis synthesis(model, how, context);
    int t = 0;
    synthesis.each(frames, [&](const cv::Mat& frame) {
      out.put(t++, frame);
      context.report("synthesize", double(t) / frames);
    });
  });
  return out.array();
}

/// An array of truth values as a picture.
py::array picture_of(const py::handle& given) {
  auto array = py::array::ensure(given);
  if (!array) throw py::value_error("birth_map is no array");
  if (array.dtype().kind() == 'b') return array.attr("astype")("uint8").cast<py::array>();
  return array;
}

/// Reads edits from keyword arguments, as the options of `emberfold synth` are called.
mcmc::MotionEdit edit_of(const py::kwargs& given, const mcmc::MotionModel& model) {
  mcmc::MotionEdit edit;
  constexpr std::array kRates{"births", "deaths", "splits", "merges", "connects", "disconnects"};
  for (const auto& [key, value] : given) {
    const auto name = key.cast<std::string>();
    const auto* const rate = std::ranges::find(kRates, name);
    if (rate != kRates.end())
      edit.rates.at(static_cast<std::size_t>(rate - kRates.begin())) = from_python<double>(value, name);
    else if (name == "speed")
      edit.speed = from_python<double>(value, name);
    else if (name == "reverse")
      edit.reverse = from_python<bool>(value, name);
    else if (name == "intensity")
      edit.intensity = from_python<double>(value, name);
    else if (name == "flicker")
      edit.flicker = from_python<double>(value, name);
    else if (name == "contrast")
      edit.contrast = from_python<double>(value, name);
    else if (name == "strokes")
      edit.strokes = from_python<mcmc::StrokeChoice>(value, name);
    else if (name == "wind") {
      const auto [x, y] = from_python<std::pair<double, double>>(value, name);
      edit.wind = {x, y};
    } else if (name == "birth_map")
      edit.birth_map = pipeline::birth_map(to_mask(picture_of(value), name), model);
    else
      throw py::value_error("edit() has no argument '" + name + "'");
  }
  return edit;
}

HeldModel edit(const HeldModel& model, std::uint64_t seed, const py::object& progress,
               const py::kwargs& given) {
  const auto edit = edit_of(given, model.motion);
  return HeldModel(call(progress, [&](const core::Context& context) {
    auto edited = pipeline::edit_model(static_cast<const ClipModel&>(model), edit, seed, context);
    for (const auto& note : edited.notes) context.warn(note);
    return std::move(edited.model);
  }));
}

void bind_model_options(py::module_& module) {
  py::enum_<mcmc::StrokeChoice>(module, "StrokeChoice", doc("mcmc::StrokeChoice"))
      .value("all", mcmc::StrokeChoice::all)
      .value("coarse", mcmc::StrokeChoice::coarse)
      .value("fine", mcmc::StrokeChoice::fine);
  py::enum_<pipeline::SynthesisMethod>(module, "SynthesisMethod", doc("pipeline::SynthesisMethod"))
      .value("footage", pipeline::SynthesisMethod::footage)
      .value("edit", pipeline::SynthesisMethod::edit)
      .value("strokes", pipeline::SynthesisMethod::strokes)
      .value("diffusion", pipeline::SynthesisMethod::diffusion)
      .value("texture", pipeline::SynthesisMethod::texture);
  py::enum_<mcmc::Start>(module, "Start", doc("mcmc::Start"))
      .value("data", mcmc::Start::data)
      .value("stationary", mcmc::Start::stationary);
  using Options = pipeline::ClipSynthesisOptions;
  OptionsClass<Options>(module, "ClipSynthesisOptions", "pipeline::ClipSynthesisOptions")
      .field("seed", &Options::seed)
      .field("method", &Options::method)
      .field("start", &Options::start)
      .field("speed", &Options::speed)
      .field("loop", &Options::loop)
      .finish();
}

void bind_uses(py::class_<HeldModel>& model) {
  model
      .def_property_readonly(
          "motion",
          [](HeldModel& m) -> mcmc::MotionModel& {
            m.remember();
            return m.motion;
          },
          doc("mcmc::MotionModel"))
      .def_property_readonly(
          "rates",
          [](HeldModel& m) -> mcmc::OperatorRates& {
            m.remember();
            return m.motion.rates;
          },
          doc("mcmc::OperatorRates"))
      .def("synthesize", synthesize, py::arg("frames"), py::arg("progress") = py::none(),
           "Draws new frames as an array, uint8, T × H × W or T × H × W × 3. Where the model's numbers were "
           "changed, strokes are drawn, else its footage is played. Other arguments are the fields of "
           "ClipSynthesisOptions: seed, method, start, speed, loop.");
}

void bind_keeping(py::class_<HeldModel>& model) {
  model
      .def(
          "write",
          [](const HeldModel& m, const std::string& folder) {
            ClipModel kept = static_cast<const ClipModel&>(m);
            if (m.is_changed()) kept.footage.reset();
            io::write_model(folder, pipeline::to_archive(kept));
          },
          py::arg("folder"), doc("io::write_model"))
      .def_static(
          "read",
          [](const std::string& folder) {
            return HeldModel(pipeline::clip_model(io::read_model(folder, io::kMotionFormat)));
          },
          py::arg("folder"), doc("io::read_model"))
      .def("edit", edit, py::arg("seed") = 1, py::arg("progress") = py::none(),
           ("Returns an edited model. Arguments: speed, reverse, intensity, flicker, contrast, wind=(x, y), "
            "strokes, birth_map (H, W), births, deaths, splits, merges, connects, disconnects.\n\n" +
            std::string(doc("pipeline::edit_model")) + "\n\n" + doc("mcmc::MotionEdit"))
               .c_str())
      .def_property_readonly(
          "parameters", [](const HeldModel& m) { return pipeline::parameter_count(m.motion); },
          doc("pipeline::parameter_count"))
      .def("__copy__", [](const HeldModel& m) { return m; })
      .def("__deepcopy__", [](const HeldModel& m, const py::dict&) { return m; })
      .def("__eq__",
           [](const HeldModel& a, const py::object& b) {
             return py::isinstance<HeldModel>(b) &&
                    equal(pipeline::to_archive(a), pipeline::to_archive(b.cast<const HeldModel&>()));
           })
      .def("__repr__",
           [](const HeldModel& m) {
             return "ClipModel(" + std::to_string(m.motion.width) + "x" + std::to_string(m.motion.height) +
                    ", of " + std::to_string(m.motion.frames) + " frames)";
           })
      .def(py::pickle(
          [](const HeldModel& m) {
            return py::make_tuple(to_state(pipeline::to_archive(m)), m.is_changed());
          },
          [](const py::tuple& state) {
            HeldModel m(pipeline::clip_model(to_archive(state[0])));
            if (state[1].cast<bool>()) m.learned = std::make_shared<const mcmc::MotionModel>();
            return m;
          }));
  model.attr("__hash__") = py::none();
}

}  // namespace

void bind_model(py::module_& module) {
  bind_model_options(module);
  py::class_<HeldModel> model(module, "ClipModel", doc("pipeline::ClipModel"));
  bind_uses(model);
  bind_keeping(model);
}

}  // namespace emberfold::python
