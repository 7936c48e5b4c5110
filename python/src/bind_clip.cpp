// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "core/io/clip_writer.hpp"
#include "core/io/read_options.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/docs.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

/// Sets one option of reading from Python's name for it.
void set_reading(io::ReadOptions& reading, const std::string& name, const py::object& value) {
  if (value.is_none()) return;
  if (name == "roi") {
    const auto roi = from_python<std::array<int, 4>>(value, name);
    reading.region = io::Region{roi[0], roi[1], roi[2], roi[3]};
  } else if (name == "step") {
    reading.every = from_python<int>(value, name);
  } else if (name == "origin") {
    const auto origin = from_python<std::string>(value, name);
    if (origin != "source" && origin != "part")
      throw py::value_error("origin is '" + origin + "'; allowed is source or part");
    reading.counts_from_part = origin == "part";
  } else if (name == "fps") {
    reading.fps = from_python<double>(value, name);
  } else if (name == "pixel_size") {
    reading.pixel_size = from_python<double>(value, name);
  } else if (name == "scale") {
    reading.scale = from_python<double>(value, name);
  } else if (name == "grey") {
    reading.grey = from_python<bool>(value, name);
  } else if (name == "channel") {
    reading.channel = from_python<int>(value, name);
  } else if (name == "slice") {
    reading.brightest_slice = py::isinstance<py::str>(value) && value.cast<std::string>() == "max";
    if (!reading.brightest_slice) reading.slice = from_python<int>(value, name);
  } else if (name == "levels") {
    reading.levels = io::parse_levels(from_python<std::string>(value, name));
  } else if (name == "mask") {
    reading.mask = from_python<std::string>(value, name);
  } else if (name == "stabilize") {
    reading.stabilize = io::parse_stabilize(from_python<std::string>(value, name));
  } else {
    throw py::value_error("open() has no argument '" + name + "'");
  }
}

ClipData open_file(const std::string& path, std::int64_t first, std::optional<std::int64_t> last,
                   const py::dict& options) {
  io::ReadOptions reading;
  reading.first = first, reading.last = last;
  for (const auto& [name, value] : options)
    set_reading(reading, name.cast<std::string>(), py::reinterpret_borrow<py::object>(value));
  return {path, reading};
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
  using MaybeNumber = std::optional<double>;
  py::class_<ClipData>(module, "ClipData", "A clip that is held in an array or lies in a file.")
      .def(py::init<py::array, MaybeNumber, MaybeNumber, MaybeNumber, std::vector<double>, OriginTuple>(),
           py::arg("clip"), py::arg("fps") = py::none(), py::arg("white") = py::none(),
           py::arg("pixel_size") = py::none(), py::arg("times") = py::tuple(),
           py::arg("origin") = OriginTuple{})
      .def_static("open", open_file, py::arg("path"), py::arg("first") = 0, py::arg("last") = py::none(),
                  py::arg("options") = py::dict(), doc("io::open_video"))
      .def_property_readonly("pixel_size", [](const ClipData& clip) { return clip.info().pixel_um; })
      .def_property_readonly("times", [](const ClipData& clip) { return clip.info().times; })
      .def_property_readonly("origin", [](const ClipData& clip) { return to_tuple(clip.info().origin); })
      .def_property_readonly("fps_is_known", [](const ClipData& clip) { return clip.info().fps_is_known; })
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
