// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>

#include <pybind11/stl.h>

#include "dytex/quilting/quilt.hpp"
#include "dytex/quilting/quilt_map.hpp"
#include "dytex/quilting/quilt_measures.hpp"
#include "dytex/quilting/render.hpp"
#include "dytex/quilting/trajectories.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

/// Renders the source's frames by a map, some at a time so that a stop is heard.
py::array render(const dytex::QuiltMap& map, const dytex::Trajectories& source, const py::object& progress) {
  const auto& info = source.info();
  FrameArray out(source.frames(), map.size.height, map.size.width, info.channels, info.depth);
  const std::array<const dytex::Trajectories*, 1> sources{&source};
  run_interruptibly(progress, [&](const core::Context& context) {
    for (int t = 0; t < source.frames(); t += source.chunk_frames()) {
      context.check();
      const int count = std::min(source.chunk_frames(), source.frames() - t);
      const auto frames = dytex::render_quilt(map, sources, {}, t, count);
      for (int i = 0; i < count; ++i) out.put(t + i, frames[static_cast<std::size_t>(i)]);
      context.report("render", double(t + count) / source.frames());
    }
  });
  return out.array();
}

py::array map_array(const dytex::QuiltMap& map) {
  const auto array = dytex::to_array(map);
  const std::vector<py::ssize_t> shape(array.shape.begin(), array.shape.end());
  return py::array_t<std::int32_t>(shape, std::get<std::vector<std::int32_t>>(array.data).data());
}

dytex::Trajectories read(const ClipData& clip, const py::object& progress) {
  return call(progress, [&](const core::Context& context) {
    return dytex::read_trajectories(*clip.open(), {}, context);
  });
}

cv::Mat guide_of(const py::object& given, const char* name) {
  if (given.is_none()) return {};
  const cv::Mat guide = to_levels(given.cast<py::array>(), name);
  if (guide.channels() != 1) throw py::value_error(std::string(name) + " is in colour; allowed is (H, W)");
  return guide;
}

py::tuple quilt(const ClipData& clip, const dytex::QuiltOptions& options, const py::object& forbidden,
                const py::object& guide, const py::object& output_guide, const py::object& progress) {
  const auto source = read(clip, progress);
  dytex::QuiltSource part{&source, {}, guide_of(guide, "guide")};
  if (!forbidden.is_none()) part.forbidden = to_mask(forbidden.cast<py::array>(), "forbidden");
  const cv::Mat wanted = guide_of(output_guide, "output_guide");
  const auto result = call(progress, [&](const core::Context& context) {
    return dytex::quilt(std::array{part}, options, context, wanted);
  });
  return py::make_tuple(render(result.map, source, progress), map_array(result.map));
}

dytex::QuiltMap map_of(const py::array_t<std::int32_t, py::array::c_style>& map, cv::Size source) {
  core::NpyArray array;
  for (py::ssize_t i = 0; i < map.ndim(); ++i) array.shape.push_back(static_cast<std::size_t>(map.shape(i)));
  array.data = std::vector<std::int32_t>(map.data(), map.data() + map.size());
  return dytex::quilt_map(array, std::array{source});
}

py::array render_quilt(const py::array_t<std::int32_t, py::array::c_style>& map, const ClipData& clip,
                       const py::object& progress) {
  const auto source = read(clip, progress);
  return render(map_of(map, source.size()), source, progress);
}

/// Measures how much a map copies, and how visible its seams are.
py::dict measure_quilt(const py::array_t<std::int32_t, py::array::c_style>& map, const ClipData& clip,
                       const py::object& progress) {
  const auto source = read(clip, progress);
  const auto places = map_of(map, source.size());
  const std::array<const dytex::Trajectories*, 1> sources{&source};
  const auto found =
      call(progress, [&](const core::Context&) { return dytex::measure_quilt(places, {}, sources); });
  return py::dict(py::arg("largest_piece") = found.largest_piece,
                  py::arg("source_share") = found.source_share, py::arg("seam_share") = found.seam_share,
                  py::arg("seam_step") = found.seam_step, py::arg("other_step") = found.other_step,
                  py::arg("seam_ratio") = found.seam_ratio());
}

}  // namespace

void bind_quilt(py::module_& module) {
  using Quilt = dytex::QuiltOptions;
  py::enum_<dytex::Seams>(module, "Seams", doc("dytex::Seams"))
      .value("still", dytex::Seams::still)
      .value("moving", dytex::Seams::moving);
  OptionsClass<Quilt>(module, "QuiltOptions", "dytex::QuiltOptions")
      .field("size", &Quilt::size)
      .field("block", &Quilt::block)
      .field("overlap", &Quilt::overlap)
      .field("components", &Quilt::components)
      .field("tolerance", &Quilt::tolerance)
      .field("floor", &Quilt::floor)
      .field("apart", &Quilt::apart)
      .field("guide_weight", &Quilt::guide_weight)
      .field("tileable", &Quilt::tileable)
      .field("seams", &Quilt::seams)
      .field("exact", &Quilt::exact)
      .field("seed", &Quilt::seed)
      .finish();
  module.def("quilt", quilt, py::arg("clip"), py::arg("options") = Quilt{}, py::arg("forbidden") = py::none(),
             py::arg("guide") = py::none(), py::arg("output_guide") = py::none(),
             py::arg("progress") = py::none(), doc("dytex::quilt"));
  module.def("measure_quilt", measure_quilt, py::arg("map"), py::arg("clip"),
             py::arg("progress") = py::none(), doc("dytex::measure_quilt"));
  module.def("render_quilt", render_quilt, py::arg("map"), py::arg("clip"), py::arg("progress") = py::none(),
             doc("dytex::render_quilt"));
}

}  // namespace emberfold::python
