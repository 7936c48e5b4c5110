// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "python/src/archives.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using pipeline::ClipModel;

py::array synthesize(const ClipModel& given, int frames, const py::object& progress,
                     const py::kwargs& options) {
  if (frames < 1 || frames > 1'000'000)
    throw py::value_error("frames is " + std::to_string(frames) + "; allowed is 1 to 1000000");
  const auto how =
      py::type::of<pipeline::ClipSynthesisOptions>()(**options).cast<pipeline::ClipSynthesisOptions>();
  // A copy, since the model's rates may be changed by another thread meanwhile.
  ClipModel model = given;
  mcmc::validate(model.motion);
  if (const auto why = pipeline::why_undrawable(model.motion); !why.empty()) throw core::InputError(why);
  const auto usual = model.footage ? pipeline::ModelFill::footage : pipeline::ModelFill::diffusion;
  if (how.fill_kind.value_or(usual) != pipeline::ModelFill::footage)
    run_interruptibly(progress,
                      [&](const core::Context& context) { pipeline::correct_rates(model, context); });
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

bool equal(const core::ModelArchive& a, const core::ModelArchive& b) {
  if (a.text != b.text || a.arrays != b.arrays || a.parts.size() != b.parts.size()) return false;
  for (const auto& [name, part] : a.parts) {
    const auto other = b.parts.find(name);
    if (other == b.parts.end() || !equal(part, other->second)) return false;
  }
  return true;
}

void bind_model(py::module_& module) {
  py::enum_<pipeline::ModelFill>(module, "ModelFill", doc("pipeline::ModelFill"))
      .value("footage", pipeline::ModelFill::footage)
      .value("diffusion", pipeline::ModelFill::diffusion)
      .value("texture", pipeline::ModelFill::texture)
      .value("dytex", pipeline::ModelFill::dytex);
  py::enum_<mcmc::Start>(module, "Start", doc("mcmc::Start"))
      .value("data", mcmc::Start::data)
      .value("stationary", mcmc::Start::stationary);
  using Options = pipeline::ClipSynthesisOptions;
  OptionsClass<Options>(module, "ClipSynthesisOptions", "pipeline::ClipSynthesisOptions")
      .field("seed", &Options::seed)
      .field("fill_kind", &Options::fill_kind)
      .field("start", &Options::start)
      .field("speed", &Options::speed)
      .field("loop", &Options::loop)
      .field("fill", &Options::fill)
      .finish();
  py::class_<ClipModel> model(module, "ClipModel", doc("pipeline::ClipModel"));
  model.def_readonly("motion", &ClipModel::motion, doc("pipeline::ClipModel::motion"))
      .def_property_readonly("texture", [](const ClipModel& m) { return m.texture; })
      .def_property_readonly(
          "rates",
          [](ClipModel& m) -> mcmc::OperatorRates& {
            pipeline::correct_rates(m);  // before someone changes them
            return m.motion.rates;
          },
          doc("mcmc::OperatorRates"))
      .def("synthesize", synthesize, py::arg("frames"), py::arg("progress") = py::none(),
           "Draws new frames as an array, uint8, T × H × W or T × H × W × 3. Other arguments are the fields "
           "of ClipSynthesisOptions: seed, fill_kind, start, speed, loop, fill.")
      .def(
          "write",
          [](const ClipModel& m, const std::string& folder) {
            io::write_model(folder, pipeline::to_archive(m));
          },
          py::arg("folder"), doc("io::write_model"))
      .def_static(
          "read",
          [](const std::string& folder) {
            return pipeline::clip_model(io::read_model(folder, io::kMotionFormat));
          },
          py::arg("folder"), doc("io::read_model"))
      .def("__copy__", [](const ClipModel& m) { return m; })
      .def("__deepcopy__", [](const ClipModel& m, const py::dict&) { return m; })
      .def("__eq__",
           [](const ClipModel& a, const py::object& b) {
             return py::isinstance<ClipModel>(b) &&
                    equal(pipeline::to_archive(a), pipeline::to_archive(b.cast<const ClipModel&>()));
           })
      .def("__repr__",
           [](const ClipModel& m) {
             return "ClipModel(" + std::to_string(m.motion.width) + "x" + std::to_string(m.motion.height) +
                    ", of " + std::to_string(m.motion.frames) + " frames)";
           })
      .def(py::pickle([](const ClipModel& m) { return to_state(pipeline::to_archive(m)); },
                      [](const py::tuple& state) { return pipeline::clip_model(to_archive(state)); }));
  model.attr("__hash__") = py::none();
}

void bind_options(py::module_& module) {
  OptionsClass<pipeline::StartOptions>(module, "StartOptions", "pipeline::StartOptions")
      .field("chains", &pipeline::StartOptions::chains)
      .field("perturb", &pipeline::StartOptions::perturb)
      .finish();
  OptionsClass<pipeline::CalibrateOptions>(module, "CalibrateOptions", "pipeline::CalibrateOptions")
      .field("calibrate", &pipeline::CalibrateOptions::calibrate)
      .finish();
  using Options = pipeline::AnalyzeOptions;
  OptionsClass<Options>(module, "AnalyzeOptions", "pipeline::AnalyzeOptions")
      .field("sketch", &Options::sketch)
      .field("match", &Options::match)
      .field("fill", &Options::fill)
      .field("starts", &Options::starts)
      .field("infer", &Options::infer)
      .field("calibrate", &Options::calibrate)
      .field("texture", &Options::texture)
      .field("bottom_up", &Options::bottom_up)
      .field("curve_events", &Options::curve_events)
      .field("sample", &Options::sample)
      .field("in_noise", &Options::in_noise)
      .field("seed", &Options::seed)
      .field("clip", &Options::clip)
      .finish();
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
  run["model"] = std::move(found.model);
  run["motion"] = hold(std::move(found.motion));
  return run;
}

}  // namespace

void bind_pipeline(py::module_& module) {
  bind_model(module);
  bind_options(module);
  module.def(
      "analyze",
      [](const ClipData& clip, const pipeline::AnalyzeOptions& options, const py::object& progress) {
        return to_dict(call(progress, [&](const core::Context& context) {
          return pipeline::analyze(*clip.open(), options, context);
        }));
      },
      py::arg("clip"), py::arg("options") = pipeline::AnalyzeOptions{}, py::arg("progress") = py::none(),
      doc("pipeline::analyze"));
}

}  // namespace emberfold::python
