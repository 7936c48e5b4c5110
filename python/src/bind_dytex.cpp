// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>
#include <vector>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include "core/io/model_folder.hpp"
#include "dytex/editing/edit.hpp"
#include "dytex/learn.hpp"
#include "dytex/model/archive.hpp"
#include "dytex/synthesize.hpp"
#include "pipeline/parameter_count.hpp"
#include "python/src/archives.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using Texture = dytex::LinearDynamicTexture;

void warn(const std::vector<std::string>& notes) {
  for (const auto& note : notes)
    if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), 1) < 0) throw py::error_already_set();
}

/// Reads edits from keyword arguments, in their order. Scales are one edit, at the place of the first.
class EditReader {
 public:
  explicit EditReader(const py::kwargs& given) {
    for (const auto& [key, value] : given) take(key.cast<std::string>(), value);
    for (auto& edit : edits_) edit.keep_contrast = keep_contrast_;
  }
  [[nodiscard]] const std::vector<dytex::Edit>& edits() const { return edits_; }

 private:
  void take(const std::string& name, const py::handle& value) {
    using Numbers = std::vector<double>;
    const auto number = [&] { return from_python<double>(value, name); };
    if (name == "speed")
      add(dytex::Speed{number()});
    else if (name == "flow")
      add(dytex::Flow{number()});
    else if (name == "intensity")
      add(dytex::Intensity{number()});
    else if (name == "directions")
      add(dytex::Directions{from_python<Numbers>(value, name)});
    else if (name == "weights")
      add(dytex::Weights{from_python<Numbers>(value, name)});
    else if (name == "reverse") {
      if (from_python<bool>(value, name)) add(dytex::Reverse{});
    } else if (name == "coarse")
      scales().coarse = number();
    else if (name == "medium")
      scales().medium = number();
    else if (name == "fine")
      scales().fine = number();
    else if (name == "keep_contrast")
      keep_contrast_ = from_python<bool>(value, name);
    else if (name == "preset") {
      const auto more = dytex::preset(from_python<std::string>(value, name));
      edits_.insert(edits_.end(), more.begin(), more.end());
    } else
      throw py::value_error("edit() has no argument '" + name + "'");
  }
  template <class What>
  void add(What what) {
    edits_.push_back({std::move(what)});
  }
  dytex::Scales& scales() {
    for (auto& edit : edits_)
      if (auto* found = std::get_if<dytex::Scales>(&edit.what)) return *found;
    add(dytex::Scales{});
    return std::get<dytex::Scales>(edits_.back().what);
  }

  std::vector<dytex::Edit> edits_;
  bool keep_contrast_ = dytex::Edit{}.keep_contrast;
};

Texture edit(const Texture& texture, const py::kwargs& given) {
  const EditReader reader(given);
  auto result = call(py::none(), [&](const core::Context&) { return dytex::edit(texture, reader.edits()); });
  warn(result.notes);
  return std::move(result.texture);
}

/// Takes `progress` out of keyword arguments that are else the fields of options.
template <class Options>
Options options_of(const py::kwargs& given) {
  return py::type::of<Options>()(**given).template cast<Options>();
}

py::array synthesize(const Texture& texture, int frames, const py::object& progress,
                     const py::kwargs& given) {
  if (frames < 1 || frames > 1'000'000)
    throw py::value_error("frames is " + std::to_string(frames) + "; allowed is 1 to 1000000");
  const auto options = options_of<dytex::SynthesisOptions>(given);
  const auto& info = texture.info;
  FrameArray out(frames, info.height, info.width, info.channels, CV_8U);
  run_interruptibly(progress, [&](const core::Context& context) {
    dytex::Synthesis synthesis(texture, options);
    for (int t = 0; t < frames; ++t) {
      context.check();
      out.put(t, synthesis.next());
      context.report("synthesize", (t + 1.0) / frames);
    }
  });
  return out.array();
}

void bind_options(py::module_& module) {
  py::enum_<dytex::Order>(module, "Order", doc("dytex::Order"))
      .value("given", dytex::Order::given)
      .value("gavish_donoho", dytex::Order::gavish_donoho)
      .value("held_out", dytex::Order::held_out);
  py::enum_<dytex::Method>(module, "Method", doc("dytex::Method"))
      .value("closed_form", dytex::Method::closed_form)
      .value("n4sid", dytex::Method::n4sid);
  using Learn = dytex::LearnOptions;
  OptionsClass<Learn>(module, "LearnOptions", "dytex::LearnOptions")
      .described_fields()
      .field("energy", &Learn::energy)
      .field("order", &Learn::order)
      .field("method", &Learn::method)
      .field("noise_rank", &Learn::noise_rank)
      .field("memory", &Learn::memory)
      .finish();
  using Synthesis = dytex::SynthesisOptions;
  OptionsClass<Synthesis>(module, "SynthesisOptions", "dytex::SynthesisOptions")
      .field("seed", &Synthesis::seed)
      .field("first_frame", &Synthesis::first_frame)
      .field("pixel_noise", &Synthesis::pixel_noise)
      .field("from_mean", &Synthesis::from_mean)
      .field("loop", &Synthesis::loop)
      .finish();
}

