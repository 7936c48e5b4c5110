// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "core/io/model_folder.hpp"
#include "pipeline/reconstruct.hpp"
#include "python/src/archives.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"
#include "sketch/dictionary/dictionary.hpp"
#include "sketch/extract.hpp"
#include "sketch/inpainting/anchors.hpp"
#include "sketch/inpainting/heat_film.hpp"
#include "sketch/rendering/morph_frames.hpp"
#include "sketch/rendering/render.hpp"
#include "sketch/texture/texture_fill.hpp"

// From graphs back to frames: drawn patches, anchors, what lies between, and the learned dictionary.
namespace emberfold::python {

namespace {

const graph::AttributeGraph& only_frame(const Sketch& sketch) {
  const auto& frames = sketch.graphs->frames;
  if (frames.size() != 1)
    throw py::value_error("sketch has " + std::to_string(frames.size()) + " frames; allowed is 1");
  return frames.front();
}

pipeline::PatchDrawing drawing_of(const std::string& name) {
  if (name == "fitted") return pipeline::PatchDrawing::fitted;
  if (name == "pixels") return pipeline::PatchDrawing::pixels;
  throw py::value_error("patches is '" + name + "'; allowed is fitted or pixels");
}

py::tuple drawn_tuple(const sketch::Sketchable& drawn) {
  return py::make_tuple(to_array(drawn.levels), to_array(drawn.mask));
}

py::tuple draw_patches(const py::array& levels, const Sketch& sketch, const std::string& patches) {
  const cv::Mat frame = to_levels(levels, "levels");
  const auto drawing = drawing_of(patches);
  const auto& graph = only_frame(sketch);
  return drawn_tuple(
      call(py::none(), [&](const core::Context&) { return pipeline::draw_patches(frame, graph, drawing); }));
}

py::array fill_nonsketchable(const py::array& observed, const py::array& drawn, const py::array& mask,
                             const sketch::NonsketchableFillOptions& options, const py::object& progress) {
  const cv::Mat frame = to_levels(observed, "observed");
  const sketch::Sketchable part{to_levels(drawn, "drawn"), to_mask(mask, "mask")};
  return to_array(call(progress, [&](const core::Context& context) {
    return sketch::fill_nonsketchable(frame, part, options, context).levels;
  }));
}

Sketch add_anchors(const Sketch& sketch, const py::array& levels, double share) {
  const cv::Mat frame = to_levels(levels, "levels");
  const auto& graph = only_frame(sketch);
  return hold(call(py::none(), [&](const core::Context&) {
    graph::SketchSequence held{frame.cols, frame.rows, sketch.graphs->fps, {}};
    const auto drawn = pipeline::draw_patches(frame, graph, pipeline::PatchDrawing::fitted);
    held.append(pipeline::add_anchors(graph, drawn, frame, share));
    return held;
  }));
}

void bind_options(py::module_& module) {
  py::enum_<sketch::FillMethod>(module, "FillMethod", doc("sketch::FillMethod"))
      .value("diffusion", sketch::FillMethod::diffusion)
      .value("julesz", sketch::FillMethod::julesz)
      .value("efros_leung", sketch::FillMethod::efros_leung);
  using Texture = sketch::TextureOptions;
  OptionsClass<Texture>(module, "TextureOptions", "sketch::TextureOptions")
      .field("regions", &Texture::regions)
      .field("fewest", &Texture::fewest)
      .field("most", &Texture::most)
      .field("window", &Texture::window)
      .field("seed", &Texture::seed)
      .finish();
  using Julesz = sketch::JuleszOptions;
  OptionsClass<Julesz>(module, "JuleszOptions", "sketch::JuleszOptions")
      .field("sweeps", &Julesz::sweeps)
      .field("hottest", &Julesz::hottest)
      .field("coldest", &Julesz::coldest)
      .field("seed", &Julesz::seed)
      .finish();
  using Efros = sketch::EfrosLeungOptions;
  OptionsClass<Efros>(module, "EfrosLeungOptions", "sketch::EfrosLeungOptions")
      .field("window", &Efros::window)
      .field("tolerance", &Efros::tolerance)
      .field("candidates", &Efros::candidates)
      .field("guidance", &Efros::guidance)
      .field("seed", &Efros::seed)
      .finish();
  using Fill = sketch::NonsketchableFillOptions;
  OptionsClass<Fill>(module, "NonsketchableFillOptions", "sketch::NonsketchableFillOptions")
      .field("kind", &Fill::kind)
      .field("fill", &Fill::fill)
      .field("texture", &Fill::texture)
      .field("julesz", &Fill::julesz)
      .field("efros_leung", &Fill::efros_leung)
      .field("seed", &Fill::seed)
      .finish();
}

sketch::Dictionary learn_dictionary(const ClipData& clip, const Sketch& sketch, std::uint64_t seed,
                                    const py::object& progress) {
  return call(progress, [&](const core::Context& context) {
    sketch::DictionaryLearner learner(seed);
    const auto source = clip.open();
    const auto& graphs = sketch.graphs->frames;
    for (std::size_t t = 0; t < graphs.size(); ++t) {
      context.check();
      const cv::Mat frame = source->next();
      if (frame.empty()) throw core::InputError("sketch has more frames than the clip");
      learner.add(static_cast<std::uint32_t>(t),
                  sketch::view_patches(core::to_levels(frame, source->info()), graphs[t]));
      context.report("views", (double(t) + 1) / double(graphs.size()));
    }
    return learner.learn(context);
  });
}

py::tuple draw_learned(const py::array& levels, const Sketch& sketch, const sketch::Dictionary& dictionary) {
  const cv::Mat frame = to_levels(levels, "levels");
  const auto& graph = only_frame(sketch);
  return drawn_tuple(call(py::none(), [&](const core::Context&) {
    const auto codes = sketch::encode(frame, graph, dictionary, sketch::estimate_noise(core::luma(frame)));
    return sketch::draw_learned(graph, codes, dictionary, frame.size(), frame.channels());
  }));
}

void bind_dictionary(py::module_& module) {
  using sketch::Dictionary;
  py::class_<Dictionary> dictionary(module, "Dictionary", doc("sketch::Dictionary"));
  dictionary.def("__len__", [](const Dictionary& d) { return d.entries.size(); })
      .def_property_readonly(
          "entries",
          [](const Dictionary& d) {
            py::list rows;
            for (const auto& e : d.entries)
              rows.append(
                  py::make_tuple(graph::name(e.type), e.degree, e.seen, e.share, e.residual,
                                 py::array_t<float>(static_cast<py::ssize_t>(e.mean.size()), e.mean.data())));
            return rows;
          },
          "Tuples of type, degree, seen, share, residual and the mean shape, a profile or a window.")
      .def(
          "write",
          [](const Dictionary& d, const std::string& folder) {
            io::write_model(folder, sketch::to_archive(d));
          },
          py::arg("folder"), doc("io::write_model"))
      .def_static(
          "read",
          [](const std::string& folder) {
            return sketch::read_dictionary(io::read_model(folder, io::kDictionaryFormat));
          },
          py::arg("folder"), doc("io::read_model"))
      .def("__eq__",
           [](const Dictionary& a, const py::object& b) {
             return py::isinstance<Dictionary>(b) && a == b.cast<const Dictionary&>();
           })
      .def(py::pickle([](const Dictionary& d) { return to_state(sketch::to_archive(d)); },
                      [](const py::tuple& state) { return sketch::read_dictionary(to_archive(state)); }));
  dictionary.attr("__hash__") = py::none();
  module.def("learn_dictionary", learn_dictionary, py::arg("clip"), py::arg("sketch"), py::arg("seed") = 0,
             py::arg("progress") = py::none(), doc("sketch::DictionaryLearner"));
  module.def("draw_learned", draw_learned, py::arg("levels"), py::arg("sketch"), py::arg("dictionary"),
             doc("sketch::draw_learned"));
}

void bind_morph_drawing(py::module_& module) {
  module.def(
      "draw_morph",
      [](const graph::Morph& morph, int channels, std::pair<float, float> empty,
         const sketch::FillOptions& fill, const py::object& progress) {
        const sketch::MorphLook look{channels, empty.first, empty.second, fill};
        return to_array(call(progress, [&](const core::Context& context) {
          std::vector<cv::Mat> frames;
          sketch::draw_morph(
              morph, look, [&](const cv::Mat& frame) { frames.push_back(frame); }, context);
          return frames;
        }));
      },
      py::arg("morph"), py::arg("channels") = 3, py::arg("empty") = std::pair{0.0F, 0.0F},
      py::arg("fill") = sketch::FillOptions{}, py::arg("progress") = py::none(), doc("sketch::draw_morph"));
}

}  // namespace

void bind_drawing(py::module_& module) {
  bind_options(module);
  bind_dictionary(module);
  bind_morph_drawing(module);
  module.def("draw_patches", draw_patches, py::arg("levels"), py::arg("sketch"),
             py::arg("patches") = "fitted", doc("pipeline::draw_patches"));
  module.def("fill_nonsketchable", fill_nonsketchable, py::arg("observed"), py::arg("drawn"), py::arg("mask"),
             py::arg("options") = sketch::NonsketchableFillOptions{}, py::arg("progress") = py::none(),
             doc("sketch::fill_nonsketchable"));
  module.def("add_anchors", add_anchors, py::arg("sketch"), py::arg("levels"), py::arg("share"),
             doc("pipeline::add_anchors"));
  module.def(
      "make_heat_film",
      [](const py::array& levels, const py::array& mask, const std::vector<std::int64_t>& steps,
         const py::object& progress) {
        const cv::Mat frame = to_levels(levels, "levels"), held = to_mask(mask, "mask");
        return to_array(call(progress, [&](const core::Context& context) {
          return sketch::make_heat_film(frame, held, steps, context);
        }));
      },
      py::arg("levels"), py::arg("mask"), py::arg("steps"), py::arg("progress") = py::none(),
      doc("sketch::make_heat_film"));
}

}  // namespace emberfold::python
