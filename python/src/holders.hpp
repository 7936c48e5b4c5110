// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "graph/events/events.hpp"
#include "graph/motion_graph.hpp"

// Graphs as Python holds them: values that never change, shared by their copies and by the views of their
// memory.
namespace emberfold::python {

struct Sketch {
  std::shared_ptr<const graph::SketchSequence> graphs;
};
struct Motion {
  std::shared_ptr<const graph::MotionGraph> graphs;
};

inline Sketch hold(graph::SketchSequence graphs) {
  return {std::make_shared<const graph::SketchSequence>(std::move(graphs))};
}
inline Motion hold(graph::MotionGraph graphs) {
  return {std::make_shared<const graph::MotionGraph>(std::move(graphs))};
}

/// Returns events as (frame, type, x, y, probability, before, after), one tuple each.
pybind11::list event_list(const std::vector<graph::Event>& events);
/// Reads such a list.
std::vector<graph::Event> to_events(const pybind11::list& events);

/// Returns one event as such a tuple, and reads one.
pybind11::tuple event_tuple(const graph::Event& event);
graph::Event to_event(const pybind11::tuple& row);

/// Returns the patches of a frame as a view, `owner` being what holds them.
pybind11::array patches_view(const graph::AttributeGraph& graph, const pybind11::handle& owner);

}  // namespace emberfold::python