void bind_values(py::class_<Texture>& texture) {
  const auto add = [&](const char* name, auto member) {
    texture.def_readonly(name, member, doc("dytex::LinearDynamicTexture::" + std::string(name)));
  };
  add("mean", &Texture::mean);
  add("C", &Texture::C);
  add("weights", &Texture::weights);
  add("A", &Texture::A);
  add("B", &Texture::B);
  add("r", &Texture::r);
  add("noise", &Texture::noise);
  add("noise_share", &Texture::noise_share);
  add("states", &Texture::states);
  add("singular", &Texture::singular);
  texture
      .def_property_readonly(
          "parameters", [](const Texture& t) { return pipeline::parameter_count(t); },
          doc("pipeline::parameter_count"))
      .def_property_readonly("components", &Texture::components)
      .def_property_readonly("order", &Texture::order)
      .def_property_readonly("width", [](const Texture& t) { return t.info.width; })
      .def_property_readonly("height", [](const Texture& t) { return t.info.height; })
      .def_property_readonly("channels", [](const Texture& t) { return t.info.channels; })
      .def_property_readonly("fps", [](const Texture& t) { return t.info.fps; });
}

void bind_texture(py::module_& module) {
  py::class_<Texture> texture(module, "LinearDynamicTexture", doc("dytex::LinearDynamicTexture"));
  bind_values(texture);
  texture.def("edit", edit, doc("dytex::edit"))
      .def("synthesize", synthesize, py::arg("frames"), py::arg("progress") = py::none(),
           "Draws new frames as an array, uint8, T × H × W or T × H × W × 3. Other arguments are the fields "
           "of SynthesisOptions: seed, first_frame, pixel_noise, from_mean, loop.")
      .def(
          "project",
          [](const Texture& t, const py::array& levels) {
            return dytex::project(t, to_levels(levels, "levels"));
          },
          py::arg("levels"), doc("dytex::project"))
      .def(
          "draw",
          [](const Texture& t, const Eigen::VectorXd& state) { return to_array(dytex::draw(t, state)); },
          py::arg("state"), doc("dytex::draw"))
      .def(
          "predict",
          [](const Texture& t, const py::array& levels) {
            return to_array(dytex::predict(t, to_levels(levels, "levels")));
          },
          py::arg("levels"), doc("dytex::predict"))
      .def(
          "write",
          [](const Texture& t, const std::string& folder) { io::write_model(folder, dytex::to_archive(t)); },
          py::arg("folder"), doc("io::write_model"))
      .def_static(
          "read",
          [](const std::string& folder) {
            return dytex::linear_dynamic_texture(io::read_model(folder, io::kTextureFormat));
          },
          py::arg("folder"), doc("io::read_model"))
      .def("__copy__", [](const Texture& t) { return t; })
      .def("__deepcopy__", [](const Texture& t, const py::dict&) { return t; })
      .def("__eq__",
           [](const Texture& a, const py::object& b) {
             return py::isinstance<Texture>(b) &&
                    equal(dytex::to_archive(a), dytex::to_archive(b.cast<const Texture&>()));
           })
      .def("__repr__",
           [](const Texture& t) {
             return "LinearDynamicTexture(" + std::to_string(t.info.width) + "x" +
                    std::to_string(t.info.height) + ", components=" + std::to_string(t.components()) + ")";
           })
      .def(py::pickle(
          [](const Texture& t) { return to_state(dytex::to_archive(t)); },
          [](const py::tuple& state) { return dytex::linear_dynamic_texture(to_archive(state)); }));
  texture.attr("__hash__") = py::none();
}

}  // namespace

void bind_dytex(py::module_& module) {
  bind_options(module);
  bind_texture(module);
  module.def(
      "learn",
      [](const ClipData& clip, const py::object& progress, const py::kwargs& given) {
        const auto options = options_of<dytex::LearnOptions>(given);
        auto result = call(progress, [&](const core::Context& context) {
          return dytex::learn(*clip.open(), options, context);
        });
        warn(result.notes);
        return std::move(result.texture);
      },
      py::arg("clip"), py::arg("progress") = py::none(), doc("dytex::learn"));
  py::list presets;
  for (const auto& preset : dytex::presets()) presets.append(py::make_tuple(preset.name, preset.about));
  module.attr("PRESETS") = py::tuple(presets);
}

}  // namespace emberfold::python
