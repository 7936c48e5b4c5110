// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>

#include <pybind11/stl.h>

#include "core/error.hpp"
#include "graph/curves/curve_identity.hpp"
#include "graph/io/contact_tables.hpp"
#include "graph/io/curve_tables.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/network_table.hpp"
#include "graph/io/unit_tables.hpp"
#include "graph/matching/match.hpp"
#include "graph/network/tip_growth.hpp"
#include "python/src/arrays.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"

namespace emberfold::python {

namespace {

using graph::Edge;
using graph::Link;
using graph::Patch;
using graph::Vertex;
static_assert(std::is_standard_layout_v<Vertex> && sizeof(Edge) == 8 && sizeof(Link) == 8);

/// The fields of a patch as NumPy sees them: name, type, and place in the memory of a Vertex.
py::dtype vertex_dtype() {
  py::list names, formats, offsets;
  const auto add = [&](const char* name, const char* format, std::size_t offset) {
    names.append(name), formats.append(format), offsets.append(offset);
  };
  constexpr std::size_t kPatch = offsetof(Vertex, patch), kPosition = kPatch + offsetof(Patch, position);
  add("id", "u4", offsetof(Vertex, id));
  add("stroke", "u4", offsetof(Vertex, subgraph));
  add("type", "u1", kPatch + offsetof(Patch, type));
  add("x", "f8", kPosition + offsetof(graph::Point, x));
  add("y", "f8", kPosition + offsetof(graph::Point, y));
  add("theta", "f8", kPatch + offsetof(Patch, theta));
  add("width", "f8", kPatch + offsetof(Patch, width));
  add("blur", "f8", kPatch + offsetof(Patch, blur));
  add("contrast", "f8", kPatch + offsetof(Patch, contrast));
  add("left", "3f4", kPatch + offsetof(Patch, left));
  add("middle", "3f4", kPatch + offsetof(Patch, middle));
  add("right", "3f4", kPatch + offsetof(Patch, right));
  add("cost", "f8", kPatch + offsetof(Patch, cost));
  add("gain", "f8", kPatch + offsetof(Patch, gain));
  add("evidence", "f8", kPatch + offsetof(Patch, evidence));
  add("curve", "u4", offsetof(Vertex, curve));
  return {names, formats, offsets, static_cast<py::ssize_t>(sizeof(Vertex))};
}

const py::dtype& patch_dtype() {
  static const auto* const dtype = new py::dtype(vertex_dtype());  // outlives the interpreter's end
  return *dtype;
}

template <class Pair>
py::array pairs_view(std::span<const Pair> pairs, const py::handle& owner) {
  static const auto* const numbers = new py::dtype(py::dtype::of<std::uint32_t>());
  return view(*numbers, {static_cast<py::ssize_t>(pairs.size()), 2}, {8, 4}, pairs.data(), owner);
}

const graph::SketchSequence& sketch_of(const Sketch& held) {
  return *held.graphs;
}
const graph::SketchSequence& sketch_of(const Motion& held) {
  return held.graphs->sketch;
}

template <class Held>
const graph::AttributeGraph& frame_of(const Held& held, py::ssize_t t) {
  const auto& frames = sketch_of(held).frames;
  const auto count = static_cast<py::ssize_t>(frames.size());
  if (t < -count || t >= count)
    throw py::index_error("frame is " + std::to_string(t) + "; there are " + std::to_string(count));
  return frames[static_cast<std::size_t>(t < 0 ? t + count : t)];
}

py::bytes bytes_of(const std::ostringstream& out) {
  return {out.str()};
}

/// Arrays that hold all graphs: their patches, edges, and how many of each are in a frame.
py::tuple sketch_state(const graph::SketchSequence& sketch) {
  py::list patches, edges;
  for (const auto& graph : sketch.frames) {
    patches.append(patches_view(graph, py::none()).attr("copy")());
    edges.append(pairs_view(graph.edges(), py::none()).attr("copy")());
  }
  return py::make_tuple(sketch.width, sketch.height, sketch.fps, patches, edges);
}

template <class Item>
std::vector<Item> items_of(const py::handle& given, const py::dtype& dtype, py::ssize_t items_each) {
  const auto array = py::module_::import("numpy").attr("ascontiguousarray")(given, dtype).cast<py::array>();
  const auto count = static_cast<std::size_t>(array.size() / items_each);
  const auto* first = static_cast<const Item*>(array.data());
  return {first, first + count};
}

graph::SketchSequence sketch_from(const py::tuple& state) {
  graph::SketchSequence sketch{state[0].cast<int>(), state[1].cast<int>(), state[2].cast<double>(), {}};
  const py::list patches = state[3], edges = state[4];
  for (std::size_t t = 0; t < patches.size(); ++t)
    sketch.frames.emplace_back(items_of<Vertex>(patches[t], patch_dtype(), 1),
                               items_of<Edge>(edges[t], py::dtype::of<std::uint32_t>(), 2));
  return sketch;
}

py::tuple motion_state(const Motion& motion) {
  py::list links, skipped;
  for (const auto& gap : motion.graphs->links) links.append(pairs_view<Link>(gap, py::none()).attr("copy")());
  for (const auto& gap : motion.graphs->skipped)
    skipped.append(pairs_view<Link>(gap, py::none()).attr("copy")());
  return py::make_tuple(sketch_state(motion.graphs->sketch), links, skipped);
}

Motion motion_from(const py::tuple& state) {
  graph::MotionGraph motion{sketch_from(state[0]), {}};
  for (const auto& gap : py::list(state[1]))
    motion.links.push_back(items_of<Link>(gap, py::dtype::of<std::uint32_t>(), 2));
  for (const auto& gap : py::list(state[2]))
    motion.skipped.push_back(items_of<Link>(gap, py::dtype::of<std::uint32_t>(), 2));
  graph::validate(motion);
  return hold(std::move(motion));
}

template <class Held>
py::class_<Held> bind_frames(py::module_& module, const char* name, const char* text) {
  py::class_<Held> held(module, name, text);
  held.def_property_readonly("width", [](const Held& h) { return sketch_of(h).width; })
      .def_property_readonly("height", [](const Held& h) { return sketch_of(h).height; })
      .def_property_readonly("fps", [](const Held& h) { return sketch_of(h).fps; })
      .def("__len__", [](const Held& h) { return sketch_of(h).frames.size(); })
      .def("__copy__", [](const Held& h) { return h; })
      .def("__deepcopy__", [](const Held& h, const py::dict&) { return h; })
      .def("__eq__", [](const Held& a, const py::object& b) {
        return py::isinstance<Held>(b) && *a.graphs == *b.cast<const Held&>().graphs;
      });
  held.attr("__hash__") = py::none();
  held.def(
      "patches",
      [](const py::object& self, py::ssize_t t) {
        return patches_view(frame_of(self.cast<const Held&>(), t), self);
      },
      py::arg("frame"), "Returns the patches of a frame as a structured array, a view of them.");
  held.def(
      "edges",
      [](const py::object& self, py::ssize_t t) {
        return pairs_view(frame_of(self.cast<const Held&>(), t).edges(), self);
      },
      py::arg("frame"), "Returns the edges of a frame, pairs of ids, as a view of them.");
  return held;
}

void bind_text(py::class_<Motion>& motion) {
  const auto write = [&](const char* name, auto writer, const char* text) {
    motion.def(
        name,
        [writer](const Motion& held) {
          std::ostringstream out;
          {
            const py::gil_scoped_release released;
            writer(out, *held.graphs);
          }
          return bytes_of(out);
        },
        text);
  };
  write("to_jsonl", graph::write_motion, doc("graph::write_motion"));
  write("trajectories_csv",
        static_cast<void (*)(std::ostream&, const graph::MotionGraph&)>(graph::write_trajectories),
        doc("graph::write_trajectories"));
  const auto write_in_units = [&](const char* name, auto writer, const char* text) {
    motion.def(
        name,
        [writer](const Motion& held, std::optional<double> seconds, std::optional<double> um,
                 const std::vector<double>& times, const OriginTuple& origin) {
          std::ostringstream out;
          {
            const py::gil_scoped_release released;
            writer(out, *held.graphs, graph::Units{seconds, um, times, to_origin(origin)});
          }
          return bytes_of(out);
        },
        py::arg("seconds") = py::none(), py::arg("um") = py::none(), py::arg("times") = std::vector<double>{},
        py::arg("origin") = OriginTuple{}, text);
  };
  using Table = void (*)(std::ostream&, const graph::MotionGraph&, const graph::Units&);
  write_in_units("strokes_csv", static_cast<Table>(graph::write_strokes), doc("graph::write_strokes"));
  write_in_units("curves_csv", graph::write_curves, doc("graph::write_curves"));
  write_in_units(
      "joints_csv",
      [](std::ostream& out, const graph::MotionGraph& graphs, const graph::Units& units) {
        graph::write_joints(out, graph::identify_curves(graphs).joints, units);
      },
      doc("graph::write_joints"));
  write_in_units("network_csv", graph::write_network, doc("graph::write_network"));
  write_in_units(
      "topology_csv",
      [](std::ostream& out, const graph::MotionGraph& graphs, const graph::Units& units) {
        graph::write_topology(out, graph::topology_changes(graphs), units);
      },
      doc("graph::write_topology"));
  write_in_units(
      "tips_csv",
      [](std::ostream& out, const graph::MotionGraph& graphs, const graph::Units& units) {
        graph::write_tips(out, graph::tip_motions(graphs), units);
      },
      doc("graph::write_tips"));
  motion.def_static(
      "from_jsonl",
      [](const std::string& text, const std::string& name) {
        std::istringstream in(text);
        return hold(graph::read_motion(in, name));
      },
      py::arg("text"), py::arg("name") = "the text", doc("graph::read_motion"));
}

void bind_motion(py::module_& module) {
  auto sketch = bind_frames<Sketch>(module, "SketchSequence", doc("graph::SketchSequence"));
  sketch.def(py::pickle([](const Sketch& held) { return sketch_state(*held.graphs); },
                        [](const py::tuple& state) { return hold(sketch_from(state)); }));
  sketch.def("to_jsonl", [](const Sketch& held) {
    std::ostringstream out;
    graph::write_sketch(out, *held.graphs);
    return bytes_of(out);
  });
  auto motion = bind_frames<Motion>(module, "MotionGraph", doc("graph::MotionGraph"));
  motion.def(py::pickle([](const Motion& held) { return motion_state(held); },
                        [](const py::tuple& state) { return motion_from(state); }));
  motion.def_property_readonly("sketch", [](const Motion& m) { return hold(m.graphs->sketch); });
  motion.def(
      "links",
      [](const py::object& self, py::ssize_t t) {
        const auto& held = self.cast<const Motion&>();
        frame_of(held, t);  // refuses what is no frame
        const auto& links = held.graphs->links;
        const auto at = static_cast<std::size_t>(t < 0 ? t + static_cast<py::ssize_t>(links.size()) : t);
        return pairs_view<Link>(links[at], self);
      },
      py::arg("frame"), "Returns the links from the frame before, pairs of ids, as a view of them.");
  bind_text(motion);
}

std::vector<std::pair<int, std::vector<std::uint32_t>>> trajectory_list(const Motion& motion) {
  std::vector<std::pair<int, std::vector<std::uint32_t>>> all;
  for (const auto& one : graph::trajectories(*motion.graphs)) {
    auto& ids = all.emplace_back(one.first_frame, std::vector<std::uint32_t>{}).second;
    for (const auto id : one.vertices) ids.push_back(id.value);
  }
  return all;
}

}  // namespace

py::array patches_view(const graph::AttributeGraph& graph, const py::handle& owner) {
  return view(patch_dtype(), {static_cast<py::ssize_t>(graph.size())},
              {static_cast<py::ssize_t>(sizeof(Vertex))}, graph.vertices().data(), owner);
}

void bind_graph(py::module_& module) {
  bind_motion(module);
  OptionsClass<graph::MatchOptions>(module, "MatchOptions", "graph::MatchOptions")
      .described_fields()
      .finish();
  py::list patch_types, event_types;
  for (int i = 0; i <= static_cast<int>(graph::PatchType::anchor); ++i)
    patch_types.append(graph::name(static_cast<graph::PatchType>(i)));
  for (const auto type : graph::all_event_types()) event_types.append(graph::name(type));
  module.attr("PATCH_TYPES") = py::tuple(patch_types);
  module.attr("EVENT_TYPES") = py::tuple(event_types);
  module.attr("PATCH_DTYPE") = patch_dtype();
  module.def(
      "match",
      [](const Sketch& sketch, const graph::MatchOptions& options, const py::object& progress) {
        return hold(call(progress, [&](const core::Context& context) {
          return graph::match(*sketch.graphs, options, context);
        }));
      },
      py::arg("sketch"), py::arg("options") = graph::MatchOptions{}, py::arg("progress") = py::none(),
      doc("graph::match"));
  module.def(
      "identify_curves",
      [](const Motion& motion, const py::object& progress) {
        return hold(call(progress, [&](const core::Context& context) {
          return graph::identify_curves(*motion.graphs, context).motion;
        }));
      },
      py::arg("motion"), py::arg("progress") = py::none(), doc("graph::identify_curves"));
  module.def(
      "stroke_events", [](const Motion& motion) { return event_list(graph::stroke_events(*motion.graphs)); },
      py::arg("motion"), doc("graph::stroke_events"));
  module.def("trajectories", trajectory_list, py::arg("motion"), doc("graph::trajectories"));
}

}  // namespace emberfold::python
