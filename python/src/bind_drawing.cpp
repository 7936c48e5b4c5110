// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "pipeline/reconstruct.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"
#include "sketch/inpainting/anchors.hpp"
#include "sketch/inpainting/heat_film.hpp"
#include "sketch/rendering/morph_frames.hpp"
#include "sketch/rendering/render.hpp"
#include "sketch/texture/texture_fill.hpp"

// From graphs back to frames: drawn patches, anchors and what lies between.
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
    held.append(pipeline::add_anchors(graph, frame, pipeline::PatchDrawing::fitted, share));
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
      .field("texture", &Fill::texture)
      .field("julesz", &Fill::julesz)
      .field("efros_leung", &Fill::efros_leung)
      .field("seed", &Fill::seed)
      .finish();
}

void bind_morph_drawing(py::module_& module) {
  module.def(
      "draw_morph",
      [](const graph::Morph& morph, int channels, std::pair<float, float> empty, const py::object& progress) {
        const sketch::MorphLook look{channels, empty.first, empty.second};
        return to_array(call(progress, [&](const core::Context& context) {
          std::vector<cv::Mat> frames;
          sketch::draw_morph(
              morph, look, [&](const cv::Mat& frame) { frames.push_back(frame); }, context);
          return frames;
        }));
      },
      py::arg("morph"), py::arg("channels") = 3, py::arg("empty") = std::pair{0.0F, 0.0F},
      py::arg("progress") = py::none(), doc("sketch::draw_morph"));
}

}  // namespace

void bind_drawing(py::module_& module) {
  bind_options(module);
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
