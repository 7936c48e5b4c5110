// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/analyze.hpp"
#include "pipeline/clip_model.hpp"
#include "pipeline/clip_synthesis.hpp"
#include "pipeline/stages/analysis_stages.hpp"
#include "python/src/archives.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"
#include "python/src/reviews.hpp"

namespace emberfold::python {

namespace {

using pipeline::ClipModel;

/// A model whose numbers can be changed, and what they were before somebody could.
struct HeldModel : ClipModel {
  HeldModel() = default;
  explicit HeldModel(ClipModel model) : ClipModel(std::move(model)) {}

  std::shared_ptr<const mcmc::MotionModel> learned = {};

  /// Its own footage shows nothing of such a change: strokes are drawn then.
  [[nodiscard]] bool is_changed() const { return learned && *learned != motion; }
  void remember() {
    if (!learned) learned = std::make_shared<const mcmc::MotionModel>(motion);
  }
  void correct() {
    if (!correction) return;
    const bool changed = is_changed();
    pipeline::correct_rates(*this);
    if (!changed) learned.reset();
  }
};

py::array synthesize(const HeldModel& given, int frames, const py::object& progress,
                     const py::kwargs& options) {
  if (frames < 1 || frames > 1'000'000)
    throw py::value_error("frames is " + std::to_string(frames) + "; allowed is 1 to 1000000");
  auto how =
      py::type::of<pipeline::ClipSynthesisOptions>()(**options).cast<pipeline::ClipSynthesisOptions>();
  if (!how.fill_kind && given.is_changed()) how.fill_kind = pipeline::ModelFill::diffusion;
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
  py::class_<HeldModel> model(module, "ClipModel", doc("pipeline::ClipModel"));
  model
      .def_property_readonly(
          "motion",
          [](HeldModel& m) -> mcmc::MotionModel& {
            m.remember();
            return m.motion;
          },
          doc("mcmc::MotionModel"))
      .def_property_readonly("texture", [](const HeldModel& m) { return m.texture; })
      .def_property_readonly(
          "rates",
          [](HeldModel& m) -> mcmc::OperatorRates& {
            m.correct();  // before someone changes them
            m.remember();
            return m.motion.rates;
          },
          doc("mcmc::OperatorRates"))
      .def("synthesize", synthesize, py::arg("frames"), py::arg("progress") = py::none(),
           "Draws new frames as an array, uint8, T × H × W or T × H × W × 3. Where the model's numbers were "
           "changed, strokes are drawn, else its footage is played. Other arguments are the fields of "
           "ClipSynthesisOptions: seed, fill_kind, start, speed, loop, fill.")
      .def(
          "write",
          [](const HeldModel& m, const std::string& folder) {
            ClipModel kept = m;
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
      .field("review", &Options::review)
      .field("seed", &Options::seed)
      .field("clip", &Options::clip)
      .finish();
}

/// What a review told of the clip: answers that were taken, and counts and rates by class, "all" last.
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
  bind_model(module);
  bind_options(module);
  module.def("analyze", analyze, py::arg("clip"), py::arg("options") = pipeline::AnalyzeOptions{},
             py::arg("progress") = py::none(), py::arg("folder") = py::none(), py::arg("keys") = Keys{},
             doc("pipeline::analyze"));
  module.def(
      "set_quality",
      [](pipeline::AnalyzeOptions& options, const std::string& name) {
        const auto quality = pipeline::quality(name);
        if (!quality)
          throw py::value_error("quality is '" + name + "'; allowed is draft, normal or sure");
        pipeline::set_quality(options, *quality);
      },
      py::arg("options"), py::arg("quality"), doc("pipeline::set_quality"));
}

}  // namespace emberfold::python
