// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "graph/events/event_names.hpp"
#include "graph/events/event_score.hpp"
#include "graph/exporting/tracking_files.hpp"
#include "graph/io/contact_tables.hpp"
#include "graph/io/motion_io.hpp"
#include "graph/io/review_io.hpp"
#include "python/src/bind.hpp"
#include "python/src/calls.hpp"
#include "python/src/clip_data.hpp"
#include "python/src/holders.hpp"
#include "python/src/options.hpp"
#include "python/src/reviews.hpp"

namespace emberfold::python {

namespace {

using MaybeNumber = std::optional<double>;
using Times = std::vector<double>;

/// Returns the bytes of a writer that does not use Python.
py::bytes written(const std::function<void(std::ostream&)>& write) {
  std::ostringstream out;
  {
    const py::gil_scoped_release released;
    write(out);
  }
  return {out.str()};
}

graph::StrokeTree tree_of(const Motion& motion, const py::list& events, const std::string& of) {
  if (of == "curves") return graph::make_curve_tree(*motion.graphs);
  if (of == "strokes") return graph::make_stroke_tree(*motion.graphs, to_events(events));
  throw py::value_error("of is '" + of + "'; allowed is strokes or curves");
}

graph::TrackedClip tracked(const Motion& motion, std::string name, graph::Units units) {
  const auto& sketch = motion.graphs->sketch;
  return {std::move(name), sketch.width,    sketch.height, static_cast<int>(sketch.frames.size()),
          sketch.fps,      std::move(units)};
}

/// The files of a GEFF: paths below its folder, and their bytes.
py::dict geff_files(const Motion& motion, const py::list& events, const std::string& of, MaybeNumber seconds,
                    MaybeNumber um, const Times& times, const OriginTuple& origin) {
  py::dict files;
  graph::write_geff(tree_of(motion, events, of), tracked(motion, {}, {seconds, um, times, to_origin(origin)}),
                    "geff", [&](const std::string& path, const std::function<void(std::ostream&)>& body) {
                      files[py::str(path.substr(path.find('/') + 1))] = written(body);
                    });
  return files;
}

void bind_exports(py::module_& module) {
  module.def("geff_files", geff_files, py::arg("motion"), py::arg("events"), py::arg("of") = "strokes",
             py::arg("seconds") = py::none(), py::arg("um") = py::none(), py::arg("times") = Times{},
             py::arg("origin") = OriginTuple{}, doc("graph::write_geff"));
  const auto text = [&](const char* name, auto writer, const char* about) {
    module.def(
        name,
        [writer](const Motion& motion, const py::list& events, const std::string& of, const std::string& clip,
                 MaybeNumber seconds, MaybeNumber um, const Times& times, const OriginTuple& origin) {
          const auto tree = tree_of(motion, events, of);
          const auto tracks = tracked(motion, clip, {seconds, um, times, to_origin(origin)});
          return written([&](std::ostream& out) { writer(out, tree, tracks); });
        },
        py::arg("motion"), py::arg("events"), py::arg("of") = "strokes", py::arg("clip") = "",
        py::arg("seconds") = py::none(), py::arg("um") = py::none(), py::arg("times") = Times{},
        py::arg("origin") = OriginTuple{}, about);
  };
  text("trackmate_xml", graph::write_trackmate, doc("graph::write_trackmate"));
  text("genealogy_graphml", graph::write_graphml, doc("graph::write_graphml"));
}

void bind_tables(py::module_& module) {
  const auto table = [&](const char* name, auto writer, const char* about) {
    module.def(
        name,
        [writer](const Motion& motion, MaybeNumber seconds, MaybeNumber um, const Times& times,
                 const OriginTuple& origin) {
          const graph::Units units{seconds, um, times, to_origin(origin)};
          return written([&](std::ostream& out) { writer(out, *motion.graphs, units); });
        },
        py::arg("motion"), py::arg("seconds") = py::none(), py::arg("um") = py::none(),
        py::arg("times") = Times{}, py::arg("origin") = OriginTuple{}, about);
  };
  using graph::MotionGraph, graph::Units;
  table(
      "contacts_csv",
      [](std::ostream& out, const MotionGraph& motion, const Units& units) {
        graph::write_contacts(out, graph::curve_contacts(motion), units);
      },
      doc("graph::curve_contacts"));
  table(
      "lives_csv",
      [](std::ostream& out, const MotionGraph& motion, const Units& units) {
        graph::write_lives(out, graph::stroke_lives(motion), units);
      },
      doc("graph::stroke_lives"));
  module.def(
      "event_contacts",
      [](const Motion& motion, const py::list& events) {
        std::vector<std::string> names;
        for (const auto contact : graph::event_contacts(*motion.graphs, to_events(events)))
          names.emplace_back(graph::name(contact));
        return names;
      },
      py::arg("motion"), py::arg("events"), doc("graph::event_contacts"));
  module.def(
      "events_json",
      [](const py::list& events, const OriginTuple& origin) {
        const auto list = to_events(events);
        const graph::Units units{{}, {}, {}, to_origin(origin)};
        return written([&](std::ostream& out) { graph::write_events(out, list, units); });
      },
      py::arg("events"), py::arg("origin") = OriginTuple{}, doc("graph::write_events"));
}

py::list score_rows(const graph::Score& score) {
  py::list rows;
  for (const auto& [count, list] : {std::pair(4, &score.four), std::pair(6, &score.six)})
    for (const auto& one : *list)
      rows.append(py::make_tuple(count, one.name, one.in_truth, one.found, one.hit, one.precision(),
                                 one.recall(), one.f1()));
  return rows;
}

void bind_reviews(py::module_& module) {
  OptionsClass<graph::ScoreOptions>(module, "ScoreOptions", "graph::ScoreOptions")
      .described_fields()
      .finish();
  module.def(
      "score_events",
      [](const py::list& truth, const py::list& found, const graph::ScoreOptions& options) {
        return score_rows(graph::score_events(to_events(truth), to_events(found), options));
      },
      py::arg("truth"), py::arg("found"), py::arg("options") = graph::ScoreOptions{},
      doc("graph::score_events"));
  const auto reader = [&](const char* name, auto read, const char* about) {
    module.def(
        name,
        [read](const std::string& text, const std::string& file) {
          std::istringstream in(text);
          return read(in, file);
        },
        py::arg("text"), py::arg("name") = "the text", about);
  };
  reader("read_review", graph::read_review, doc("graph::read_review"));
  reader("read_truth", graph::read_truth, doc("graph::read_truth"));
  module.def(
      "told_events",
      [](const std::vector<graph::ReviewedEvent>& review) { return event_list(graph::told_events(review)); },
      py::arg("review"), doc("graph::told_events"));
}

}  // namespace

py::tuple event_tuple(const graph::Event& e) {
  const auto ids = [](const std::vector<graph::SubgraphId>& strokes) {
    py::tuple all(strokes.size());
    for (std::size_t i = 0; i < strokes.size(); ++i) all[i] = py::int_(strokes[i].value);
    return all;
  };
  return py::make_tuple(e.frame, graph::name(e.type), e.position.x, e.position.y, e.probability,
                        ids(e.before), ids(e.after));
}

py::list event_list(const std::vector<graph::Event>& events) {
  py::list all;
  for (const auto& event : events) all.append(event_tuple(event));
  return all;
}

namespace {

graph::EventType type_of(const py::handle& given) {
  const auto name = given.cast<std::string>();
  if (const auto type = graph::event_type(name)) return *type;
  throw py::value_error("events have the type '" + name + "'; allowed is a name of EVENT_TYPES");
}

}  // namespace

graph::Event to_event(const py::tuple& row) {
  const auto strokes = [](const py::handle& ids) {
    std::vector<graph::SubgraphId> all;
    for (const auto& id : ids) all.push_back({id.cast<std::uint32_t>()});
    return all;
  };
  return {row[0].cast<int>(),    type_of(row[1]), {row[2].cast<double>(), row[3].cast<double>()},
          row[4].cast<double>(), strokes(row[5]), strokes(row[6])};
}

std::vector<graph::Event> to_events(const py::list& events) {
  std::vector<graph::Event> all;
  for (const auto& one : events) all.push_back(to_event(one.cast<py::tuple>()));
  return all;
}

py::tuple review_tuple(const graph::ReviewedEvent& reviewed) {
  py::object answer = py::none();
  if (reviewed.answer == graph::Answer::yes) answer = py::str("yes");
  if (reviewed.answer == graph::Answer::no) answer = py::str("no");
  if (reviewed.answer == graph::Answer::added) answer = py::str("added");
  if (reviewed.answer == graph::Answer::other) answer = py::str(std::string(graph::name(reviewed.type)));
  const py::tuple row = event_tuple(reviewed.event);
  return py::make_tuple(row[0], row[1], row[2], row[3], row[4], row[5], row[6], answer);
}

graph::ReviewedEvent to_review(const py::tuple& row) {
  graph::ReviewedEvent reviewed{to_event(row)};
  const py::object answer = row[7];
  if (answer.is_none()) return reviewed;
  const auto text = answer.cast<std::string>();
  if (text == "yes") {
    reviewed.answer = graph::Answer::yes;
  } else if (text == "no") {
    reviewed.answer = graph::Answer::no;
  } else if (text == "added") {
    reviewed.answer = graph::Answer::added;
  } else if (const auto type = graph::event_type(text)) {
    reviewed.answer = graph::Answer::other, reviewed.type = *type;
  } else {
    throw py::value_error("review has the answer '" + text +
                          "'; allowed is yes, no, added, a name of EVENT_TYPES or None");
  }
  return reviewed;
}

void bind_events(py::module_& module) {
  bind_exports(module);
  bind_tables(module);
  bind_reviews(module);
}

}  // namespace emberfold::python
