// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <utility>
#include <vector>

#include "core/io/clip_writer.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/docs.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using Roi = std::array<int, 4>;

ClipData open_file(const std::string& path, std::int64_t first, std::optional<std::int64_t> last,
                   std::int64_t step, std::optional<Roi> roi, std::optional<double> fps) {
  FilePart part{path, first, last, step, {}};
  if (roi) part.roi = cv::Rect((*roi)[0], (*roi)[1], (*roi)[2], (*roi)[3]);
  return {std::move(part), fps};
}

/// Reads frames first, first + 1 … as an array; at most `count`, all where that is negative.
py::array read(const ClipData& clip, std::int64_t first, std::int64_t count) {
  const auto frames = call(py::none(), [&](const core::Context& context) {
    const auto source = clip.open([&](const std::string& text) { context.warn(text); });
    std::vector<cv::Mat> read;
    for (std::int64_t t = 0; count < 0 || t < first + count; ++t) {
      context.check();
      cv::Mat frame = source->next();
      if (frame.empty()) break;
      if (t >= first) read.push_back(std::move(frame));
    }
    return read;
  });
  return to_array(frames);
}

void write_video(const std::string& path, const ClipData& clip, std::optional<int> frames,
                 const py::object& progress) {
  run_interruptibly(progress, [&](const core::Context& context) {
    const auto source = clip.open();
    const int all = frames ? *frames : static_cast<int>(clip.info().frames.value_or(1 << 30));
    io::write_video(path, *source, all, context);
  });
}

}  // namespace

void bind_clip(py::module_& module) {
  py::class_<ClipData>(module, "ClipData", "A clip that is held in an array or lies in a file.")
      .def(py::init<py::array, std::optional<double>, std::optional<double>>(), py::arg("clip"),
           py::arg("fps") = py::none(), py::arg("white") = py::none())
      .def_static("open", open_file, py::arg("path"), py::arg("first") = 0, py::arg("last") = py::none(),
                  py::arg("step") = 1, py::arg("roi") = py::none(), py::arg("fps") = py::none())
      .def_property_readonly("width", [](const ClipData& clip) { return clip.info().width; })
      .def_property_readonly("height", [](const ClipData& clip) { return clip.info().height; })
      .def_property_readonly("channels", [](const ClipData& clip) { return clip.info().channels; })
      .def_property_readonly("fps", [](const ClipData& clip) { return clip.info().fps; })
      .def_property_readonly("white", [](const ClipData& clip) { return clip.info().white; })
      .def_property_readonly("frames", [](const ClipData& clip) { return clip.info().frames; })
      .def_property_readonly("dtype", [](const ClipData& clip) { return dtype_of(clip.info().depth); })
      .def_property_readonly("array", [](const ClipData& clip) { return clip.array(); })
      .def("read", read, py::arg("first") = 0, py::arg("count") = -1,
           "Reads frames from `first` on as an array, at most `count` of them.");
  module.def("write_video", write_video, py::arg("path"), py::arg("clip"), py::arg("frames") = py::none(),
             py::arg("progress") = py::none(), doc("io::write_video"));
}

}  // namespace emberfold::python
