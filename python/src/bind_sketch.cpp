// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reconstruct.hpp"
#include "pipeline/sketch_clip.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"
#include "sketch/extract.hpp"

namespace emberfold::python {

namespace {

void bind_options(py::module_& module) {
  using Extract = sketch::ExtractOptions;
  OptionsClass<Extract>(module, "ExtractOptions", "sketch::ExtractOptions").described_fields().finish();
}

Sketch extract(const py::array& levels, const sketch::ExtractOptions& options) {
  const cv::Mat frame = to_levels(levels, "levels");
  return hold(call(py::none(), [&](const core::Context&) {
    graph::SketchSequence sketch{frame.cols, frame.rows, core::ClipInfo{}.fps, {}};
    sketch.append(sketch::extract(frame, options));
    return sketch;
  }));
}

py::array reconstruct(const py::array& levels, const Sketch& sketch) {
  const cv::Mat frame = to_levels(levels, "levels");
  if (sketch.graphs->frames.size() != 1)
    throw py::value_error("sketch has " + std::to_string(sketch.graphs->frames.size()) +
                          " frames; allowed is 1");
  return to_array(call(py::none(), [&](const core::Context&) {
    return pipeline::reconstruct(frame, sketch.graphs->frames.front(), pipeline::PatchDrawing::fitted).bytes;
  }));
}

}  // namespace

void bind_sketch(py::module_& module) {
  bind_options(module);
  module.def("extract", extract, py::arg("levels"), py::arg("options") = sketch::ExtractOptions{},
             doc("sketch::extract"));
  module.def("reconstruct", reconstruct, py::arg("levels"), py::arg("sketch"), doc("pipeline::reconstruct"));
  module.def(
      "sketch_clip",
      [](const ClipData& clip, const sketch::ExtractOptions& options, const py::object& progress) {
        return hold(call(progress, [&](const core::Context& context) {
          return pipeline::sketch_clip(*clip.open(), options, context).sketch;
        }));
      },
      py::arg("clip"), py::arg("options") = pipeline::kFollowedSketch, py::arg("progress") = py::none(),
      doc("pipeline::sketch_clip"));
}

}  // namespace emberfold::python
